#include "apps/rilievo/capture.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "rilievo/io/rgbd.h"
#include "rilievo/layered_impostor/bake_photographs.h"
#include "rilievo/layered_impostor/file.h"
#include "rilievo/layered_impostor/warp.h"

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

Result<Box> box_of(const std::vector<double>& numbers, std::span<const DepthImage> photographs) {
  if (numbers.empty()) return measured_bounds(photographs);
  Box box;
  for (int a = 0; a < 3; ++a) {
    box.min[a] = float(numbers[std::size_t(a)]);
    box.max[a] = float(numbers[std::size_t(a + 3)]);
    if (!std::isfinite(box.min[a]) || !std::isfinite(box.max[a]) || !(box.min[a] < box.max[a]))
      return Error{"--box", "the second corner must lie above the first along every axis"};
  }
  return box;
}

}  // namespace

Result<> bake_capture(const CaptureBakeOptions& options) {
  const Result<BakeOptions> bake_as = bake_options(options.bake);
  if (!bake_as) return bake_as.error();
  const Result<RgbdCapture> capture =
      open_rgbd_capture(options.capture, options.limits.allow_outside);
  if (!capture) return capture.error();
  const Result<std::vector<DepthImage>> photographs =
      photographs_of(options.capture, *capture, options.limits);
  if (!photographs) return photographs.error();
  const Result<Box> box = box_of(options.box, *photographs);
  if (!box) return box.error();
  if (Result<> made = make_folder(std::filesystem::path(options.output).parent_path()); !made)
    return made;

  PhotographBakeOptions bake;
  bake.reproject.box = *box;
  bake.slicing = bake_as->slicing;
  bake.kind = options.around ? PhotographViews::around : PhotographViews::at_cameras;
  bake.views = bake_as->views;
  bake.camera = bake_as->camera;
  Result<PhotographBake> made = bake_photographs(*photographs, bake);
  if (!made) return Error{options.capture, made.error().reason};
  made->impostor.name = options.capture;
  if (Result<> saved = save_layered_impostor(options.output, made->impostor); !saved)
    return saved.error();

  if (options.json.empty()) {
    print("{}: {} views of {} photographs; holes {:.2f} % of the silhouettes\n", options.output,
          made->impostor.pictures.size(), photographs->size(), 100 * made->total.hole_share());
    return Done{};
  }
  nlohmann::json holes = nlohmann::json::array();
  for (const ReprojectFigures& view : made->figures) holes.push_back(view.hole_share());
  return write_json(options.json, {{"schema", "rilievo-bake-1"},
                                   {"scene", options.capture},
                                   {"as", "layered-impostor"},
                                   {"photographs", photographs->size()},
                                   {"views", made->impostor.pictures.size()},
                                   {"layers", options.bake.layers},
                                   {"overlap", options.bake.overlap},
                                   {"box", {list_of(box->min), list_of(box->max)}},
                                   {"filled_texels", made->total.filled},
                                   {"hole_texels", made->total.holes},
                                   {"hole_share", made->total.hole_share()},
                                   {"hole_share_by_view", holes}});
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
