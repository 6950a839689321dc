// Which options choose the frames that are drawn? The camera path, the size, the number.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "apps/rilievo/scene_file.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/core/result.h"
#include "rilievo/kind/kind.h"
#include "rilievo/method/method.h"

namespace rilievo::app {

struct FrameOptions {
  int width = 1280, height = 720;
  bool sized = false;  // --size was given
  int samples = 4;
  int frames = 0;  // 0: as many as the path has
  int orbit = 0, walk = 0;
  std::string path_file;
  std::optional<double> time;  // at which the scene stands still; else it moves with the path

  // The scene's time where the path is at its time `on_path`, seconds.
  [[nodiscard]] double scene_time(double on_path) const { return time.value_or(on_path); }
};

// `most_frames` bounds --frames.
void add_frame_options(CLI::App& command, FrameOptions& options);

struct FramePlan {
  CameraPath path;
  int frames = 1;
};

// The path asked for; or one found from the bounds of what there is to see. Files count from the
// world's origin, plans and bounds from `origin`.
[[nodiscard]] Result<FramePlan> plan_frames(const FrameOptions& options, const Box& bounds,
                                            const glm::dvec3& origin, const Vantage& vantage = {});
// The path asked for; or the representation's own walk; or one found from its bounds.
[[nodiscard]] Result<FramePlan> plan_frames(const FrameOptions& options,
                                            const Representation& representation);
// The bounds of a path's eyes, each at its frame.
[[nodiscard]] Box eyes_of(const CameraPath& path, int frames);
// Tells a method of the eyes that the frames have, and of their bounds.
void set_eyes(const FramePlan& plan, MethodOptions& options);
// The path asked for; or the scene's own walk; or one found from its bounds.
[[nodiscard]] Result<FramePlan> plan_frames(const FrameOptions& options, const OpenedScene& opened);

// Is a frame of this size allowed?
[[nodiscard]] bool is_frame_size(int width, int height);
// "WIDTHxHEIGHT" into `width` and `height`; throws CLI::ValidationError.
void parse_size(const std::string& text, int& width, int& height);

}  // namespace rilievo::app
