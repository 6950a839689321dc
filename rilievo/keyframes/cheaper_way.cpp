#include "rilievo/keyframes/cheaper_way.h"

#include <algorithm>

namespace rilievo {
namespace {

// The first frames make keyframes at once.
constexpr int kFirstFrames = 30;

}  // namespace

CheaperWay::Way CheaperWay::next() const {
  if (returning_) return Way::both;
  return polygons_ || trying_ ? Way::polygons : Way::keyframes;
}

void CheaperWay::go_by_polygons() {
  polygons_ = true, returning_ = looks_ = false, by_polygons_ = 0;
}

// They were right, whatever keyframes take now.
void CheaperWay::stay_longer_by_polygons() {
  frames_to_return_ = std::min(2 * frames_to_return_, kMostToReturn);
  go_by_polygons();
}

void CheaperWay::add_polygons(double ms, double guess_ms) {
  polygons_ms_.add(ms);
  guessed_ms_ = guess_ms;
  if (!drawn_as_source_ && guess_ms > 0) of_guess_ = polygons_ms_.median() / guess_ms;
}

void CheaperWay::add(double ms, double guess_ms, bool ready) {
  if (++frames_ <= kFirstFrames) return;
  if (polygons_) {
    add_polygons(ms, guess_ms);
    if (returning_ && ready) {
      polygons_ = returning_ = false, since_try_ = 0;
      looks_ = true, look_ms_.forget();
      return;
    }
    dearer_ = keyframes_ms_.median() < kCheaper * polygons_ms_.median();
    if (++by_polygons_ >= frames_to_return_ || dearer_) returning_ = true;
    return;
  }
  if (trying_) {
    trying_ = false, since_try_ = 0;
    polygons_ms_.forget();
    add_polygons(ms, guess_ms);
    if (ms > keyframes_ms_.median()) return;
    frames_to_return_ = kFramesToReturn;
    go_by_polygons();
    return;
  }
  (looks_ ? look_ms_ : keyframes_ms_).add(ms);
  if (looks_ && look_ms_.count() >= kLook) {
    looks_ = false;
    keyframes_ms_ = look_ms_;
    if (polygons_ms_.median() <= keyframes_ms_.median()) {
      stay_longer_by_polygons();
      return;
    }
  }
  ++since_try_;
  trying_ = since_try_ >= kFramesToTry && guess_ms > 0 &&
            of_guess_ * guess_ms < kMayTry * keyframes_ms_.median();
}

bool CheaperWay::leave_keyframes(double guess_ms) {
  const double usual_ms = keyframes_ms_.median();
  // What was measured some time ago has become dearer as its guess has.
  double ms = of_guess_ * guess_ms;
  if (polygons_ms_.count() > 0)
    ms = polygons_ms_.median() * (guessed_ms_ > 0 && guess_ms > 0 ? guess_ms / guessed_ms_ : 1);
  if (looks_ && !dearer_) {
    // They were made again, and of no use.
    stay_longer_by_polygons();
    return true;
  }
  if (usual_ms == 0 || ms == 0 || ms > kMayTakeInstead * usual_ms) return false;
  go_by_polygons();
  returning_ = true, trying_ = false;
  return true;
}

}  // namespace rilievo
