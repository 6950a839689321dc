// How is a layered impostor stored on the GPU? Pictures in texture arrays, one layer for each view.
//
// Drawing needs colours, and either disparities, slopes and links (LayeredMethod::surfaces) or the
// interval of each texel (slices). These are uploaded when a way of drawing first needs them. Needs
// a current OpenGL context.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "rilievo/gl/object.h"
#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"
#include "rilievo/layered_impostor/slice_quads.h"
#include "rilievo/warp/surface_pyramid.h"

namespace rilievo {

// An impostor and its textures.
class LayeredPictures {
 public:
  // Takes the impostor and uploads its colours. Fails if it exceeds the driver's texture limits.
  [[nodiscard]] static Result<LayeredPictures> create(LayeredImpostor impostor);

  // The impostor: views, slices, cameras and pictures.
  [[nodiscard]] const LayeredImpostor& impostor() const { return impostor_; }
  // The texture memory allocated so far, bytes.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

  // Object identifiers within the pictures, if they show more than one object; else 0.
  [[nodiscard]] GLuint object_texture() const { return object_; }
  // The object that they show, if they name exactly one; else kNoObject.
  [[nodiscard]] std::uint32_t only_object() const { return only_object_; }
  // sRGB-encoded, premultiplied colours.
  [[nodiscard]] GLuint color_texture() const { return color_; }

  // The textures of LayeredMethod::surfaces.
  struct SurfaceTextures {
    GLuint q, slope, links, cells;
    // The columns at which the levels of the pyramid (warp/surface_pyramid.h) begin.
    std::array<int, SurfacePyramid::kLevels> level_at;
  };
  [[nodiscard]] SurfaceTextures surface_textures();
  // The texture of LayeredMethod::slices.
  [[nodiscard]] GLuint interval_texture();
  // Chooses slices. There after interval_texture() was called.
  [[nodiscard]] SliceChooser& slice_chooser() { return *slice_chooser_; }
  // Uploads what this way of drawing needs and frees the texels in main memory. Afterwards there is
  // no other way, and impostor() has no texels of pictures and surfaces.
  void keep_only(LayeredMethod method);

 private:
  LayeredImpostor impostor_;
  int width_ = 0, height_ = 0;  // of the largest picture
  std::size_t bytes_ = 0;
  std::uint32_t only_object_ = kNoObject;
  std::optional<SliceChooser> slice_chooser_;
  gl::Texture color_, object_, q_, slope_, links_, cells_, interval_;

  [[nodiscard]] gl::Texture make_array(GLenum format, int width, int height, int texel_bytes);
};

}  // namespace rilievo
