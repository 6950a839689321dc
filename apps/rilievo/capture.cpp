#include "apps/rilievo/capture.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "rilievo/core/file.h"
#include "rilievo/environment_nodes/seurat.h"
#include "rilievo/io/rgbd.h"
#include "rilievo/warp/reproject.h"

namespace rilievo::app {
namespace {

// What all of a capture's photographs may take: a picture has 20 bytes a texel, and as much again
// while it is taken apart.
constexpr double kMaxBytes = 8e9;

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

// The first bytes tell: a manifest names its groups of views within them, or is refused as a scene.
bool is_seurat_capture(const std::filesystem::path& path) {
  constexpr std::uint64_t kMaxManifest = std::uint64_t(1) << 26;
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(path, ignored);
  const std::filesystem::path file = folder ? path / "manifest.json" : path;
  if (file.extension() != ".json" || !std::filesystem::is_regular_file(file, ignored)) return false;
  const Result<std::string> text = read_file(file, kMaxManifest);
  return text && text->find("\"view_groups\"") != std::string::npos;
}

Result<std::vector<DepthImage>> seurat_views(const std::string& path, bool allow_outside) {
  Result<SeuratCapture> capture = load_seurat_capture(path, allow_outside);
  if (!capture) return capture.error();
  std::vector<DepthImage> views;
  for (std::vector<DepthImage>& group : capture->groups)
    for (DepthImage& view : group) views.push_back(std::move(view));
  return views;
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
    if (bytes > kMaxBytes)
      return Error{path, fmt::format("{} photographs of {} x {} texels need {:.0f} GB, more than "
                                     "the {:.0f} allowed",
                                     capture.frames.size(), read->camera.width, read->camera.height,
                                     1e-9 * bytes, 1e-9 * kMaxBytes)};
    photographs.push_back(*std::move(read));
  }
  return photographs;
}

Result<> print_capture(const std::string& path, const std::string& json, const char* format,
                       std::size_t frames, int width, int height, const Box& bounds) {
  if (json.empty()) {
    print("{}\nformat     {}\nframes     {}\nsize       {} x {}\nbounds     {} to {} m\n", path,
          format, frames, width, height, text_of(bounds.min), text_of(bounds.max));
    return Done{};
  }
  return write_json(json, {{"schema", "rilievo-info-1"},
                           {"capture", format},
                           {"frames", frames},
                           {"size", {width, height}},
                           {"bounds", {list_of(bounds.min), list_of(bounds.max)}}});
}

}  // namespace

bool is_capture(const std::string& path) {
  return is_rgbd_capture(path) || is_seurat_capture(path);
}

Result<PhotographSource> open_photographs(const std::string& path, const FileLimits& limits) {
  if (is_seurat_capture(path)) {
    Result<std::vector<DepthImage>> views = seurat_views(path, limits.allow_outside);
    if (!views) return views.error();
    return PhotographSource(path, std::move(*views));
  }
  const Result<RgbdCapture> capture = open_rgbd_capture(path, limits.allow_outside);
  if (!capture) return capture.error();
  for (const std::string& warning : capture->warnings.lines())
    complain(path + ": warning: " + warning);
  Result<std::vector<DepthImage>> photographs = photographs_of(path, *capture, limits);
  if (!photographs) return photographs.error();
  return PhotographSource(path, std::move(*photographs));
}

Result<> describe_capture(const std::string& path, const std::string& json,
                          const FileLimits& limits) {
  Box bounds;
  int width = 0, height = 0;
  if (is_seurat_capture(path)) {
    const Result<std::vector<DepthImage>> views = seurat_views(path, limits.allow_outside);
    if (!views) return views.error();
    for (const DepthImage& view : *views) {
      width = std::max(width, view.camera.width);
      height = std::max(height, view.camera.height);
    }
    return print_capture(path, json, "Seurat manifest", views->size(), width, height,
                         measured_bounds(*views));
  }
  const Result<RgbdCapture> capture = open_rgbd_capture(path, limits.allow_outside);
  if (!capture) return capture.error();
  for (const std::string& warning : capture->warnings.lines())
    complain(path + ": warning: " + warning);
  for (const RgbdFrame& frame : capture->frames) {
    const Result<DepthImage> read = load_rgbd_frame(frame, limits.bytes());
    if (!read) return read.error();
    width = std::max(width, read->camera.width);
    height = std::max(height, read->camera.height);
    bounds.add(measured_bounds(std::span(&*read, 1)));
  }
  return print_capture(path, json, name_of(capture->format), capture->frames.size(), width, height,
                       bounds);
}

}  // namespace rilievo::app
