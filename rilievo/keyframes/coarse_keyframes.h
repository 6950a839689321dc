// Makes coarse keyframes, for frames of which no other keyframe shows enough, as after a jump.
//
// A coarse keyframe has few texels and is made at once. Its size is what the source captures in
// about 40 ms, by the time that earlier ones took, so that a slow or busy machine makes smaller
// ones. One thread; the source uses more.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/result.h"
#include "rilievo/keyframes/keyframe.h"
#include "rilievo/keyframes/make_keyframe.h"

namespace rilievo {

// Makes them one at a time.
class CoarseKeyframes {
 public:
  // `source` must outlive the object. It should be fast for few texels.
  explicit CoarseKeyframes(CaptureSource& source) : source_(source) {}

  // Makes a keyframe of this frame's view. It shows `objects` (indices into Scene::objects; empty:
  // all) at `time` (seconds). Fails where the source does.
  [[nodiscard]] Result<Keyframe> make(const Camera& frame, std::span<const std::uint32_t> objects,
                                      double time);
  // Allocates what the first keyframe needs, also within the source, so that make() does not wait
  // for new pages: makes a keyframe and discards it. Does nothing if one was made before. An error
  // of the source is left to make().
  void take_memory(const Camera& frame, std::span<const std::uint32_t> objects, double time);
  // Gives back a keyframe that is not needed any more: the next one reuses its memory.
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
