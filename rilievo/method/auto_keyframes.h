// Keyframes for `auto`: the first ones are made by frames that something else draws, or beside
// them, and looked at before anyone sees what is warped from them.
#pragma once

#include <cmath>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "rilievo/core/image.h"
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
  // The last one, whether it was taken or not. None: no frame was drawn since the last forget().
  [[nodiscard]] std::optional<Posted> latest();
  // Forgets the frames so far.
  void forget();
  // No frame will come.
  void end();

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Posted> latest_;
  bool taken_ = false;  // latest_ was
  bool ended_ = false;
};

// Makes keyframes for the eye until there are enough to begin with, or some seconds long; those
// that `frames` has are of an eye some time ago. Fails where a capture does.
[[nodiscard]] Result<> prepare_keyframes(SharedEye& eye, KeyframeFrames& frames);

// Makes one more keyframe beside the frames: the eye leaves those that `frames` has behind while
// they are looked at. For an eye that stands it may make none. Fails where a capture does.
[[nodiscard]] Result<> make_next_keyframe(SharedEye& eye, KeyframeFrames& frames);

// Where the eye was, in frames before the one that is shown, `frames` after the last one that was
// taken: places that keyframes follow, and in the last `parts` of which they are made. They predict
// the eye by its mean step, for dozens of steps: so it takes no larger ones where frames go by, nor
// where the last one was long ago (`anew`).
[[nodiscard]] std::vector<double> way_to_frame(int frames, int parts, bool anew);

// Tells keyframes that are prepared by frames, from the next one on, how the eye has moved.
void follow_way(const EyePrediction& eye, double time, KeyframeFrames& frames);

// The time that a frame may spend on keyframes that it makes a part of, where the frame took `ms`
// and such frames take `usual_ms`: both together take about 1.6 times that, or what that frame
// takes and a little. With less time keyframes would take so many frames that these, which are
// slower, would raise the median of a walk. Where frames of keyframes are expected to take far
// less, `keyframes_ms`, than such frames and than polygons, the sooner there are two the better: a
// frame makes all of one. The frames alone do not say so: the cache's first ones capture.
[[nodiscard]] double time_for_keyframes(double ms, double usual_ms, double polygons_ms,
                                        double keyframes_ms);

// The time of a usual frame, to which time_for_keyframes() compares the others: the mean of the
// method that draws, once that has warmed up. Before, the least so far: other frames capture
// pictures, or are slowed down by other programs.
class UsualTime {
 public:
  // After a frame of `ms`. `drawn_ms`: the mean of the method that draws (0: not known yet);
  // `warm`: it has warmed up.
  [[nodiscard]] double add(double ms, double drawn_ms, bool warm);
  // The eye is elsewhere, or the frame has another size: the least so far says nothing.
  void forget() { least_ms_ = HUGE_VAL; }

 private:
  double least_ms_ = HUGE_VAL;
};

// Are the first keyframes given up, which frames make parts of? Where what draws takes far less
// than frames of keyframes would by their model, which may be off by half, for a dozen frames in a
// row.
class KeyframesDoubt {
 public:
  // After a frame of what draws, warm, whose frames take `drawn_ms`. Are they given up?
  [[nodiscard]] bool add(double drawn_ms, double keyframes_ms);

 private:
  int frames_ = 0;
};

// Will frames from more keyframes lose more than is allowed? `loss_db` is the loss of frames from
// the first one alone, of which later ones leave three fifths at most; `cache_loss_db` that of the
// cache's frame at the same time (none: not known). `drew`: keyframes have drawn before, so that
// more is known of them than what was looked at now.
[[nodiscard]] bool first_is_hopeless(double loss_db, std::optional<double> cache_loss_db,
                                     double allowed_db, bool drew);

// Of what two looks at the cache's frames found, the least: one look sees a part of the pixels of
// one frame, and goes to and fro by 0.4 to 0.65 dB (a standard deviation, along three flights,
// where the loss was the same from end to end). What it found too much keyframes would be allowed
// to lose for as long as they draw.
[[nodiscard]] std::optional<double> least_loss(std::optional<double> a, std::optional<double> b);

// Are keyframes good enough beside a cache that loses that, as rays measure both? Here they may not
// lose kAsGoodDb more than the cache: along two of the flights rays say 1 dB more of the cache than
// true frames do, and as much or less of keyframes. Before they `drew` nobody has seen them, and
// what was looked at is one frame, which suffices where the cache is bad, too.
[[nodiscard]] bool good_beside_cache(double loss_db, std::optional<double> cache_loss_db,
                                     double allowed_db, bool drew);

// What frames of keyframes will take, where one took `ms` and `fill_ms` of that for holes: between
// the first two there are more of these than there will be. `young`: there is no third one yet.
[[nodiscard]] double ms_when_settled(double ms, double fill_ms, bool young);

// A trial of keyframes ended so many frames ago, or they were taken then, and the cache, which
// warms up for `warm_up` frames, draws. Are they kept until it is known what it takes now? It was
// compared by what it took before; where that was little less they may be the cheaper ones, and
// would have to be made again.
[[nodiscard]] bool kept_after_trial(int frames, int warm_up, double keyframes_ms, double cache_ms);

// What is warped from keyframes loses where the eye will be when the next one is half complete, as
// far as these show it; halfway both are the farthest. One that gets a share of frames is taken to
// come as soon as it may: frames are looked at when they draw. `age`: where the next one is made at
// once, the frames since the newest was made: the middle between the two is nearer by half of that.
// None: it is not known. Fails where memory does not suffice.
[[nodiscard]] Result<std::optional<double>> loss_ahead(const EyePrediction& eye, double time,
                                                       KeyframeFrames& frames, int age = 0);

// The same ahead of where the eye is now. None: no frame was drawn yet, too.
[[nodiscard]] Result<std::optional<double>> loss_ahead(SharedEye& eye, KeyframeFrames& frames);

// The camera moved sideways until what is at the median distance of a frame has moved by so many
// pixels. `inverse_z`: of that frame, as SoftwareTarget's. Where it shows only the sky it stays.
[[nodiscard]] Camera eye_aside(const Camera& camera, const Image<float>& inverse_z, double pixels);

// What is warped from the first keyframe loses before it is known how the eye will move: seen from
// so many pixels aside, `inverse_z` as above. None: it is not known. Fails where memory does not
// suffice. A person's eye moves things by 1 to 3 pixels a frame: kSoonAside is where it is after
// about a dozen frames, kLongAside where it is before there is a second keyframe.
inline constexpr double kSoonAside = 24, kLongAside = 64;
[[nodiscard]] Result<std::optional<double>> loss_aside(const Camera& camera, double time,
                                                       const Image<float>& inverse_z, double pixels,
                                                       KeyframeFrames& frames);

// KeyframeFrames::sample_loss() of so many looks, without the noise of its own truth.
[[nodiscard]] std::optional<double> loss_of(KeyframeFrames& frames, int looks);

// Draws a frame for the eye of the one that is shown, and looks ahead of where the eye is by then,
// too: the larger loss counts. How good the cache is the same rays say: what moves must be left out
// of `shown`.
[[nodiscard]] Audition audition_keyframes(const ShownFrame& shown, SharedEye& eye,
                                          KeyframeFrames& frames);

}  // namespace rilievo
