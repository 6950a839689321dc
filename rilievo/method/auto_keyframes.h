// Keyframes for `auto`: the first ones are made beside the frames, and looked at before anyone sees
// what is warped from them.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "rilievo/keyframes/eye_prediction.h"
#include "rilievo/keyframes/software/keyframe_frames.h"
#include "rilievo/method/audition.h"

namespace rilievo {

// The eye of the frames, for a thread beside them.
class SharedEye {
 public:
  struct Posted {
    EyePrediction eye;
    double time = 0;
    int frames = 1;  // since the last one that was taken
  };

  // A frame was drawn.
  void post(const EyePrediction& eye, double time);
  // Waits for a frame that was not yet taken. None: no frame will come.
  [[nodiscard]] std::optional<Posted> next();
  // Forgets a frame that was not taken.
  void forget();
  // No frame will come.
  void end();

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Posted> posted_;
  bool ended_ = false;
};

// Makes keyframes for the eye until there are enough to begin with, or some seconds long; those
// that `frames` has are of an eye some time ago. Or, if it `goes_on` with them, for so many frames,
// as much as these would make. Fails where a capture does.
[[nodiscard]] Result<> prepare_keyframes(SharedEye& eye, KeyframeFrames& frames, int goes_on = 0);

// Where the eye was, in frames before the one that is shown, `frames` after the last one that was
// taken: places that keyframes follow, and in the last `parts` of which they are made. They predict
// the eye by its mean step, for dozens of steps: so it takes no larger ones where frames go by, nor
// where the last one was long ago (`anew`).
[[nodiscard]] std::vector<double> way_to_frame(int frames, int parts, bool anew);

// Keyframes to begin with.
struct BegunKeyframes {
  std::optional<double> loss_db;  // none: not known
  bool begun = false;             // frames can be drawn: from two, or from the first one `alone`
  bool alone = false;
};
// What the first one may lose alone, dB. With more than `most` a second one, which brings a few dB,
// would be of no use. With at most `alone` it is made beside the frames, in at most half as many as
// others may take: at once it takes tenths of a second.
struct AloneLoss {
  double most = 0, alone = 0;
};

// Looks at what is warped from the first one, which was made in the frame before, where the eye
// will be in a while; makes the second one at once if it must, and looks again. Fails where a
// capture does.
[[nodiscard]] Result<BegunKeyframes> begin_keyframes(const EyePrediction& eye, double time,
                                                     const AloneLoss& may_lose,
                                                     KeyframeFrames& frames);

// KeyframeFrames::sample_loss(), without the noise of its own truth.
[[nodiscard]] std::optional<double> loss_of(KeyframeFrames& frames);

// Draws a frame for the eye of the one that is shown. `loss`, of the same scene, may be null: then
// it is not known how good the cache is.
[[nodiscard]] Audition audition_keyframes(const ShownFrame& shown, FrameLoss* loss,
                                          KeyframeFrames& frames);

}  // namespace rilievo
