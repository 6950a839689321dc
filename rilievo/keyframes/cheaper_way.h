// Are frames from keyframes cheaper than polygons, or the other way round?
//
// Both take some milliseconds a frame, which change as the eye moves. The way that is taken is
// measured in every frame. What polygons would take is guessed from what keyframes take to make;
// where it may be less, one frame is drawn by polygons, which is as right as any. Back from
// polygons the eye needs two keyframes: these are made beside some more frames of polygons.
//
// Where keyframes fail a frame, as near things pass the eye, one more that is made for it at once
// takes longer than frames do, and the next frame may need another: polygons that take about as
// long as usual frames are drawn instead, until there are keyframes again.
//
// Other programs may slow some frames down, and what was measured of the way that is not taken
// stays. So a time is the median of the last frames, and no decision is for ever: what
// keyframes take is looked at again after some frames, and after twice as many each time that
// polygons were right.
#pragma once

#include "rilievo/core/recent_times.h"

namespace rilievo {

// Decides frame by frame.
class CheaperWay {
 public:
  // Keyframes must take less than this share of polygons' time to be taken instead: a way that
  // changes back and forth costs more than either. Polygons are chosen at equal time, too: they are
  // exact.
  static constexpr double kCheaper = 0.85;
  // Frames from one that tries polygons to the next, how many fewer they are at first, and how much
  // more polygons may take by the guess.
  static constexpr int kFramesToTry = 60, kFewerAtFirst = 45;
  static constexpr double kMayTry = 1.6;
  // How many times as long as frames of keyframes those may take that are drawn where these fail.
  static constexpr double kMayTakeInstead = 1.25;
  // Frames of polygons until keyframes are made again to be looked at: at first, and at most. That
  // takes some dozen frames longer.
  static constexpr int kFramesToReturn = 120, kMostToReturn = 1920;
  // Frames of keyframes that say whether they were right to return to.
  static constexpr int kLook = 9;

  // What polygons take of the guess until they were measured, where another drawer draws them than
  // the source of keyframes: one that is worth a frame to be tried.
  static constexpr double kUnknownDrawer = 0.25;

  // `drawn_as_source`: the guesses are of what draws polygons. Else they say how much dearer
  // polygons become, and what they took says how dear they are.
  explicit CheaperWay(bool drawn_as_source = true)
      : drawn_as_source_(drawn_as_source), of_guess_(drawn_as_source ? 1 : kUnknownDrawer) {}

  // What the next frame consists of.
  enum class Way {
    keyframes,
    polygons,
    both  // polygons, while keyframes are made for what comes
  };
  [[nodiscard]] Way next() const;

  // A frame was drawn that way in `ms`, without what is made beside polygons. `guess_ms`: what
  // polygons would take, by keyframes; 0: unknown. `ready`: there are keyframes to go on with.
  void add(double ms, double guess_ms, bool ready);

  // next() told keyframes for this frame, and they show too little of it. Is it drawn by polygons
  // instead? Then next() tells the way of this frame anew. `guess_ms`: as add()'s.
  [[nodiscard]] bool leave_keyframes(double guess_ms);

 private:
  using Recent = RecentTimes<31>;

  void add_polygons(double ms, double guess_ms);
  void go_by_polygons();
  void stay_longer_by_polygons();

  bool drawn_as_source_;
  double of_guess_;  // polygons' time as a share of it
  bool polygons_ = false, trying_ = false, returning_ = false;
  bool looks_ = false;   // keyframes are drawn again, and may have to be left at once
  bool dearer_ = false;  // polygons, when keyframes began to be made again
  int since_try_ = kFewerAtFirst, frames_ = 0;
  int by_polygons_ = 0, frames_to_return_ = kFramesToReturn;
  Recent keyframes_ms_, look_ms_, polygons_ms_;
  double guessed_ms_ = 0;  // of the last frame of polygons
};

}  // namespace rilievo
