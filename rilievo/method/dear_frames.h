// Frames that take much more than others and come back every few frames: as the cache's that
// capture every third time, or keyframes' that end one. They belong to what a method takes. Slow
// frames in one row, or in two, are the work of another program, and do not.
#pragma once

#include <algorithm>

namespace rilievo {

// What such frames add to the mean of the usual ones.
class DearFrames {
 public:
  // Others between two rows of dear ones, fewer than these, and such gaps in a row, until they are
  // taken to come back.
  static constexpr int kOften = 12, kGaps = 2;
  // The share of a frame in the mean: little, since few frames say it.
  static constexpr double kNewest = 0.03;

  // The next frame took `ms`; a usual one takes at most `most_ms`.
  void add(double ms, double most_ms) {
    const double more_ms = std::max(0.0, ms - most_ms);
    if (more_ms > 0 && usual_ > 0) gaps_ = usual_ < kOften ? gaps_ + 1 : 0;
    usual_ = more_ms > 0 ? 0 : usual_ + 1;
    mean_ms_ += ((come_back() ? more_ms : 0) - mean_ms_) * kNewest;
  }
  [[nodiscard]] double mean_ms() const { return mean_ms_; }
  // Do they come back?
  [[nodiscard]] bool come_back() const { return gaps_ >= kGaps && usual_ < kOften; }
  void forget() { *this = {}; }

 private:
  int usual_ = kOften;  // frames since a dear one
  int gaps_ = 0;
  double mean_ms_ = 0;
};

}  // namespace rilievo
