// Makes a keyframe step by step, by any capture source: a part of it between two frames, and the
// rest later.
//
// A source that captures in parts (PictureInParts) gives one row after the other. Of others a few
// columns are captured by a camera of their own. Columns, because each of them crosses the horizon,
// where most of a scene is: of rows some would take many times as long as others. Work is measured
// in columns either way. Colours have 1, 4 or 16 samples a texel.
// A keyframe is captured at twice the size, with a quarter of the samples: each quarter of a texel
// has a colour, and of the four depths the second nearest stays, and the mean of those on its
// surface. What the quarters show tells where silhouettes are; and where a frame's pixel lies
// between texels, it is as sharp as if it lay on one. Quarters of one sample are smoothed a little,
// within their surface: about as much as the width of a pixel does. One thread; the source uses
// more.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
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
  // For an eye that stands, whose pixels are the keyframe's texels: quarters are not smoothed.
  bool sharp = false;
  double time = 0;  // seconds
  bool coarse = false;
  // Drawn behind what a source captures that draws none of its own (such as the ray tracer), and
  // behind what covers a texel in part. Null: the source draws it.
  const Sky* sky = nullptr;
  // Rays of the same scene, which fill Keyframe::light (keyframe_light.h). Null: it stays empty.
  CaptureSource* light_rays = nullptr;
  // Objects of its view that are not among `objects` (Keyframe::left_out). Copied
  std::span<const std::uint32_t> left_out = {};
};

// Do its texels have quarters? Those of so many samples have, but for whole ones.
[[nodiscard]] inline bool makes_quarters(int samples, bool whole_texels = false) {
  return samples == 16 || (samples == 4 && !whole_texels);
}

// Some rows of a picture as it was captured, from `first` on, with a column more on either side.
struct KeyframeBand {
  int width = 0, first = 0, rows = 0;
  std::vector<std::uint32_t> colors;  // sRGB bytes
  std::vector<float> inverse_z;
  std::vector<std::uint32_t> objects;

  [[nodiscard]] std::size_t stride() const { return std::size_t(width) + 2; }
  // Of column 0 of a row.
  [[nodiscard]] std::size_t at(int row) const { return std::size_t(row - first) * stride() + 1; }
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

  // Begins to capture in parts, if the source does that; otherwise, and later, changes nothing.
  // Requires busy().
  void start(CaptureSource& source, const CaptureControl* control = nullptr);
  // The columns of a band are a multiple.
  static constexpr int kBand = 16;
  // Makes the next columns (of bands, rounded up to a multiple of kBand), or as much of the work.
  // Requires busy(). Fails where the source does, which must outlive the maker.
  Result<> step(CaptureSource& source, int columns, const CaptureControl* control = nullptr);
  // The complete keyframe. Requires that it was begun and is not busy().
  [[nodiscard]] Keyframe take();
  // Stops; returns its memory.
  [[nodiscard]] Keyframe give_up();

  // Is it captured in parts? Steps may be small then. Known after start() and the first step.
  [[nodiscard]] bool in_parts() const { return by_parts_; }
  // Is it to be, by this source? Where that is too large, it is not, after all.
  [[nodiscard]] bool takes_parts(CaptureSource& source);
  // Captured in parts: is all known that is visible, so that what is left is shading?
  [[nodiscard]] bool shades() const { return shades_; }

 private:
  [[nodiscard]] bool smooth() const;
  [[nodiscard]] CaptureRequest request_to_capture(const CaptureControl* control) const;
  [[nodiscard]] bool begin_parts(CaptureSource& source, const CaptureControl* control);
  void step_of_parts(int columns);
  Result<> step_of_bands(CaptureSource& source, int columns, const CaptureControl* control);

  KeyframeRequest request_;
  std::vector<std::uint32_t> objects_;
  Keyframe keyframe_;
  KeyframeBand band_;
  DepthImage rows_of_parts_;
  int next_ = 1 << 30;  // column
  const CaptureSource* parts_of_ = nullptr;
  std::unique_ptr<PictureInParts> parts_;  // null: parts_of_ has none
  bool started_ = false;                   // start() or step() was called for this keyframe
  bool by_parts_ = false;                  // this keyframe is captured in parts
  bool shades_ = false;                    // and some of its rows can be read
  int rows_ = 0, ranges_ = 0;              // rows of texels that are complete, and with ranges
};

// All at once.
[[nodiscard]] Result<Keyframe> make_keyframe(CaptureSource& source, const KeyframeRequest& request,
                                             const CaptureControl* control = nullptr);

}  // namespace rilievo
