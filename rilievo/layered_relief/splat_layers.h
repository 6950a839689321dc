// How does a layered relief look when its samples are splatted directly into a frame? (S4.9)
//
// The method of [Shade, Gortler, He, Szeliski 1998], to compare the pre-warp with: each sample is
// projected and drawn as a square of the size of a source texel at its depth, or as a Gaussian of
// that width, blended over what was drawn before. Samples are drawn in occlusion-compatible order
// without a depth test. A Gaussian frame by the pre-warp's own camera is a pre-warp with Gaussian
// splats.
#pragma once

#include "rilievo/core/color.h"
#include "rilievo/layered_relief/prewarp.h"

namespace rilievo {

// The footprint of a sample.
enum class SplatShape { square, gaussian };

// A frame. Colours are sRGB-encoded, then premultiplied, in floating point; depth is the eye_z of
// samples with an opacity of at least one half.
struct SplattedFrame {
  Camera camera;
  Image<glm::vec4> color;
  Image<float> depth;
};

// Splats a relief. Requires a perspective camera whose eye is in front of the source plane. Samples
// behind the near plane are left out.
[[nodiscard]] SplattedFrame splat_layers(const LayeredRelief& relief, const Camera& camera,
                                         SplatShape shape);

// Draws a pre-warped picture into a frame whose camera has the picture's eye: colours are
// interpolated, the depth is that of the nearest texel (S4.10). Replaces farther pixels. Rows run
// in parallel.
void map_picture(const Prewarped& picture, SplattedFrame& frame);

// An empty frame.
[[nodiscard]] SplattedFrame empty_frame(const Camera& camera);
// The frame as a pre-warp's result, with Deltas made of its depths.
[[nodiscard]] Prewarped picture_of(const SplattedFrame& frame, const PictureGeometry& geometry);
// The frame over a background of one linear colour.
[[nodiscard]] Rgba8Image frame_over(const SplattedFrame& frame, const glm::vec3& background);

}  // namespace rilievo
