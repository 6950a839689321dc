// Draws a scene's frames from keyframes.
//
// A frame is warped from two keyframes; what neither shows is filled by rays; what moves and what
// blends is drawn as polygons into the same z-buffer. Then a part of the next keyframe is made. The
// cost depends on the frame's size, whatever the scene. A painter (keyframe_painter.h) warps and
// draws: by default on processors, into a target of its own. Uses all cores; without a limit of
// time the frames depend neither on it nor on the number of threads.
//
// With a limit of time, whole frames are polygons where these take no more time, as measured now
// and then (keyframes/cheaper_way.h).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "rilievo/frame/frame_source.h"
#include "rilievo/keyframes/keyframe_painter.h"
#include "rilievo/keyframes/keyframe_producer.h"

namespace rilievo {

class RayScene;
struct Scene;

// Who makes keyframes of a scene.
enum class KeyframesBy { raster, rays };

// Options of KeyframeFrames.
struct KeyframeFramesOptions {
  KeyframeOptions keyframes;
  KeyframesBy by = KeyframesBy::raster;
  int samples = 4;  // of a pixel, for polygons and what is filled: 1 or 4
  // Frames of which rays would have to fill a larger share get a keyframe at once, or are polygons.
  double most_filled = 0.2;
  // Up to so many holes get all samples of a pixel. Of more each gets one, which later frames show
  // again (hole_points.h).
  std::size_t most_fine = 12000;
  // Strips that both keyframes hide are looked for where they may be wider, in pixels
  // (torn_blocks.h).
  double gap_px = 4;
  NearObjectsOptions near;  // what is drawn as polygons because it is near; by the rasteriser only
  // With a limit of time: a frame spends this share of the time of the rest of its work on
  // keyframes, if that is more than the limit. 0: the limit alone. Nearer keyframes leave less to
  // fill: along nine walks frames took 0.88 to 1.15 times as long with 24 ms for them instead of 8,
  // and were up to 3 dB nearer to the truth (bench/results/keyframes.md).
  double keyframe_share = 0;
  // With a limit of time, are whole frames polygons where these take less?
  bool polygons_where_cheaper = true;
};

// The time of a frame for keyframes where none was asked for and frames are drawn in real time:
// kKeyframeMs, or kKeyframeShare of the rest of the frame if that is more.
inline constexpr double kKeyframeMs = 8, kKeyframeShare = 0.6;
inline void take_usual_time(KeyframeFramesOptions& options) {
  options.keyframes.keyframe_ms = kKeyframeMs, options.keyframe_share = kKeyframeShare;
}

// What the last frame consisted of, as shares of its pixels, and times.
struct KeyframeShares {
  double filled = 0;
  double cast = 0;      // filled by rays; the rest by what rays found in frames before
  int live = 0;         // objects that were drawn as polygons because they move or are near
  bool coarse = false;  // a coarse keyframe was made for this frame
  bool direct = false;  // it is all polygons
  int completed = 0;    // keyframes that it completed
  double polygons_ms = 0, warp_ms = 0, fill_ms = 0, tiles_ms = 0, keyframe_ms = 0;
};

// Frames of one scene.
class KeyframeFrames final : public FrameSource {
 public:
  // `scene` must be valid and outlive the source. Fails if memory does not suffice.
  [[nodiscard]] static Result<std::unique_ptr<KeyframeFrames>> create(
      const Scene& scene, const KeyframeFramesOptions& options);
  // The same with keyframes by another source, which `make` makes of the scene as rays see it
  // (empty: as `options` say), and drawn by another painter of the same scene (null: on
  // processors). Fails where `make` does.
  using MakeSource = std::function<Result<std::unique_ptr<CaptureSource>>(const RayScene&)>;
  [[nodiscard]] static Result<std::unique_ptr<KeyframeFrames>> create(
      const Scene& scene, const MakeSource& make, const KeyframeFramesOptions& options,
      std::unique_ptr<KeyframePainter> painter = nullptr);
  ~KeyframeFrames() override;

  // See FrameSource. Fail where a capture does.
  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  [[nodiscard]] const SoftwareTarget* software_target() const override;
  [[nodiscard]] const FrameStats& stats() const override;
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override;

  [[nodiscard]] const KeyframeShares& shares() const;
  // The share of the last frame's pixels that show polygons. Counts them.
  [[nodiscard]] double live_share() const;

  // From the next frame on, a frame may spend `ms` on a part of a keyframe, or what its options
  // allow if that is more. 0, the default: what its options allow.
  void allow_keyframe_ms(double ms);
  // A frame is to take at most `ms`: keyframe_share becomes smaller where it would take longer,
  // keyframe_ms does not. 0, the default: no such limit.
  void set_pace(double ms);
  // Beside a frame that something else draws: makes a part of a keyframe, in at most `allowed_ms`
  // if that is more than others take. `anew`: this is the first such frame for some time, and
  // keyframes from before are forgotten. Fails where a capture does.
  Result<> prepare(const Camera& camera, double time, bool anew, double allowed_ms = 0);
  // Beside such a frame, too, but makes nothing: it only learns how the eye moves.
  void follow(const Camera& camera, double time);
  // Forgets all keyframes, and takes the memory of those to come, so that no frame that prepares
  // them touches new pages: before such frames, which `camera` will be like, on any thread; with a
  // painter that draws with OpenGL, on that of its context. Not of keyframes that are made beside
  // the frames.
  void reserve(const Camera& camera, double time);
  // Is there a keyframe to look from?
  [[nodiscard]] bool any() const;
  // How many frames the next keyframe takes at least: its interval with a keyframe_share, since the
  // time of frames may not be known yet; else what it is expected to take.
  [[nodiscard]] double least_frames_for_one() const;
  // Warps for another eye, for sample_loss() alone. Requires a keyframe. Fails where memory does
  // not suffice.
  Result<> look_from(const Camera& camera, double time);
  // Are there keyframes to begin with?
  [[nodiscard]] bool prepared() const;
  // How many keyframes were made so far, coarse ones included.
  [[nodiscard]] std::uint64_t made_count() const;
  // Is a keyframe being made, in parts?
  [[nodiscard]] bool making() const;

  // Looks at some pixels of the last frame, `looks` times SampledLoss::kPixels, if it was warped:
  // by how many dB what was warped is farther from the truth than direct drawing
  // (keyframes/software/sampled_loss.h). Some ms for each look. None: not known yet.
  std::optional<double> sample_loss(int looks);
  // Begins anew.
  void forget_loss();
  // The scene as rays see it: what moves is where it began.
  [[nodiscard]] const RayScene& rays() const;

 private:
  struct State;
  explicit KeyframeFrames(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
