// Makes a keyframe band by band, by any capture source.
//
// A band is a few columns, captured by a camera of their own: it can be made between two frames,
// and the rest later. Columns, because each of them crosses the horizon, where most of a scene is:
// of rows some would take many times as long as others. Colours have 1, 4 or 16 samples a texel.
// A band is captured at twice the size, with a quarter of the samples: each quarter of a texel has
// a colour, and of the four depths the second nearest stays, and the mean of those on its surface.
// What the quarters show tells where silhouettes are; and where a frame's pixel lies between
// texels, it is as sharp as if it lay on one. Quarters of one sample are smoothed a
// little, within their surface: about as much as the width of a pixel does. One thread; the source
// uses more.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/result.h"
#include "rilievo/keyframes/keyframe.h"

namespace rilievo {

struct Sky;

// What to make.
struct KeyframeRequest {
  Camera camera;
  std::span<const std::uint32_t> objects = {};  // that it shows; empty: all. Copied
  int samples = 4;                              // of a texel: 1, 4 or 16
  // Of a source for which four texels take four times as long as four samples of one: it captures a
  // band of 1 or 4 samples at its own size, without quarters.
  bool whole_texels = false;
  double time = 0;  // seconds
  bool coarse = false;
  // Drawn behind what a source captures that draws none of its own (such as the ray tracer), and
  // behind what covers a texel in part. Null: the source draws it.
  const Sky* sky = nullptr;
  // Objects of its view that are not among `objects` (Keyframe::left_out). Copied
  std::span<const std::uint32_t> left_out = {};
};

// A band as it was captured, with a column more on either side.
struct KeyframeBand {
  Image<std::uint32_t> colors;  // sRGB bytes
  Image<float> inverse_z;
};

// A keyframe that is being made.
class KeyframeMaker {
 public:
  // Begins anew; what was made before is lost. Takes the memory of `reuse`.
  void begin(const KeyframeRequest& request, Keyframe reuse = {});
  // Is there a keyframe that is begun and not complete?
  [[nodiscard]] bool busy() const { return next_ < keyframe_.camera.width; }
  [[nodiscard]] int columns_left() const { return keyframe_.camera.width - next_; }
  [[nodiscard]] const Camera& camera() const { return keyframe_.camera; }

  // The columns of a band are a multiple.
  static constexpr int kBand = 16;
  // Makes the next columns (rounded up to a multiple of kBand). Requires busy(). Fails where the
  // source does.
  Result<> step(CaptureSource& source, int columns, const CaptureControl* control = nullptr);
  // The complete keyframe. Requires that it was begun and is not busy().
  [[nodiscard]] Keyframe take();
  // Stops; returns its memory.
  [[nodiscard]] Keyframe give_up();

 private:
  KeyframeRequest request_;
  std::vector<std::uint32_t> objects_;
  Keyframe keyframe_;
  KeyframeBand band_;
  int next_ = 1 << 30;  // column
};

// All at once.
[[nodiscard]] Result<Keyframe> make_keyframe(CaptureSource& source, const KeyframeRequest& request,
                                             const CaptureControl* control = nullptr);

}  // namespace rilievo
