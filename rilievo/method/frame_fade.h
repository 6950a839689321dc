// Fades from the frames of one method to those of another.
//
// Where two methods show the same in different ways a change from one to the other pops. For some
// frames each pixel is mixed with what the last frame before the change shows at the same place:
// the new frame's depth says where that is. What the old frame does not show is new at once, and so
// is what the eye has passed close by, which shines otherwise, what has moved, where it was and
// where it is, and what differs by no more than the old frame does between its texels there. So the
// methods do not both have to draw.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/method/fade_tile.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {

// A fade, or none.
class FrameFade final : private TileDrawer {
 public:
  static constexpr int kFrames = 8;
  // Where both methods are measured to be as near to the truth as can be seen: a small part of the
  // frame may still differ.
  static constexpr int kFewFrames = 2;
  // What is left of the old frame is not seen where a tile differs by fewer levels, of 255, in the
  // mean: then the fade ends. A level is about 0.015 of FLIP, as little as frames of one method
  // change more than the true ones do.
  static constexpr double kUnseen = 1;

  // Takes the memory for frames of this size now, so that no fade does.
  void reserve(int width, int height);
  // From `shown`, a frame of `camera`, in so many frames. May be the target() of a fade that goes
  // on. `to_the_end`: it does not end sooner where it is no longer seen.
  void begin(const SoftwareTarget& shown, const Camera& camera, int frames = kFrames,
             bool to_the_end = false);
  void end() { left_ = 0; }
  [[nodiscard]] bool goes_on() const { return left_ > 0; }
  // The share of its frames that are to come.
  [[nodiscard]] double left() const { return double(left_) / of_; }
  // The frames that were mixed, of a fade that goes on. What fades out is nearly all that they show
  // after a few: to fade back takes no more frames than that.
  [[nodiscard]] int mixed() const { return of_ - left_; }

  // The next frame, which must be of the same size. `moved`: in world space, boxes around each
  // thing that has moved since the frame before the fade, where it was and where it is. Requires
  // goes_on().
  void mix(const SoftwareTarget& frame, const Camera& camera, std::span<const Box> moved = {});
  // Its objects are those of the frame that was mixed last.
  void draw_objects();
  // The last frame that was mixed. It has one sample a pixel.
  [[nodiscard]] const SoftwareTarget& target() const { return target_; }

 private:
  void draw_tile(FrameTile& tile) const override;

  int of_ = kFrames, left_ = 0;
  bool to_the_end_ = false;
  mutable std::atomic<double> most_{0};  // levels, of all tiles of a frame
  Rgba8Image old_;
  Image<float> old_inverse_z_;
  Camera old_camera_, camera_;
  SoftwareTarget target_{1, 1, 1};
  const SoftwareTarget* frame_ = nullptr;
  std::vector<MovedThing> moved_;
  FadedFrames frames_;
};

}  // namespace rilievo
