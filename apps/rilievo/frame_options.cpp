#include "apps/rilievo/frame_options.h"

#include <algorithm>
#include <charconv>

#include "apps/rilievo/checks.h"

namespace rilievo::app {
namespace {

// More pixels than any screen; with 4 samples they take 2 GB.
constexpr int kMaxSide = 16384;
constexpr long kMaxPixels = 1L << 26;
constexpr int kMaxFrames = 1'000'000;
constexpr int kDefaultFrames = 120;

// Once around, in so many frames.
CameraPath turn_path(const Box& bounds, int frames, const Vantage& vantage) {
  constexpr int kOnce = 36 * int(kFramesPerSecond);  // at orbit_path's speed
  const CameraPath once = orbit_path(bounds, kOnce, vantage);
  CameraPath path = once;
  path.keys.clear();
  // At each frame, and between them as the circle asks for; more than five would be cuts.
  const int keys = frames * std::clamp(360 / frames, 1, 5);
  for (int i = 0; i <= keys; ++i) {
    const double share = double(i) / keys;
    const Camera camera = camera_at(once, share * kOnce / kFramesPerSecond, 1, 1);
    path.keys.push_back(look_key(
        share * frames / kFramesPerSecond, camera.position(), camera.position() + camera.forward(),
        glm::dvec3(camera.world_from_eye[1]), once.keys.front().vertical_fov));
  }
  return path;
}

std::vector<glm::vec3> eye_path_of(const CameraPath& path, int frames) {
  std::vector<glm::vec3> eyes;
  for (int frame = 0; frame < frames; ++frame)
    eyes.emplace_back(camera_at(path, frame_time(path, frame), 1, 1).position());
  return eyes;
}

Box bounds_of(std::span<const glm::vec3> places) {
  Box bounds;
  for (const glm::vec3& place : places) bounds.add(place);
  return bounds;
}

}  // namespace

bool is_frame_size(int width, int height) {
  return 1 <= std::min(width, height) && std::max(width, height) <= kMaxSide &&
         long(width) * height <= kMaxPixels;
}

void parse_size(const std::string& text, int& width, int& height) {
  int w = 0, h = 0;
  const char *begin = text.data(), *end = begin + text.size();
  const auto [x, error] = std::from_chars(begin, end, w);
  bool good = error == std::errc() && x != end && *x == 'x';
  if (good) {
    const auto [rest, error_h] = std::from_chars(x + 1, end, h);
    good = error_h == std::errc() && rest == end;
  }
  if (!good) throw CLI::ValidationError("--size", "'" + text + "' is not WIDTHxHEIGHT");
  if (!is_frame_size(w, h))
    throw CLI::ValidationError("--size", text + " is not between 1x1 and 8192x8192 pixels");
  width = w;
  height = h;
}

void add_frame_options(CLI::App& command, FrameOptions& options) {
  command
      .add_option(
          "--time", options.time,
          "The scene as it is at this time of its animation, skins and morph targets posed, "
          "while the eye follows its path (default: it moves with the path; methods that "
          "cannot bend skins and morph targets by time refuse scenes that have some)")
      ->check(in_range(0.0, 1e6))
      ->type_name("SECONDS");
  command
      .add_option_function<std::string>(
          "--size",
          [&options](const std::string& text) {
            parse_size(text, options.width, options.height);
            options.sized = true;
          },
          "Size of a frame in pixels (default 1280x720)")
      ->type_name("WxH");
  command
      .add_option("--frames", options.frames,
                  "Number of frames (default: all of --path, --orbit, --walk or a baked file's "
                  "own path; 120 otherwise)")
      ->check(in_range(1, kMaxFrames))
      ->type_name("N");
  auto* path =
      command.add_option("--path", options.path_file, "Camera path, JSON (rilievo-path-1)")
          ->type_name("FILE.json");
  auto* orbit =
      command
          .add_option("--orbit", options.orbit, "Camera path: once around the scene in N frames")
          ->check(in_range(1, kMaxFrames))
          ->type_name("N");
  auto* walk =
      command.add_option("--walk", options.walk, "Camera path: N frames of a walk past the scene")
          ->check(in_range(1, kMaxFrames))
          ->type_name("N");
  path->excludes(orbit)->excludes(walk);
  orbit->excludes(walk);
  command
      .add_option("--samples", options.samples,
                  "Samples per pixel, for all methods and for the true frames (default 4)")
      ->check(CLI::IsMember({1, 4}));
}

Result<FramePlan> plan_frames(const FrameOptions& options, const Box& bounds,
                              const glm::dvec3& origin, const Vantage& vantage) {
  FramePlan plan;
  if (!options.path_file.empty()) {
    Result<CameraPath> path = load_path(options.path_file);
    if (!path) return path.error();
    plan.path = relative_to(origin, std::move(*path));
    plan.frames = options.frames ? options.frames : std::min(frame_count(plan.path), kMaxFrames);
    return plan;
  }
  plan.frames = options.frames  ? options.frames
                : options.orbit ? options.orbit
                : options.walk  ? options.walk
                                : kDefaultFrames;
  plan.path = options.walk    ? walk_path(bounds, plan.frames, vantage)
              : options.orbit ? turn_path(bounds, options.orbit, vantage)
                              : orbit_path(bounds, plan.frames, vantage);
  return plan;
}

Result<FramePlan> plan_frames(const FrameOptions& options, const Representation& representation) {
  Result<FramePlan> plan = plan_frames(options, representation.bounds(),
                                       representation.world.origin, representation.vantage());
  if (!plan || !options.path_file.empty() || options.orbit || options.walk) return plan;
  if (std::optional<CameraPath> walk = representation.walk()) {
    plan->path = *std::move(walk);
    // All of it, in as many frames as are asked for.
    if (!options.frames) plan->frames = std::min(frame_count(plan->path), kMaxFrames);
  }
  return plan;
}

Box eyes_of(const CameraPath& path, int frames) { return bounds_of(eye_path_of(path, frames)); }

void set_eyes(const FramePlan& plan, MethodOptions& options) {
  options.eye_path = eye_path_of(plan.path, plan.frames);
  options.eyes = bounds_of(options.eye_path);
}

Result<FramePlan> plan_frames(const FrameOptions& options, const OpenedScene& opened) {
  Result<FramePlan> plan =
      plan_frames(options, world_bounds(opened.scene), opened.scene.world.origin);
  if (plan && opened.walk && options.path_file.empty() && !options.orbit && !options.walk)
    plan->path = *opened.walk;
  return plan;
}

}  // namespace rilievo::app
