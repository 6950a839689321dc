// Coarse keyframes: of few texels, made at once, where the other keyframes show little of a frame,
// as after a jump.
//
// A coarse keyframe has as many texels as are made in some 40 ms by what those before took: the
// machine may be slow, or others may use it. One thread; the source uses more.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/result.h"
#include "rilievo/keyframes/keyframe.h"
#include "rilievo/keyframes/make_keyframe.h"

namespace rilievo {

// Makes them, one at a time.
class CoarseKeyframes {
 public:
  // `source` must outlive the object. It should be fast for few texels.
  explicit CoarseKeyframes(CaptureSource& source) : source_(source) {}

  // One of what this frame's eye sees of `objects` (empty: all) at a time. Fails where the source
  // does.
  [[nodiscard]] Result<Keyframe> make(const Camera& frame, std::span<const std::uint32_t> objects,
                                      double time);
  // Takes the memory of one of the first one's size, the source's too, so that this one touches no
  // new page: makes one that nobody sees, unless that was done before. Where the source fails, it
  // will fail when one is needed.
  void take_memory(const Camera& frame, std::span<const std::uint32_t> objects, double time);
  // Takes the memory of one that is not needed any more.
  void reuse(Keyframe keyframe) { spare_ = std::move(keyframe); }

 private:
  [[nodiscard]] double texels(const Camera& frame) const;

  CaptureSource& source_;
  KeyframeMaker maker_;
  Keyframe spare_;
  bool has_memory_ = false;
  int made_ = 0;
  double texel_ms_ = 0;  // of the last ones; 0: there was none
};

}  // namespace rilievo
