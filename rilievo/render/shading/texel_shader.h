// The texel rule (core/texel_rule.h) for visibility buffers: captures by the rasteriser and by
// rays.
//
// One buffer has what the texels' centres show, another one four samples of each texel. As
// BandShader, each triangle is shaded once in each texel where it counts. Rows from the bottom.
// Internal to render/raster and render/rays.
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/shading/band_shader.h"

namespace rilievo {

// What texels' centres show.
struct CenterTexels {
  Image<float> depth;             // as in SampleBuffer
  Image<std::uint32_t> triangle;  // ShownTexels::kNothing where there is nothing
};
// Of a buffer with one sample a texel.
[[nodiscard]] CenterTexels centers_of(const SampleBuffer& samples);

// Which samples texels show.
struct ShownTexels {
  static constexpr std::uint32_t kNothing = 0xFFFFFFFFu;

  Image<std::uint8_t> mask;              // a bit for each sample; 0: what the centre shows
  Image<std::uint32_t> center_triangle;  // kNothing where there is none
};

// Finds which samples texels show. Sets depth (eye_z) and object of texels that show a thin surface
// in front of their centre's; `picture` has depths, objects and the camera of the buffers. Requires
// meshes in the order of their triangles, which are those of both buffers.
[[nodiscard]] ShownTexels choose_texels(const CenterTexels& centers, const SampleBuffer& samples,
                                        std::span<const PlacedMesh> meshes, DepthImage& picture);

// Sets the colours of a picture whose depths and camera are known: that of the surface which a
// texel shows, premultiplied by the share of samples that show anything; 0 without a depth. Or,
// `with_sky`: alpha is 1, and texels without a depth show the sky of view.lights. Requires
// ColorScale::linear.
void shade_texels(const PictureView& view, const ShownTexels& shown, DepthImage& picture,
                  bool with_sky);

}  // namespace rilievo
