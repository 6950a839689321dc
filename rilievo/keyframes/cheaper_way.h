// Are frames from keyframes cheaper than polygons, or the other way round?
//
// Both take some milliseconds a frame, which change as the eye moves. The way that is gone is
// measured in every frame. What polygons would take is guessed from what keyframes take to make;
// where it may be less, one frame is drawn by polygons, which is as right as any. Back from
// polygons the eye needs two keyframes: these are made beside some more frames of polygons.
//
// Other programs may slow some frames down, and what was measured of the way that is not gone does
// not change. So a time is the median of the last frames, and no decision is for ever: what
// keyframes take is looked at again after some frames, and after twice as many each time that
// polygons were right.
#pragma once

#include <array>
#include <cstddef>

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
  // Frames of polygons until keyframes are made again to be looked at: at first, and at most. That
  // takes some dozen frames longer.
  static constexpr int kFramesToReturn = 120, kMostToReturn = 1920;
  // Frames of keyframes that say whether they were right to return to.
  static constexpr int kLook = 9;

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
  // The median of the last frames.
  class Recent {
   public:
    void add(double ms) { last_[std::size_t(count_++ % kCount)] = ms; }
    void forget() { count_ = 0; }
    [[nodiscard]] int count() const { return count_; }
    // 0: there was none.
    [[nodiscard]] double median() const;

   private:
    static constexpr int kCount = 31;
    std::array<double, kCount> last_{};
    int count_ = 0;
  };

  void go_by_polygons();

  bool polygons_ = false, trying_ = false, returning_ = false;
  bool looks_ = false;  // keyframes are drawn again, and may have to be left at once
  int since_try_ = 0, frames_ = 0;
  int by_polygons_ = 0, frames_to_return_ = kFramesToReturn;
  Recent keyframes_ms_, polygons_ms_;
};

}  // namespace rilievo
