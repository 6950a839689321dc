#include "rilievo/keyframes/cheaper_way.h"

namespace rilievo {
namespace {

// The share of the last frame in the mean.
constexpr double kNewestFrame = 0.1;
// The first frames make keyframes at once.
constexpr int kFirstFrames = 30;

void add_to_mean(double ms, double& mean) {
  mean = mean == 0 ? ms : mean + (ms - mean) * kNewestFrame;
}

}  // namespace

CheaperWay::Way CheaperWay::next() const {
  if (returning_) return Way::both;
  return polygons_ || trying_ ? Way::polygons : Way::keyframes;
}

void CheaperWay::add(double ms, double guess_ms, bool ready) {
  if (++frames_ <= kFirstFrames) return;
  if (polygons_) {
    // What making keyframes takes beside is not the polygons'.
    if (!returning_) add_to_mean(ms, polygons_ms_);
    if (returning_ && ready) polygons_ = returning_ = false, since_try_ = 0;
    if (polygons_ && keyframes_ms_ < kCheaper * polygons_ms_) returning_ = true;
    return;
  }
  if (trying_) {
    trying_ = false, since_try_ = 0;
    polygons_ms_ = ms;
    polygons_ = ms < kCheaper * keyframes_ms_;
    return;
  }
  add_to_mean(ms, keyframes_ms_);
  ++since_try_;
  trying_ = since_try_ >= kFramesToTry && guess_ms > 0 && guess_ms < kMayTry * keyframes_ms_;
}

}  // namespace rilievo
