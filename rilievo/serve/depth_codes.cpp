#include "rilievo/serve/depth_codes.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Codes and steps are computed in single precision: 65535 codes of 2^-24 each are 0.004 of a step,
// and the step is that much smaller than the derivation allows.
constexpr double kRounding = 0.99;

}  // namespace

FrameScale frame_scale(const Camera& frame) {
  const ImageWindow& w = frame.window;
  return {frame.width / (w.right - w.left),
          std::hypot(std::max(std::abs(w.left), std::abs(w.right)),
                     std::max(std::abs(w.bottom), std::abs(w.top)))};
}

DepthStep choose_depth_step(double nearest, double cell, double error_px, const FrameScale& frame) {
  RILIEVO_EXPECTS(cell > 0 && error_px > 0 && frame.pixels_per_tangent > 0 && nearest >= 0);
  DepthStep chosen;
  chosen.cell = nearest > 0 ? std::min(cell, kMostOfTheWay / nearest) : cell;
  const double rho = chosen.cell * nearest;
  const double px_of_turn =
      frame.pixels_per_tangent * (1 + frame.corner_tangent * frame.corner_tangent);
  // Pixels for each unit of 1 / eye_z.
  const double px_of_w = px_of_turn * chosen.cell / ((1 - rho) * (1 - rho));
  const double fine = kRounding * 2 * error_px / px_of_w;
  // All codes must fit.
  const double least = nearest / (kMostDepthCode - 1);
  chosen.step = float(std::max(fine, least));
  chosen.error_px = fine >= least ? error_px : px_of_w * chosen.step / (2 * kRounding);
  return chosen;
}

float nearest_of(const Image<float>& inverse_z) {
  float nearest = 0;
  for (const float w : inverse_z.texels()) nearest = std::max(nearest, w);
  return nearest;
}

Image<std::uint16_t> depth_codes(const Image<float>& inverse_z, float step) {
  Image<std::uint16_t> codes(inverse_z.width(), inverse_z.height());
  const float per = 1 / step;
  const std::span<const float> from = inverse_z.texels();
  const std::span<std::uint16_t> to = codes.texels();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const int code = std::min(int(from[i] * per) + 1, kMostDepthCode);
    to[i] = std::uint16_t(from[i] > 0 ? code : 0);
  }
  return codes;
}

}  // namespace rilievo
