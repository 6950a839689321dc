// Depth values: their kinds, and their codes in few bits.
//
// With d = distance along the camera's -z, n = z_near, f = z_far:
//   eye_z     d
//   ray       distance from the eye (parallel: from the eye's plane) along the texel's own ray
//   window_z  perspective: f (d - n) / (d (f - n)); parallel: (d - n) / (f - n). In [0, 1], 0 on
//             the near plane: the value in OpenGL's depth buffer. Affine in 1/d.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

#include "rilievo/core/camera.h"

namespace rilievo {

// The meaning of a depth value; the formulas are above.
enum class DepthKind { window_z, eye_z, ray };

// The depth of a texel that shows nothing, in every kind.
inline constexpr float kNoDepth = std::numeric_limits<float>::infinity();

// Converts one depth to eye_z and back. `raster` (texels) matters for `ray` only. Monotone;
// kNoDepth stays kNoDepth.
[[nodiscard]] double eye_z_from(DepthKind kind, double depth, const Camera& camera,
                                const glm::dvec2& raster);
[[nodiscard]] double depth_from_eye_z(DepthKind kind, double eye_z, const Camera& camera,
                                      const glm::dvec2& raster);

// Delta [Schaufler 1997, section 4.1]: window_z in the picture's own tight frustum, in `bits` bits.
// The largest code means "transparent"; codes 0 ... 2^bits - 2 divide [0, 1] evenly.
[[nodiscard]] constexpr std::uint32_t delta_transparent(int bits) { return (1u << bits) - 1u; }
[[nodiscard]] constexpr std::uint32_t delta_steps(int bits) { return (1u << bits) - 2u; }
// The nearest code; `window_z` is clamped to [0, 1]. Requires 2 <= bits <= 16.
[[nodiscard]] std::uint32_t encode_delta(float window_z, int bits);
// The window_z of a code. Requires code < delta_transparent(bits). encode_delta(decode_delta(c)) ==
// c for every code.
[[nodiscard]] float decode_delta(std::uint32_t code, int bits);

}  // namespace rilievo
