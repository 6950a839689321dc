// Inverse depths as 16-bit codes, with a bound on how far rounding moves what is seen.
//
// Code 0 is the sky; code c > 0 is 1 / eye_z = (c + kDepthOffset) step, the middle of an interval
// of that width. docs/serve.md derives the step. Without state; any thread.
#pragma once

#include <cstdint>

#include "rilievo/core/camera.h"
#include "rilievo/core/image.h"

namespace rilievo {

inline constexpr float kDepthOffset = -0.5f;
inline constexpr int kMostDepthCode = 65535;
// An eye's cell reaches at most this share of the way to the nearest thing.
inline constexpr double kMostOfTheWay = 0.5;

// Frames that are warped from a picture: pixels per tangent, and the tangent of their corners.
struct FrameScale {
  double pixels_per_tangent = 1, corner_tangent = 0;
};
[[nodiscard]] FrameScale frame_scale(const Camera& frame);

// A step, and what holds with it: for eyes within `cell` of the picture's eye no texel is seen
// farther than `error_px` pixels from its place because its depth is rounded.
struct DepthStep {
  float step = 1;
  double cell = 0, error_px = 0;
};

// The step for an error of `error_px`. The cell that is returned is smaller than `cell` where
// something is near, and the error larger where 16 bits do not suffice. `nearest`: the largest
// 1 / eye_z of the picture. Requires positive numbers; nearest may be 0.
[[nodiscard]] DepthStep choose_depth_step(double nearest, double cell, double error_px,
                                          const FrameScale& frame);

// The largest 1 / eye_z.
[[nodiscard]] float nearest_of(const Image<float>& inverse_z);
// Codes of inverse depths, each of which is 0 (the sky) or at most that for which the step was
// chosen.
[[nodiscard]] Image<std::uint16_t> depth_codes(const Image<float>& inverse_z, float step);
// And back.
[[nodiscard]] inline float inverse_z_of(std::uint16_t code, float step, float offset) {
  return code == 0 ? 0.0f : (float(code) + offset) * step;
}

}  // namespace rilievo
