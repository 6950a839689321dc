// Are a method's frames good enough? One rule for all methods, for `auto` and for `bench auto`.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "rilievo/core/expects.h"

namespace rilievo {

// What is at most so much below the cache is as good.
inline constexpr double kAsGoodDb = 0.5;

// PSNR of a mean difference of one step of a byte (SampledLoss::kUnseen). Nobody sees what is
// better.
inline constexpr double kUnseenDb = 48.13;

// What one frame loses is certainly not too much, if it is this share of what is allowed.
inline constexpr double kCertainly = 0.7;

// The loss of SampledLoss, beside a truth of any number of samples. Its own has 16 and direct
// drawing 4, so that with the mean square e of direct drawing's difference it measures e + e / 4
// for that, and e / 4 more for other frames, too.
[[nodiscard]] inline double without_own_noise(double sampled_loss_db) {
  constexpr double kNoise = 0.25, kLeast = 0.1;
  const double ratio = (1 + kNoise) * std::pow(10, sampled_loss_db / 10) - kNoise;
  return 10 * std::log10(std::max(ratio, kLeast));
}

// The cache's frames are in error by what was asked for. Where its pictures are of the moment
// before, they may lose more; other frames at most so many times what is allowed.
inline constexpr double kMostTimes = 2;

// `loss_db`: how much farther from the truth its frames are than direct drawing's. They may lose
// `allowed_db`, or as much as the cache's frames (none: not known), but at most kMostTimes
// allowed_db.
[[nodiscard]] inline bool good_enough(double loss_db, std::optional<double> cache_loss_db,
                                      double allowed_db) {
  RILIEVO_EXPECTS(allowed_db >= 0);
  const double as_cache = cache_loss_db ? *cache_loss_db + kAsGoodDb : allowed_db;
  return loss_db <= std::clamp(as_cache, allowed_db, kMostTimes * allowed_db);
}

}  // namespace rilievo
