// Are a method's frames good enough? One rule for all methods, for `auto` and for `bench auto`.
#pragma once

#include <algorithm>
#include <optional>

namespace rilievo {

// What is at most so much below the cache is as good.
inline constexpr double kAsGoodDb = 0.5;

// `loss_db`: how much farther from the truth its frames are than direct drawing's. They may lose
// `allowed_db`, or as much as the cache's frames at the error that was asked for; none: this is not
// known.
[[nodiscard]] inline bool good_enough(double loss_db, std::optional<double> cache_loss_db,
                                      double allowed_db) {
  return loss_db <=
         std::max(allowed_db, cache_loss_db.value_or(allowed_db - kAsGoodDb) + kAsGoodDb);
}

}  // namespace rilievo
