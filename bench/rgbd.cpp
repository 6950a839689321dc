// Layered impostors of real places, seen from where a camera really was (S2.7).
//
// Of a capture (BenchOptions::capture; without one, a made up one) each photograph is left out in
// turn: an impostor is baked of the others, and drawn for the camera that was left out. In three
// ways: pictures at the other cameras, pictures around the box, and, to see what the data would
// give without being kept as pictures, the others reprojected into the camera directly.
//
// Figures, for each WAY (cameras, around, direct): psnr_WAY (of the pixels that are drawn, dB, mean
// over the frames), uncovered_WAY (share of the pixels that are not drawn), uncovered_seen_WAY (the
// same of the pixels that some other camera sees), holes_WAY (share within the views' silhouettes
// that no photograph fills).
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "bench/benches.h"
#include "bench/report.h"
#include "rilievo/core/color.h"
#include "rilievo/io/rgbd.h"
#include "rilievo/layered_impostor/bake_photographs.h"
#include "rilievo/layered_impostor/warp.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {
namespace {

constexpr std::array<const char*, 3> kWays{"cameras", "around", "direct"};

// Without a capture: the teapots from an arc in front of them.
Result<std::vector<DepthImage>> made_up(bool quick) {
  const Result<BuiltinScene> built =
      make_builtin(quick ? "builtin:teapots?triangles=10000" : "builtin:teapots?triangles=50000");
  if (!built) return built.error();
  const Result<RayScene> rays = RayScene::create(built->scene);
  if (!rays) return rays.error();
  const Box bounds = world_bounds(built->scene);
  std::vector<DepthImage> photographs;
  const int count = quick ? 3 : 8, width = quick ? 64 : 320, height = quick ? 48 : 240;
  for (int i = 0; i < count; ++i) {
    const double angle = 0.12 * (i - 0.5 * (count - 1));
    const double distance = 2.2 * double(bounds.radius());
    const glm::dvec3 eye =
        glm::dvec3(bounds.center()) + distance * glm::dvec3(std::sin(angle), 0.4, std::cos(angle));
    photographs.push_back(
        cast_picture(*rays, look_at(eye, glm::dvec3(bounds.center()), {0, 1, 0}, 0.8, width, height,
                                    0.01 * distance, 10 * distance)));
    photographs.back().name = fmt::format("photograph {}", i);
    photographs.back().object = {};
  }
  return photographs;
}

Result<std::vector<DepthImage>> photographs_of(const std::string& path) {
  const Result<RgbdCapture> capture = open_rgbd_capture(path);
  if (!capture) return capture.error();
  constexpr std::size_t kMaxCount = 64;  // a minute each is long enough
  if (capture->frames.size() < 3 || capture->frames.size() > kMaxCount)
    return Error{path, fmt::format("has {} frames; leaving out each in turn takes 3 to {}",
                                   capture->frames.size(), kMaxCount)};
  std::vector<DepthImage> photographs;
  for (const RgbdFrame& frame : capture->frames) {
    Result<DepthImage> read = load_rgbd_frame(frame);
    if (!read) return read.error();
    photographs.push_back(*std::move(read));
  }
  return photographs;
}

// Which pixels show something that another photograph measured too? 1 or 0.
Image<std::uint8_t> seen_by_others(const DepthImage& left_out, std::span<const DepthImage> others,
                                   double error) {
  Image<std::uint8_t> seen(left_out.camera.width, left_out.camera.height, 0);
  for (int y = 0; y < seen.height(); ++y)
    for (int x = 0; x < seen.width(); ++x) {
      if (!left_out.covered(x, y)) continue;
      const glm::dvec3 world =
          world_from_raster(left_out.camera, {x + 0.5, y + 0.5}, left_out.depth(x, y));
      for (const DepthImage& other : others) {
        const glm::dvec3 at = raster_from_world(other.camera, world);
        const int u = int(std::floor(at.x)), v = int(std::floor(at.y));
        if (!(at.z > 0) || u < 0 || v < 0 || u >= other.camera.width || v >= other.camera.height)
          continue;
        if (std::abs(double(other.depth(u, v)) - at.z) < error * at.z) seen(x, y) = 1;
      }
    }
  return seen;
}

struct RgbdQuality {
  double psnr = 0, uncovered = 0, uncovered_seen = 0, holes = 0;
};

RgbdQuality compare(const DepthImage& truth, const DepthImage& frame,
                    const Image<std::uint8_t>& seen) {
  const Rgba8Image a = srgb8_from_linear(truth.color), b = srgb8_from_linear(frame.color);
  double squares = 0;
  std::size_t drawn = 0, photographed = 0, known = 0, missed = 0, missed_known = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      if (truth.color(x, y).a == 0) continue;  // masked out, or sky
      ++photographed;
      known += seen(x, y);
      if (!frame.covered(x, y)) {
        ++missed;
        missed_known += seen(x, y);
        continue;
      }
      ++drawn;
      for (int c = 0; c < 3; ++c) squares += std::pow(double(a(x, y)[c]) - b(x, y)[c], 2);
    }
  RgbdQuality q;
  q.psnr =
      drawn == 0 ? 0 : std::min(100.0, 10 * std::log10(255 * 255 * 3 * double(drawn) / squares));
  q.uncovered = double(missed) / double(std::max<std::size_t>(photographed, 1));
  q.uncovered_seen = double(missed_known) / double(std::max<std::size_t>(known, 1));
  return q;
}

// Photograph, frame, difference (three times as strong), holes: side by side, half as large.
BenchPicture shown(std::string caption, const DepthImage& truth, const DepthImage& frame,
                   const Image<std::uint8_t>& seen) {
  const int w = truth.camera.width / 2, h = truth.camera.height / 2;
  Rgba8Image sheet(4 * w, h, {255, 255, 255, 255});
  const Rgba8Image a = srgb8_from_linear(truth.color), b = srgb8_from_linear(frame.color);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const int u = 2 * x, v = 2 * y;
      const bool covered = frame.covered(u, v);
      sheet(x, y) = glm::u8vec4(glm::u8vec3(a(u, v)), 255);
      const glm::u8vec4 open{90, 40, 160, 255}, missed{230, 40, 40, 255};
      sheet(w + x, y) = covered ? glm::u8vec4(glm::u8vec3(b(u, v)), 255) : open;
      glm::u8vec4 difference{0, 0, 0, 255};
      for (int c = 0; c < 3; ++c)
        if (covered)
          difference[c] = std::uint8_t(std::min(255, 3 * std::abs(a(u, v)[c] - b(u, v)[c])));
      sheet(2 * w + x, y) = difference;
      sheet(3 * w + x, y) = covered ? glm::u8vec4(30, 30, 30, 255) : seen(u, v) ? missed : open;
    }
  return png_picture(std::move(caption), sheet);
}

}  // namespace

Result<BenchReport> rgbd(const BenchOptions& options) {
  Result<std::vector<DepthImage>> loaded =
      options.capture.empty() ? made_up(options.quick) : photographs_of(options.capture);
  if (!loaded) return loaded.error();
  const std::vector<DepthImage>& photographs = *loaded;
  const int count = int(photographs.size());

  BenchReport report;
  Table table{"Each photograph left out in turn",
              {"left out", "way", "PSNR dB", "uncovered %", "uncovered of what others see %",
               "holes in the views %"},
              {}};
  std::array<RgbdQuality, 3> mean{};
  PhotographBakeOptions bake;
  bake.reproject.box = measured_bounds(photographs, 0.0);
  bake.camera.size = options.quick ? 48 : 512;
  for (int i = 0; i < count; ++i) {
    if (options.progress) options.progress(i, count);
    std::vector<DepthImage> others;
    for (int k = 0; k < count; ++k)
      if (k != i) others.push_back(photographs[std::size_t(k)]);
    const DepthImage& truth = photographs[std::size_t(i)];
    const Image<std::uint8_t> seen = seen_by_others(truth, others, bake.reproject.depth_error);
    for (std::size_t way = 0; way < kWays.size(); ++way) {
      DepthImage frame;
      ReprojectStats holes;
      if (way == 2) {
        Reprojection made = reproject(others, std::span(&truth.camera, 1), bake.reproject);
        holes = made.total;
        frame = std::move(made.pictures[0]);
      } else {
        bake.kind = way == 0 ? PhotographViews::at_cameras : PhotographViews::around;
        const Result<PhotographBake> made = bake_photographs(others, bake);
        if (!made) return made.error();
        holes = made->total;
        frame = warp_surfaces(made->impostor, truth.camera);
      }
      RgbdQuality q = compare(truth, frame, seen);
      q.holes = holes.hole_share();
      table.rows.push_back({truth.name, kWays[way], fmt::format("{:.2f}", q.psnr),
                            fmt::format("{:.2f}", 100 * q.uncovered),
                            fmt::format("{:.2f}", 100 * q.uncovered_seen),
                            fmt::format("{:.1f}", 100 * q.holes)});
      mean[way].psnr += q.psnr / count;
      mean[way].uncovered += q.uncovered / count;
      mean[way].uncovered_seen += q.uncovered_seen / count;
      mean[way].holes += q.holes / count;
      report.pictures.push_back(shown(fmt::format("{}, {}: photograph, drawn, difference (x 3), "
                                                  "what is not drawn (red: others see it)",
                                                  truth.name, kWays[way]),
                                      truth, frame, seen));
    }
  }
  if (options.progress) options.progress(count, count);
  for (std::size_t way = 0; way < kWays.size(); ++way) {
    const std::string name = kWays[way];
    report.figures.emplace_back("psnr_" + name, mean[way].psnr);
    report.figures.emplace_back("uncovered_" + name, mean[way].uncovered);
    report.figures.emplace_back("uncovered_seen_" + name, mean[way].uncovered_seen);
    report.figures.emplace_back("holes_" + name, mean[way].holes);
  }
  report.tables = {std::move(table)};
  report.notes = {
      options.capture.empty() ? "Without --capture: the built-in teapots, photographed by rays."
                              : "The capture: " + options.capture + ".",
      "PSNR of the pixels that are drawn, 8-bit sRGB. \"Others see\": the left out photograph's "
      "own "
      "depth, put into another one, meets what that measured, to 2 %.",
      fmt::format(
          "cameras: a picture at each other camera. around: 32 back-perspective pictures of "
          "{0} x {0}. direct: the others' surfaces drawn at once, for comparison. "
          "Impostors are drawn by warp_surfaces().",
          bake.camera.size)};
  return report;
}

}  // namespace rilievo::bench
