// What a layered relief looks like when its samples are splatted directly into a frame (S4.9).
//
// The plain way [Shade, Gortler, He, Szeliski 1998], to compare the pre-warp with: each sample is
// projected, and drawn as a square of the size that a source texel has at its depth, or as a
// Gaussian of that width, blended over what was drawn before. Samples come in occlusion-compatible
// order; no depth is tested. A frame whose camera is a pre-warp's own makes its splats Gaussian.
#pragma once

#include "rilievo/core/color.h"
#include "rilievo/layered_relief/prewarp.h"

namespace rilievo {

enum class SplatShape { square, gaussian };

// Colours sRGB-encoded, then premultiplied, as floats; eye_z of the samples that hide at least
// half.
struct SplattedFrame {
  Camera camera;
  Image<glm::vec4> color;
  Image<float> depth;
};

// Requires a perspective camera whose eye stands in front of the source plane. Samples behind the
// near plane are left out.
[[nodiscard]] SplattedFrame splat_layers(const LayeredRelief& relief, const Camera& camera,
                                         SplatShape shape);

// A flat picture with depth on its plane, as its own eye sees it in `camera`, whose eye it must be:
// colours interpolated, the depth of the nearest texel (S4.10). Adds to what the frame shows where
// the picture is nearer. Rows run in parallel.
void map_picture(const Prewarped& picture, SplattedFrame& frame);

// An empty frame.
[[nodiscard]] SplattedFrame empty_frame(const Camera& camera);
// As a pre-warp's result: Deltas from the depths.
[[nodiscard]] Prewarped picture_of(const SplattedFrame& frame, const PictureGeometry& geometry);
// Over a background of one colour, linear.
[[nodiscard]] Rgba8Image frame_over(const SplattedFrame& frame, const glm::vec3& background);

}  // namespace rilievo
