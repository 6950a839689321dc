// Which keyframes are made, when, and from which are frames warped?
//
// While the eye moves one keyframe after the other is made for where it will be when the next one
// is complete, so that frames lie between a keyframe behind the eye and one ahead of it. With N
// frames for each keyframe, one that is begun now is complete in N frames and replaced in 2 N: it
// is made for the eye in 2 N frames. Each frame does a part of the work (make_keyframe.h). An eye
// that stands gets a keyframe of its own, and then nothing more is made.
//
// A source that takes long for a picture has a thread of its own (`beside`): frames do not wait for
// it, and begin with coarse keyframes. While the eye moves its keyframes have as many texels as it
// makes in the time in which they are of use; an eye that stands gets a whole one, after a small
// one of its own.
//
// After a jump nothing shows what the eye sees: a keyframe is made at once, and with a limit of
// time a coarse one, by a source that is fast for few texels.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/background.h"
#include "rilievo/core/result.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/keyframes/coarse_keyframes.h"
#include "rilievo/keyframes/eye_prediction.h"
#include "rilievo/keyframes/make_keyframe.h"
#include "rilievo/keyframes/near_objects.h"
#include "rilievo/keyframes/warp_keyframes.h"

namespace rilievo {

// How keyframes are made.
struct KeyframeOptions {
  double margin = 1.2;  // of a keyframe's sides over the frame's; of an eye that turns, more
  int samples = 4;      // of a texel: 1, 4 or 16
  int interval = 16;    // the least number of frames for a keyframe
  // The farthest that the eye moves between two keyframes, as a share of the median depth of its
  // view (0.25: by 14 degrees around it). With a limit of time, keyframe_ms, there is no such
  // limit.
  double most_travel = 0.25;
  // Time of a frame for keyframes; more if one took over 32 frames, or if holes take more. 0: no
  // limit.
  double keyframe_ms = 0;
  bool beside = false;  // keyframes are made beside the frames, each at once
  // Rays of the same scene, which fill Keyframe::light (keyframe_light.h), from another thread if
  // `beside`: no one else may use them. Null: keyframes are lit as rays light.
  CaptureSource* light_rays = nullptr;
  const Sky* sky = nullptr;  // for sources that draw none; null: they do. See KeyframeRequest
};

// What producing did since the last time it was asked.
struct KeyframeWork {
  int completed = 0, coarse = 0;
  double ms = 0;
};

// Makes keyframes for one eye.
class KeyframeProducer {
 public:
  // Keyframes show `objects` (empty: all), without those that `near` chooses (null: none), but in
  // coarse ones. The sources and `near` must outlive the object; `quick` makes the coarse ones.
  KeyframeProducer(CaptureSource& source, CaptureSource& quick, const KeyframeOptions& options,
                   std::vector<std::uint32_t> objects = {}, NearObjects* near = nullptr);
  // Stops what is made beside the frames, and waits for that.
  ~KeyframeProducer();

  // Begins a frame: those to warp from. Empty before the first keyframe.
  [[nodiscard]] std::span<const WarpedKeyframe> follow(const Camera& frame, double time);
  // Makes a keyframe for this frame now, and returns those to warp from. Fails where a source does.
  [[nodiscard]] Result<std::span<const WarpedKeyframe>> make_now();
  // Takes the memory of those to come now, so that no frame that begins one touches new pages. Not
  // beside the frames.
  void take_memory();
  // The same before the first frame, which `camera` will be like, and that of the source, too: what
  // is begun for this eye is given up.
  void reserve(const Camera& camera, double time);
  // How many frames the next one is expected to take.
  [[nodiscard]] double frames_for_one() const { return columns_a_frame().frames; }
  // Those that a frame of this eye would be warped from: no frame begins.
  [[nodiscard]] std::span<const WarpedKeyframe> choose_for(const Camera& eye);
  // Ends a frame of which holes took `holes_ms`: makes a part of a keyframe, in `share_ms` if that
  // is more than options and holes allow. It may take `allowed_ms` if that is more still; then a
  // keyframe may take fewer frames than its interval, and with kAtOnce it takes one. Fails where
  // the source does.
  static constexpr double kAtOnce = HUGE_VAL;
  Result<> work(double holes_ms = 0, double allowed_ms = 0, double share_ms = 0);
  // After a frame that was warped from none: a keyframe that it completed is there now, not from
  // the next frame on. Not beside the frames.
  void take_complete();

  // Objects of which the last frame's keyframes show nothing, ascending.
  [[nodiscard]] std::span<const std::uint32_t> left_out() const { return left_out_; }

  // Hides these objects, too, ascending: keyframes show nothing of them until the next call.
  void hide(std::span<const std::uint32_t> objects);

  [[nodiscard]] bool any() const { return !ready_.empty(); }
  // Forgets all keyframes: they are of where the eye was some time ago.
  void forget();
  // How many keyframes it has made so far, coarse ones included.
  [[nodiscard]] std::uint64_t made_count() const { return made_; }
  // Is one being made by the frames?
  [[nodiscard]] bool making() const { return maker_.busy(); }
  // Has it two keyframes that are not coarse?
  [[nodiscard]] bool has_two() const;
  // Is there nothing to wait for: has it two, or the one that an eye gets that stands?
  [[nodiscard]] bool has_all() const;
  // What a frame as the last one would take if the source drew it, by what the last keyframe took:
  // some ms, rather too many than too few; 0: none is known.
  [[nodiscard]] double frame_ms() const;
  // The memory of keyframes.
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] KeyframeWork take_work();
  // Those that the last frame was warped from.
  [[nodiscard]] std::span<const WarpedKeyframe> chosen() const { return chosen_; }

 private:
  void choose();
  [[nodiscard]] KeyframeMargin margin() const;
  [[nodiscard]] Camera camera_with(const Camera& frame, KeyframeMargin margin) const;
  [[nodiscard]] Camera plain(const Camera& eye) const;
  [[nodiscard]] Camera widest() const;
  [[nodiscard]] bool stands_at(const Camera& eye) const;
  [[nodiscard]] bool has_one_of(const Camera& eye) const;
  [[nodiscard]] double texels_beside(const Camera& eye) const;
  Result<> work_beside();
  Result<> end_beside();
  [[nodiscard]] KeyframeRequest request_for(const Camera& camera) const;
  void begin(const Camera& eye, double texels = 1);
  Result<> make_whole();
  void add(Keyframe keyframe);
  void hide_objects_of_all();
  void keep_memory(Keyframe keyframe);
  void add_spare();
  [[nodiscard]] Keyframe reusable();
  // How many a frame makes: at least (of parts, once a keyframe takes too many frames) and at most,
  // and those that its time is expected to suffice for. And how many frames a keyframe is expected
  // to take.
  struct Columns {
    int least, most, expected;
    double frames;
  };
  [[nodiscard]] int interval_at_speed() const;
  [[nodiscard]] double typical_depth(const Keyframe& keyframe);
  [[nodiscard]] Columns columns_a_frame() const;
  [[nodiscard]] double frames_ahead(const Columns& columns) const;
  [[nodiscard]] double ms_a_frame() const;
  Result<int> step(const Columns& columns, const Stopwatch& watch);
  void note_cost(double ms, int columns, double visibility_ms);

  CaptureSource& source_;
  CoarseKeyframes coarse_;
  KeyframeOptions options_;
  std::vector<std::uint32_t> objects_;
  NearObjects* near_;
  std::vector<std::uint32_t> left_out_, also_hidden_, hidden_, scratch_;
  EyePrediction prediction_;
  Camera frame_;
  double time_ = 0;
  std::vector<Keyframe> ready_, spare_;  // the newest last
  std::uint64_t made_ = 0;               // how many were
  KeyframeMaker maker_;
  bool complete_ = false;  // what is made: it is used from the next frame on
  std::vector<WarpedKeyframe> chosen_;
  double typical_z_ = 0;        // of the newest one, where time does not count; 0: not known
  std::vector<float> nearest_;  // scratch of that
  double ms_per_column_ = 0;
  // Of what was made beside frames since these went on: what it would have taken them.
  double processor_ms_ = 0;
  int processor_columns_ = 0;
  double visibility_ms_ = 0, shading_ms_ = 0;  // of the last keyframe
  double holes_ms_ = 0;                        // of the last frames
  double allowed_ms_ = 0, share_ms_ = 0;       // of this frame
  bool at_once_ = false;                       // this frame makes all of one
  // Of the keyframe that is being made; and those to find what is visible.
  double made_ms_ = 0, made_visibility_ms_ = 0;
  int made_columns_ = 0, made_frames_ = 0;
  bool measured_ = false;  // was one completed?
  KeyframeWork done_;

  // Beside the frames: while in_flight_ only the other thread uses maker_, failed_ and beside_ms_.
  std::atomic<bool> in_flight_{false};
  bool ordered_ = false;  // a keyframe was, and its end was not yet seen
  int waited_ = 0, frames_for_one_ = 60;
  double beside_ms_ = 0;
  bool sharp_beside_ = false;  // the keyframe is a whole one, of an eye that stands
  Camera ordered_view_;        // the view for which it is made, as a whole one has it
  bool after_stop_ = false;    // the one before was stopped: its source may work on
  double texel_ms_ = 0;        // of the last one; 0: none was complete
  std::optional<Error> failed_;
  std::stop_source stop_;
  CaptureControl control_;
  std::optional<Background> background_;
};

}  // namespace rilievo
