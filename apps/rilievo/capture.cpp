#include "apps/rilievo/capture.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "rilievo/capture/pose_origin.h"
#include "rilievo/core/file.h"
#include "rilievo/core/place_text.h"
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

// Near their origin, if they lie far away.
WorldSpace move_near(std::vector<DepthImage>& views) {
  std::vector<glm::dmat4*> poses;
  for (DepthImage& view : views) poses.push_back(&view.camera.world_from_eye);
  return take_origin_off(poses);
}
WorldSpace move_near(RgbdCapture& capture) {
  std::vector<glm::dmat4*> poses;
  for (RgbdFrame& frame : capture.frames) poses.push_back(&frame.world_from_eye);
  return take_origin_off(poses);
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
                       std::size_t frames, int width, int height, const Box& bounds,
                       const WorldSpace& world) {
  const double metres = double(bounds.radius());
  const glm::dvec3 low = world.origin + glm::dvec3(bounds.min),
                   high = world.origin + glm::dvec3(bounds.max);
  if (json.empty()) {
    print("{}\nformat     {}\nframes     {}\nsize       {} x {}\nbounds     {} to {} m\n", path,
          format, frames, width, height, place_text(low, metres), place_text(high, metres));
    return Done{};
  }
  return write_json(json, {{"schema", "rilievo-info-1"},
                           {"capture", format},
                           {"frames", frames},
                           {"size", {width, height}},
                           {"bounds", {list_of(low), list_of(high)}}});
}

}  // namespace

bool is_capture(const std::string& path) {
  return is_rgbd_capture(path) || is_seurat_capture(path);
}

Result<PhotographSource> open_photographs(const std::string& path, const FileLimits& limits) {
  if (Result<> good = expect_no_units(path, limits); !good) return good.error();
  if (is_seurat_capture(path)) {
    Result<std::vector<DepthImage>> views = seurat_views(path, limits.allow_outside);
    if (!views) return views.error();
    const WorldSpace world = move_near(*views);
    return PhotographSource(path, std::move(*views), {}, world);
  }
  Result<RgbdCapture> capture = open_rgbd_capture(path, limits.allow_outside);
  if (!capture) return capture.error();
  for (const std::string& warning : capture->warnings.lines())
    complain(path + ": warning: " + warning);
  const WorldSpace world = move_near(*capture);
  Result<std::vector<DepthImage>> photographs = photographs_of(path, *capture, limits);
  if (!photographs) return photographs.error();
  return PhotographSource(path, std::move(*photographs), {}, world);
}

Result<> describe_capture(const std::string& path, const std::string& json,
                          const FileLimits& limits) {
  Box bounds;
  int width = 0, height = 0;
  if (is_seurat_capture(path)) {
    Result<std::vector<DepthImage>> views = seurat_views(path, limits.allow_outside);
    if (!views) return views.error();
    const WorldSpace world = move_near(*views);
    for (const DepthImage& view : *views) {
      width = std::max(width, view.camera.width);
      height = std::max(height, view.camera.height);
    }
    return print_capture(path, json, "Seurat manifest", views->size(), width, height,
                         measured_bounds(*views), world);
  }
  Result<RgbdCapture> capture = open_rgbd_capture(path, limits.allow_outside);
  if (!capture) return capture.error();
  for (const std::string& warning : capture->warnings.lines())
    complain(path + ": warning: " + warning);
  const WorldSpace world = move_near(*capture);
  for (const RgbdFrame& frame : capture->frames) {
    const Result<DepthImage> read = load_rgbd_frame(frame, limits.bytes());
    if (!read) return read.error();
    width = std::max(width, read->camera.width);
    height = std::max(height, read->camera.height);
    bounds.add(measured_bounds(std::span(&*read, 1)));
  }
  return print_capture(path, json, name_of(capture->format), capture->frames.size(), width, height,
                       bounds, world);
}

}  // namespace rilievo::app
