// Relief impostors in a frame: which objects, and which of their boards (S5.1, S5.7).
//
// Impostors and polygons share the z-buffer. In the background, the frame never waits: it draws
// the best there is of each impostor, or the object itself as polygons. Otherwise each frame waits
// for the pictures that it needs, so that the same input gives the same frames, whatever the number
// of workers. No kind of the list: its pictures are shaded while frames are drawn, so that there is
// nothing to bake or to save, and its source must live as long as it does.
#pragma once

#include <memory>
#include <vector>

#include "rilievo/cache/plan/eye_motion.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/frame/backend.h"
#include "rilievo/relief_impostor/impostor_content.h"
#include "rilievo/relief_impostor/impostor_drawable.h"
#include "rilievo/representation/object_drawable.h"

namespace rilievo {

// How they are made.
struct ImpostorFramesOptions {
  WorkerOptions workers;
  bool background = false;  // frames do not wait
  bool outlines = false;
};

// The state of an impostor, for a panel.
struct ImpostorStatus {
  std::uint32_t object = 0;  // the first in whose place it stands
  bool in_view = false;
  ImpostorFrame frame;  // its board: until the next frame
};

// Chooses frames with relief impostors.
class ImpostorChooser final : public FrameChooser {
 public:
  // `placed` must be at the time at which `content` was made. Draws from `boards`, which decide on
  // the backend.
  ImpostorChooser(const PlacedScene& placed, std::unique_ptr<PrewarpedBoards> boards,
                  ImpostorContent content, const ImpostorFramesOptions& options);

  void add_sets(FrameContent& content) override;
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats& stats) override;
  void drawn(const FrameWork* work, FrameStats& stats) override;
  [[nodiscard]] bool shows_blended(std::uint32_t object) const override;

  // The states in the last frame.
  [[nodiscard]] std::span<const ImpostorStatus> statuses() const { return statuses_; }
  [[nodiscard]] ImpostorWorkers& workers() { return *workers_; }
  [[nodiscard]] const ImpostorContent& impostors() const { return content_; }

 private:
  [[nodiscard]] std::optional<ImpostorEye> eye_of(std::size_t impostor, const Camera& camera,
                                                  const PlacedScene& placed);
  void settle();

  struct Followed {
    ObjectDrawable place;  // of its objects at capture; without a drawable
    glm::dmat4 motion{1.0};
    EyeMotion eyes;                   // in the space at capture
    glm::dvec3 step{0.0}, turn{0.0};  // of the last frame; radians per second, averaged
    double speed = 0;                 // metres per second, averaged
    ImpostorEye eye;
  };
  ImpostorContent content_;
  ImpostorFramesOptions options_;
  std::unique_ptr<ImpostorDrawable> drawable_;
  std::vector<Followed> followed_;
  std::vector<int> impostor_of_;        // by object; -1: none
  std::vector<std::uint8_t> polygons_;  // by object: is it drawn as such in this frame?
  std::vector<ImpostorStatus> statuses_;
  std::uint64_t rendered_ = 0;  // that have been reported
  double render_ms_ = 0;
  Stopwatch since_frame_;
  double frame_s_ = 0;  // from frame to frame
  // Last: its threads end before what they use.
  std::unique_ptr<ImpostorWorkers> workers_;
};

// Frames with relief impostors. The chooser lives as long as its frames.
struct ImpostorFrames {
  std::unique_ptr<FrameSource> frames;
  ImpostorChooser* chooser = nullptr;
};
// `backend` must outlive the frames, and be at the time at which `content` was made. Fails if the
// driver refuses the memory or the shaders.
[[nodiscard]] Result<ImpostorFrames> make_impostor_frames(Backend& backend, ImpostorContent content,
                                                          const ImpostorFramesOptions& options);

}  // namespace rilievo
