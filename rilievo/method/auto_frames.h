// The frames of `auto` (method/auto.h). Internal: not a stable interface.
//
// auto_begin.cpp: before the first frame. auto_prepare.cpp: beside the frames. auto_loss.cpp: how
// good they are. auto.cpp: the frames.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "rilievo/core/idle_thread.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/method/audition.h"
#include "rilievo/method/auto_decision.h"
#include "rilievo/method/auto_keyframes.h"
#include "rilievo/method/auto_levels.h"
#include "rilievo/method/direct_or_cached.h"
#include "rilievo/method/frame_fade.h"
#include "rilievo/method/frame_load.h"
#include "rilievo/method/machine_slowness.h"
#include "rilievo/method/method.h"
#include "rilievo/method/moved_objects.h"
#include "rilievo/method/piece_loss.h"
#include "rilievo/render/rays/ray_visibility.h"

namespace rilievo {

// The frames of `auto`.
class AutoFrames final : public FrameSource {
 public:
  static Result<std::unique_ptr<AutoFrames>> create(const MethodOptions& options, Backend& backend);

  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  [[nodiscard]] const SoftwareTarget* software_target() const override { return shown_; }
  [[nodiscard]] const FrameStats& stats() const override { return stats_; }
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override {
    return active_->read_pictures();
  }
  void follow(const MethodOptions& options);
  // What is made beside the frames waits for the eye.
  ~AutoFrames() override { shared_eye_.end(); }

 private:
  enum Methods { kDirect, kCache, kRays, kLevels, kKeyframes, kMethods };

  // Frames of the cache after a change until it has the pictures that it wants.
  static constexpr int kCacheWarmsUp = 12;
  // The first frames of what has its own memory are slower.
  static constexpr int kWarmsUp = 1;
  // Keyframes are good enough in about half of the walks that were measured
  // (bench/results/auto.md).
  static constexpr double kKeyframesChance = 0.5;
  // Until there are three: those that began are filled more where the eye leaves the second one.
  static constexpr int kKeyframesDwell = 48;
  // Keyframes that nobody wanted are made again after so many frames.
  static constexpr int kKeyframesAgain = 80;
  // Keyframes that no frame was drawn from for so many frames are of elsewhere.
  static constexpr int kKeyframesLast = 8;
  // A frame so long ago that it counts for nothing.
  static constexpr int kNever = -10000;
  // Of larger meshes the tree of rays takes too much memory.
  static constexpr std::uint64_t kMostForLoss = 2'000'000;
  // How far off models are taken to be, at most, by a frame that was drawn beside the others.
  static constexpr double kMostOff = 5;

  static constexpr AutoCandidate kCandidates[] = {
      {"direct", 0, 0},
      {"cache", 1, kCacheWarmsUp},
      {"rays", 0, kWarmsUp},
      {"lod", 2, kWarmsUp},
      {"keyframes", 3, kWarmsUp, kKeyframesChance, kKeyframesDwell}};

  // What is made on another thread, while frames are drawn.
  struct Prepared {
    Result<std::unique_ptr<RayVisibility>> rays{Error{}};
    AutoLevels levels;
    std::unique_ptr<KeyframeFrames> keyframes;
    bool failed = false;
    double error_px = 0;                         // that was asked for when it began
    ShownFrame shown;                            // what it is compared with
    bool followed = false;                       // keyframes know how the eye moves
    bool jumped = false;                         // the eye did, since they were last told
    int jumped_in = 0;                           // the frame in which it did last
    bool by_frames = false, first_seen = false;  // keyframes: frames make them; the first was seen
    KeyframesDoubt doubt;                        // of those
    UsualTime usual;
    bool given_up = false;
    Audition found;
  };

  // How far what is prepared is: it is being made beside the frames; frames make parts of it; what
  // the first keyframe shows is looked at; it waits for a frame to be compared with; and that.
  enum class Preparing { made, by_frames, first_looked_at, shown, looked_at };

  AutoFrames(const MethodOptions& options, Backend& backend)
      : options_(options),
        backend_(backend),
        threads_(options.by_clock ? int(std::max(1u, std::thread::hardware_concurrency())) : 2),
        triangles_(count_triangles(backend.scene())),
        meshes_triangles_(count_mesh_triangles(backend.scene())),
        moved_(backend.scene()) {}

  [[nodiscard]] static std::uint64_t count_mesh_triangles(const Scene& scene);
  Result<> begin(const Camera& camera, double time);
  Result<bool> begin_with_keyframes(const Camera& camera, double time);
  Result<bool> count_polygons(const Camera& camera, double time);
  [[nodiscard]] double polygons_over_keyframes(double direct_ms) const;
  bool make_first_keyframe(const Camera& camera, double time);
  [[nodiscard]] Result<std::unique_ptr<KeyframeFrames>> make_keyframes(const Scene& scene) const;
  void look(const Camera& camera);
  void measure_load(const Camera& camera);
  [[nodiscard]] bool in_a_hurry(double guess_ms) const;
  [[nodiscard]] bool good_enough(int method);
  [[nodiscard]] bool keyframes_good_enough(double loss_db) const;
  [[nodiscard]] bool keyframes_known() const;
  // They draw, but for a trial of another, or are tried.
  [[nodiscard]] bool draws_keyframes() const {
    return keyframes_ && (drawn_by_ == kKeyframes || decision_->draws() == kKeyframes);
  }
  [[nodiscard]] bool looks_exact(int method) const;
  void learn_direct(double ms, bool trial);
  void learn_slowness(MachineSlowness::Source source, double times, bool at_most);
  Result<> measure_loss(const Camera& camera, double time, const AutoChoice& choice);
  Result<> measure_loss_of_levels(const Camera& camera, double time);
  void forget_levels();
  void forget_loss(int method);
  [[nodiscard]] bool keep_keyframes(const Camera& camera, double time, const AutoChoice& choice);
  [[nodiscard]] Result<std::optional<double>> look_at_levels(const Camera& camera, double time,
                                                             bool again);
  [[nodiscard]] double keyframe_ms() const {
    return options_.keyframe_ms > 0 ? options_.keyframe_ms : kKeyframeMs;
  }
  // Frames that take less keep the pace that is asked for; 0: none is.
  [[nodiscard]] double pace_ms() const {
    return options_.fps > 0 ? AutoDecision::kKeepsPace * 1000 / options_.fps : 0;
  }
  [[nodiscard]] double allow_second_keyframe(double ms);
  void follow_first_keyframes();
  void end_first_keyframe();
  void prepare(int method, const Camera& camera, double time);
  void make_part(const Camera& camera, double time, double ms);
  void look_at_first_keyframe(const Camera& camera, double time, int age);
  bool keep_shown(const Camera& camera, double time, int drawn_by);
  [[nodiscard]] KeyframeFrames* prepared_keyframes() const {
    return keyframes_ ? keyframes_ : made_.keyframes.get();
  }
  [[nodiscard]] bool as_large_as_shown(const Camera& camera) const;
  void begin_fade(int to);
  void leave_place();
  void let_cache_catch_up(const Camera& camera, bool draws);
  void fade(const Camera& camera, double time);
  void show(const Camera& camera, double time, int drawn_by);
  void look_at_prepared();
  Result<> adopt();

  MethodOptions options_;
  Backend& backend_;
  int threads_;  // by counts as on the machine of FrameLoad, so that all machines draw the same
  std::uint64_t triangles_, meshes_triangles_;
  bool only_direct_ = true, caches_ = false;  // nothing else may draw; the cache may
  bool cheap_ = false;  // what is in view: there is nothing that the cache could gain
  bool bends_ = false, masked_ = false, moves_ = false;
  int width_ = 0, height_ = 0;
  std::optional<AutoDecision> decision_;
  EyePrediction eye_;
  std::vector<AutoOutlook> outlook_;
  std::vector<std::uint32_t> in_view_;
  FrameLoad load_;  // of the last look

  DirectOrCached* shared_chooser_ = nullptr;       // of frames_[kDirect]
  std::unique_ptr<FrameSource> frames_[kMethods];  // kCache: none, they are kDirect's
  KeyframeFrames* keyframes_ = nullptr;            // of frames_[kKeyframes]
  int keyframes_seen_ = 0;    // the last frame that they drew, or were prepared for
  int young_keyframes_ = 0;   // frames until they are as they will be, if none is completed before
  bool first_alone_ = false;  // they draw from the one that the first frame of all made
  bool second_made_ = false;  // the next frame draws from another, too
  int keyframes_again_ = 0;   // the first frame in which they may be prepared again
  AutoLevels levels_;         // of frames_[kLevels]
  double looked_triangles_ = 0;  // in view, when it was seen what they lose
  FrameSource* active_ = nullptr;
  FrameFade fade_;                         // from another method's frames
  MovedObjects moved_;                     // since the frame that it fades from
  int fades_out_ = -1;                     // that method
  int still_frames_ = 0;                   // the eye has not moved for so many
  const SoftwareTarget* shown_ = nullptr;  // the last frame; null: no software drew it
  Camera shown_camera_;
  double shown_time_ = 0;
  bool refined_ = false;  // levels draw with a smaller error from the next frame on
  FrameStats stats_;
  bool failed_[kMethods] = {};

  int preparing_ = -1;
  Preparing stage_ = Preparing::made;  // of preparing_: what it waits for
  struct Loss {
    std::optional<double> db;  // none: not known
    int seen_in = 0;           // the last frame that the method drew
    int refusals = 0;          // since it was seen to be good enough
  } loss_[kMethods];
  double off_[kMethods] = {1, 1, 1, 1, 1};  // times as much as its model says; 1: not measured
  std::optional<double> cache_loss_;        // none: not known
  int cache_drawn_ = kNever;                // the last frame that it drew
  bool catches_up_ = false;                 // the fade is to its pictures of some frames ago
  std::unique_ptr<FrameLoss> losses_;       // of the other thread, while something is prepared
  std::optional<FrameLoss> looks_;          // at levels that draw, by the same rays
  std::optional<PieceLoss> pieces_;         // of levels, where rays do not know the scene
  SharedEye shared_eye_;
  std::atomic<bool> prepared_{false};
  Prepared made_;
  bool begins_with_keyframes_ = false;  // from the first frame on they are prepared
  int begun_in_ = 0;                    // frame
  int begun_drawn_ = -1;                // what drew the first frame, to find out; -1: none
  double begun_ms_ = 0;                 // what that took
  int frame_ = 0, direct_frames_ = 0, drawn_by_ = kDirect;
  bool direct_counted_ = false;  // how far off polygons' model is was counted, not timed
  MachineSlowness slowness_;
  bool hurries_ = false;
  std::optional<IdleThread> beside_;  // last: it ends first
};

}  // namespace rilievo
