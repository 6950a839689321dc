#include "apps/rilievo/capture.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "rilievo/io/rgbd.h"
#include "rilievo/warp/reproject.h"

namespace rilievo::app {
namespace {

// What all of a capture's photographs may take: a picture has 20 bytes a texel, and as much again
// while it is taken apart.
constexpr double kMostBytes = 8e9;

const char* name_of(RgbdFormat format) {
  switch (format) {
    case RgbdFormat::nerfstudio:
      return "nerfstudio transforms.json";
    case RgbdFormat::redwood:
      return "Open3D trajectory.log";
    case RgbdFormat::pose_files:
      return "one pose file a frame";
  }
  return "";
}

nlohmann::json list_of(const glm::vec3& v) { return {v.x, v.y, v.z}; }

std::string text_of(const glm::vec3& v) {
  return fmt::format("{:.4g} {:.4g} {:.4g}", v.x, v.y, v.z);
}

Result<std::vector<DepthImage>> photographs_of(const std::string& path, const RgbdCapture& capture,
                                               const FileLimits& limits) {
  std::vector<DepthImage> photographs;
  Progress progress("photograph");
  for (const RgbdFrame& frame : capture.frames) {
    progress.show(int(photographs.size()), int(capture.frames.size()));
    Result<DepthImage> read = load_rgbd_frame(frame, limits.bytes());
    if (!read) return read.error();
    const double bytes = 40.0 * double(read->depth.texels().size()) * double(capture.frames.size());
    if (bytes > kMostBytes)
      return Error{path, fmt::format("{} photographs of {} x {} texels need {:.0f} GB, more than "
                                     "the {:.0f} allowed",
                                     capture.frames.size(), read->camera.width, read->camera.height,
                                     1e-9 * bytes, 1e-9 * kMostBytes)};
    photographs.push_back(*std::move(read));
  }
  return photographs;
}

}  // namespace

Result<PhotographSource> open_photographs(const std::string& path, const FileLimits& limits) {
  const Result<RgbdCapture> capture = open_rgbd_capture(path, limits.allow_outside);
  if (!capture) return capture.error();
  Result<std::vector<DepthImage>> photographs = photographs_of(path, *capture, limits);
  if (!photographs) return photographs.error();
  return PhotographSource(path, std::move(*photographs));
}

Result<> describe_capture(const std::string& path, const std::string& json,
                          const FileLimits& limits) {
  const Result<RgbdCapture> capture = open_rgbd_capture(path, limits.allow_outside);
  if (!capture) return capture.error();
  Box bounds;
  int width = 0, height = 0;
  for (const RgbdFrame& frame : capture->frames) {
    const Result<DepthImage> read = load_rgbd_frame(frame, limits.bytes());
    if (!read) return read.error();
    width = std::max(width, read->camera.width);
    height = std::max(height, read->camera.height);
    bounds.add(measured_bounds(std::span(&*read, 1)));
  }
  if (json.empty()) {
    print("{}\nformat     {}\nframes     {}\nsize       {} x {}\nbounds     {} to {} m\n", path,
          name_of(capture->format), capture->frames.size(), width, height, text_of(bounds.min),
          text_of(bounds.max));
    return Done{};
  }
  return write_json(json, {{"schema", "rilievo-info-1"},
                           {"capture", name_of(capture->format)},
                           {"frames", capture->frames.size()},
                           {"size", {width, height}},
                           {"bounds", {list_of(bounds.min), list_of(bounds.max)}}});
}

}  // namespace rilievo::app
