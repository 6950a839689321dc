#include "bench/relief_walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rilievo/capture/shaders/ray_tracer.h"
#include "rilievo/core/on_this_thread.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/measure/flip.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/ssim.h"
#include "rilievo/relief_impostor/critical_points.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo::bench {
namespace {

constexpr int kWalkSize = 256;   // texels of an impostor's longer side, as the paper's
constexpr int kWalkSamples = 4;  // a texel
// A new impostor is made beyond this mean stretch of the critical points (S5.4).
constexpr double kWalkRefresh[] = {1.3, 3, 8};
constexpr double kWalkFigures = 3;  // which of them the figures are of
constexpr int kWalkCompared = 6;    // each so manyeth frame is compared

struct WalkResult {
  std::size_t triangles = 0;
  int frames = 0, impostors = 0;
  double impostor_ms = 0, warp_ms = 0;     // of one
  double psnr_mean = 0, psnr_worst = 1e9;  // of the frames
  double ssim = 0, flip = 0;               // their means
  double interpolated = 0;                 // share, of all frames
};

// Over mid grey.
glm::u8vec4 over_grey(const glm::u8vec4& c) {
  const auto mix = [&](int k) { return std::uint8_t(std::min(255, c[k] + (255 - c.a) / 2)); };
  return {mix(0), mix(1), mix(2), 255};
}

Result<Camera> walk_camera(const Box& box, double angle) {
  const glm::dvec3 eye = glm::dvec3(box.center()) +
                         2.5 * double(box.radius()) *
                             glm::normalize(glm::dvec3(std::sin(angle), 0.25, std::cos(angle)));
  Result<Camera> camera = tight_camera(Projection::perspective, eye, {0, 1, 0}, box);
  if (!camera) return camera;
  const ImageWindow& w = camera->window;
  const double texel = std::max(w.right - w.left, w.top - w.bottom) / kWalkSize;
  camera->width = std::max(1, int(std::lround((w.right - w.left) / texel)));
  camera->height = std::max(1, int(std::lround((w.top - w.bottom) / texel)));
  return camera;
}

// On one core, as a worker would.
Result<WalkResult> walk_around(const Scene& scene, int frames, double refresh) {
  const OnThisThread alone;
  Result<RayScene> rays = RayScene::create(scene, 0.0, RayParts::all);
  if (!rays) return rays.error();
  RayTracer tracer(*rays);
  const Box box = tracer.bounds({});
  WalkResult walk;
  walk.triangles = std::size_t(count_triangles(scene));
  const auto trace = [&](const Camera& camera) {
    CaptureRequest request;
    request.camera = camera;
    request.samples = kWalkSamples;
    request.identifiers = false;
    return tracer.capture(request);
  };
  ImpostorPicture picture;
  std::vector<CriticalPair> pairs;
  ImpostorWarpScratch scratch;
  Prewarped shown;
  int compared = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const Result<Camera> camera = walk_camera(box, 2 * 3.14159265358979 * frame / frames);
    if (!camera) return camera.error();
    const glm::dvec3 eye = camera->position();
    const auto warp = frame > 0 ? plane_warp(picture.geometry, eye) : std::nullopt;
    // The critical points may all be in front of an eye that some other texel is not.
    const bool again = !warp || !std::isfinite(largest_move(picture.geometry, *warp)) ||
                       stretch_of(picture.geometry, pairs, *warp).mean > refresh;
    if (again) {
      const Stopwatch watch;
      const Result<CapturedPicture> captured = trace(*camera);
      if (!captured) return captured.error();
      picture = impostor_picture(captured->picture);
      pairs = critical_pairs(picture, 8);
      walk.impostor_ms += watch.ms();
      ++walk.impostors;
    }
    const Stopwatch watch;
    const auto counted = warp_impostor(picture, eye, {.parallel = false}, scratch, shown);
    walk.warp_ms += watch.ms();
    if (!counted) return Error{scene.name, "has nothing to show"};
    walk.interpolated += counted->share();
    ++walk.frames;
    if (frame % kWalkCompared != kWalkCompared / 2) continue;
    // The reference: fully ray-traced, through the very window of the result.
    const Result<CapturedPicture> truth = trace(shown.geometry.capture);
    if (!truth) return truth.error();
    const Nailboard reference = make_nailboard(truth->picture, 16);
    Rgba8Image a(shown.width(), shown.height()), b(shown.width(), shown.height());
    for (int y = 0; y < shown.height(); ++y)
      for (int x = 0; x < shown.width(); ++x) {
        a(x, y) = over_grey(shown.color[std::size_t(y * shown.width() + x)]);
        b(x, y) = over_grey(reference.color(x, y));
      }
    const double psnr = psnr_db(a, b);
    walk.psnr_mean += psnr;
    walk.psnr_worst = std::min(walk.psnr_worst, psnr);
    walk.ssim += ssim(b, a);
    walk.flip += flip(b, a);
    ++compared;
  }
  walk.impostor_ms /= walk.impostors;
  walk.warp_ms /= walk.frames;
  walk.psnr_mean /= compared, walk.ssim /= compared, walk.flip /= compared;
  walk.interpolated /= walk.frames;
  return walk;
}

}  // namespace

Result<> relief_walk(const BenchOptions& options, BenchReport& report) {
  std::vector<std::string> names = options.scenes;
  if (names.empty()) names = {"builtin:fish?triangles=1500", "builtin:fern", "builtin:teapots"};
  if (options.quick) names.resize(1);
  Table table{"One walk around the object by relief impostors, ray-traced on one core (S5.9)",
              {"object", "triangles", "stretch", "impostors", "ms each", "warp ms", "interpolated",
               "PSNR dB", "worst", "SSIM", "FLIP"},
              {}};
  int done = 0;
  double impostors = 0, ms = 0, psnr = 0, ssim_sum = 0, flip_sum = 0;
  for (const std::string& name : names) {
    if (options.progress) options.progress(done, int(names.size()));
    ++done;
    const auto add = [&](const Scene& scene) -> Result<> {
      const std::string shown =
          name.starts_with("builtin:") ? name : std::filesystem::path(name).stem().string();
      for (const double refresh : kWalkRefresh) {
        const Result<WalkResult> walk = walk_around(scene, options.quick ? 12 : 120, refresh);
        if (!walk) return walk.error();
        if (refresh == kWalkFigures)
          impostors += walk->impostors, ms += walk->impostor_ms, psnr += walk->psnr_mean,
              ssim_sum += walk->ssim, flip_sum += walk->flip;
        table.rows.push_back(
            {shown, std::to_string(walk->triangles), fmt::format("{}", refresh),
             std::to_string(walk->impostors), fmt::format("{:.0f}", walk->impostor_ms),
             fmt::format("{:.2f}", walk->warp_ms),
             fmt::format("{:.1f} %", 100 * walk->interpolated),
             fmt::format("{:.1f}", walk->psnr_mean), fmt::format("{:.1f}", walk->psnr_worst),
             fmt::format("{:.4f}", walk->ssim), fmt::format("{:.4f}", walk->flip)});
      }
      return Done{};
    };
    Result<> ok = Done{};
    if (name.starts_with("builtin:")) {
      const Result<BuiltinScene> made = make_builtin(name);
      if (!made) return made.error();
      ok = add(made->scene);
    } else {
      const Result<LoadedScene> loaded = load_scene(name);
      if (!loaded) return loaded.error();
      ok = add(loaded->scene);
    }
    if (!ok) return ok;
  }
  table.rows.push_back({"the paper's", "1500", "", "17", "228", "11", "", "", "", "", ""});
  const double count = double(names.size());
  report.figures.emplace_back("impostors_per_walk", impostors / count);
  report.figures.emplace_back("impostor_ms", ms / count);
  report.figures.emplace_back("psnr_db_walk", psnr / count);
  report.figures.emplace_back("ssim_walk", ssim_sum / count);
  report.figures.emplace_back("flip_walk", flip_sum / count);
  report.tables.push_back(std::move(table));
  report.notes.push_back(fmt::format(
      "120 eyes, 3 degrees from one to the next, 2.5 radii away; 256 texels, {} samples each. A "
      "new "
      "impostor is made where the mean stretch of the critical points exceeds the one named. PSNR, "
      "SSIM "
      "and FLIP of each {}th frame against the ray tracer at the same eye, over grey, of the tight "
      "window "
      "around the object. Figures are means over the objects, at a stretch of {}.",
      kWalkSamples, kWalkCompared, kWalkFigures));
  return Done{};
}

}  // namespace rilievo::bench
