// A layered impostor on the GPU: its pictures in texture arrays, one layer a view.
//
// What drawing takes: colours, and for the walk through the pictures' surfaces (LayeredMethod::
// surfaces) disparities, slopes and links, or for slices the interval of each texel. The second
// kind is uploaded by whoever needs it first. Needs a current OpenGL context.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "rilievo/gl/object.h"
#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"
#include "rilievo/warp/surface_pyramid.h"

namespace rilievo {

class LayeredPictures {
 public:
  // Keeps what it needs of the impostor. Fails if the driver's textures do not reach as far.
  [[nodiscard]] static Result<LayeredPictures> create(LayeredImpostor impostor);

  // The impostor: views, slices, cameras, and the pictures themselves.
  [[nodiscard]] const LayeredImpostor& impostor() const { return impostor_; }
  // Bytes of texture memory taken so far.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

  // Identifiers within the pictures, if they show more than one object; else 0.
  [[nodiscard]] GLuint object_texture() const { return object_; }
  // sRGB-encoded, premultiplied.
  [[nodiscard]] GLuint color_texture() const { return color_; }

  struct SurfaceTextures {
    GLuint q, slope, links, cells;
    // The columns at which the levels of the pyramid (warp/surface_pyramid.h) begin.
    std::array<int, SurfacePyramid::kLevels> level_at;
  };
  [[nodiscard]] SurfaceTextures surface_textures();
  [[nodiscard]] GLuint interval_texture();
  // What of a slice is drawn (layered_impostor/slice_rects.h), by view and slice; from
  // interval_texture() on.
  [[nodiscard]] const std::vector<TexelRect>& rects_of(int view, int slice) const {
    return slice_rects_[std::size_t(view)][std::size_t(slice)];
  }
  // Uploads what this way of drawing takes and lets go of the texels in main memory: from now on
  // there is no other way, and impostor() is without its pictures' and surfaces' texels.
  void keep_only(LayeredMethod method);

 private:
  LayeredImpostor impostor_;
  int width_ = 0, height_ = 0;  // of the largest picture
  std::size_t bytes_ = 0;
  std::vector<std::vector<std::vector<TexelRect>>> slice_rects_;
  gl::Texture color_, object_, q_, slope_, links_, cells_, interval_;

  [[nodiscard]] gl::Texture make_array(GLenum format, int width, int height, int texel_bytes);
};

// Interval of a texel, in 16 bits each of the view's own range of depths, rounded outwards; the
// slices' ends are scaled alike. Empty texels have front > back.
struct IntervalScale {
  float nearest = 0, per_metre = 0;
  [[nodiscard]] float operator()(float eye_z) const { return (eye_z - nearest) * per_metre; }
};
[[nodiscard]] IntervalScale interval_scale(const LayeredImpostor& impostor, int view);

}  // namespace rilievo
