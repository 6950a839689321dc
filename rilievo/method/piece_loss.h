// How much farther from the truth are frames than direct drawing, as small pieces of them tell?
//
// What SampledLoss (keyframes/software/sampled_loss.h) finds by rays this finds by polygons, which
// are where they are at the frame's time: rays know moving objects only where they began. Of a
// piece of the frame, one of 8 x 8, polygons are drawn twice: at the frame's size, and at twice
// that, which stands for the truth. A piece takes about a twelfth of a frame of polygons.
#pragma once

#include <optional>

#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/core/result.h"
#include "rilievo/frame/software/software_frames.h"

namespace rilievo {

// One of kAcross x kAcross pieces of a frame, which has the same pixels. All are as large: the last
// ones of a row and a column may overlap those before.
struct FramePiece {
  int x = 0, y = 0;  // of the frame: its first pixel
  Camera camera;
};

// The loss of the last pieces.
class PieceLoss {
 public:
  static constexpr int kAcross = 8;
  // So many pieces say what the loss is.
  static constexpr int kEnough = 16;

  // `backend` must outlive the object.
  explicit PieceLoss(SoftwareBackend& backend);

  // Looks at a piece of a frame in these colours, another one each time. Fails as draw() does.
  Result<> add(const Camera& camera, double time, const Rgba8Image& color);
  void forget() { shown_ = direct_ = counted_ = 0, pieces_ = 0; }
  // dB, without the noise of its truth; none: too few were seen.
  [[nodiscard]] std::optional<double> db() const;

 private:
  SoftwareFrames direct_frames_, fine_frames_;
  int next_ = 0, pieces_ = 0;
  double shown_ = 0, direct_ = 0, counted_ = 0;
};

// The i-th piece, from the top left.
[[nodiscard]] FramePiece piece_of(const Camera& camera, int i);

}  // namespace rilievo
