// Are frames from keyframes cheaper than polygons, or the other way round?
//
// Both take some milliseconds a frame, which change as the eye moves. The way that is gone is
// measured in every frame. What polygons would take is guessed from what keyframes take to make;
// where it may be less, one frame is drawn by polygons, which is as right as any. Back from
// polygons the eye needs two keyframes: these are made beside some more frames of polygons.
#pragma once

namespace rilievo {

// Decides frame by frame.
class CheaperWay {
 public:
  // Polygons must take less than this share of keyframes' time, and keyframes less than this share
  // of polygons', to be gone instead: a way that changes back and forth costs more than either.
  static constexpr double kCheaper = 0.9;
  // Frames from one that tries polygons to the next, and how much more they may take by the guess.
  static constexpr int kFramesToTry = 60;
  static constexpr double kMayTry = 1.6;

  // What the next frame consists of.
  enum class Way {
    keyframes,
    polygons,
    both  // polygons, while keyframes are made for what comes
  };
  [[nodiscard]] Way next() const;

  // A frame was drawn that way in `ms`. `guess_ms`: what polygons would take, by keyframes; 0:
  // unknown. `ready`: there are keyframes to go on with.
  void add(double ms, double guess_ms, bool ready);

 private:
  bool polygons_ = false, trying_ = false, returning_ = false;
  int since_try_ = 0, frames_ = 0;
  double keyframes_ms_ = 0, polygons_ms_ = 0;
};

}  // namespace rilievo
