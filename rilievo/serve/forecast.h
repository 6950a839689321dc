// Where an eye will be and look: the guess that was right before.
//
// A turn goes on for a tenth of a second, and what comes later is the walker's will: a head that
// swings looks the other way half a swing later, and to go on turning is then worse than to stay.
// So there are three guesses, and the poses of the last seconds tell for each of them how wrong it
// would have been; the best is taken. They tell, too, how far off it was: a picture gets as much
// more margin.
//
//   on    what moves goes on (predicted())
//   stay  the same, but what turns stops
//   mean  the eye goes on with the mean velocity, and looks where it looked in the mean
//
// Times are those of the client's clock, in seconds. No threads.
#pragma once

#include <array>
#include <deque>

#include "rilievo/serve/message.h"

namespace rilievo {

struct Forecast {
  LivePose pose;
  // Angles in the eye's space, about its y and x axes, by which nine looks of ten were off at most,
  // radians.
  double yaw = 0, pitch = 0;
};

// The poses of one client.
class PoseHistory {
 public:
  // Of poses of ascending times; others, and jumps, make it begin anew.
  void see(const LivePose& pose);
  // For a picture that is seen from `from_s` to `to_s` after the newest pose: its pose is that of
  // the middle. Requires that a pose was seen, and 0 <= from_s <= to_s. Which guess is best is
  // found out a few times a second; who stands now stays.
  [[nodiscard]] Forecast forecast(double from_s, double to_s);

 private:
  enum class Guess { on, stay, mean };
  // The best guess for such times, and by how much it was off.
  struct Judgement {
    double at = -1e9, from_s = 0, to_s = 0;
    Guess guess = Guess::on;
    double yaw = 0, pitch = 0;
  };
  struct Past {
    double seconds = 0;
    LivePose pose;
  };
  [[nodiscard]] Judgement judged(double from_s, double to_s) const;
  // The guess for `after_s` after poses_[i].
  [[nodiscard]] LivePose guessed(Guess guess, std::size_t i, double after_s) const;
  // What was seen at a time between the first pose and the last.
  [[nodiscard]] LivePose seen_at(double seconds) const;

  std::deque<Past> poses_;               // some of the last seconds, and the newest
  std::array<Judgement, 2> judgements_;  // the newer one first
};

// The pose in `seconds`: the velocity goes on for at most a second, the turn ever more slowly.
[[nodiscard]] LivePose predicted(LivePose pose, double seconds);

}  // namespace rilievo
