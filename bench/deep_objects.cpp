// Layered reliefs of deep objects near the eye, where flat pictures last two frames.
//
// Needs RILIEVO_DATA in the environment: a folder with obj/copperBeech and models/FlightHelmet.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "bench/benches.h"
#include "bench/drawn_by.h"
#include "rilievo/compare/compare.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/layered_relief/relief_kind.h"
#include "rilievo/measure/report_summary.h"
#include "rilievo/measure/stats.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/representation/bake_objects.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo::bench {
namespace {

constexpr std::size_t kAll = std::size_t(1) << 30;
constexpr double kErrorPx = 2;
// A side of a relief: so fine that what its bounds say of error and cracks is allowed.
constexpr const char* kTexels = "640";

// Adds one relief of all objects to a cache: they are parts of one thing.
Result<> add_reliefs(SceneCache& cache, const PlacedScene& placed, CaptureSource& source,
                     std::span<const DrawableRow> rows, bool quick) {
  const Kind& kind = layered_relief_kind();
  Result<std::unique_ptr<DrawableFactory>> factory = make_factory(rows, kind.name);
  if (!factory) return factory.error();
  ObjectDrawablesOptions bake{.bake = OptionValues(kind.bake_options),
                              .draw = OptionValues(kind.draw_options),
                              .progress = {}};
  if (Result<> set = bake.bake.set("size", quick ? "48" : kTexels); !set) return set.error();
  bake.max_bytes = kAll;
  Result<ObjectDrawable> all = bake_together_drawable(placed, source, kind, **factory, bake);
  if (!all) return all.error();
  cache.add_surroundings(std::move(all->drawable), std::move(*factory), std::move(all->objects));
  return Done{};
}

// Drawn by OpenGL, or without it (null).
Result<CachedFrames> cache_with_reliefs(const Scene& scene, SceneRenderer* renderer,
                                        const ImageCacheOptions& options, bool quick) {
  Result<CachedFrames> cache = make_cache(scene, renderer, options);
  if (!cache) return cache.error();
  const std::unique_ptr<Backend> backend = make_backend(scene, renderer, options.samples);
  const Result<std::unique_ptr<CaptureSource>> source = backend->make_capture_source();
  if (!source) return source.error();
  if (Result<> added =
          add_reliefs(*cache->cache, backend->placed(), **source, backend->drawables(), quick);
      !added)
    return added.error();
  return cache;
}

// Around the object, twice its radius away; as at 70 cm, 2 to 10 cm a frame.
Camera camera_of(const Box& box, int frame, int width, int height) {
  double angle = 0;
  for (int i = 1; i <= frame; ++i) angle += (6 + 4 * std::sin(0.7 * i)) / 70;
  const double radius = double(box.radius()), distance = 2.2 * radius;
  const glm::dvec3 center(box.center());
  const glm::dvec3 eye =
      center + distance * glm::normalize(glm::dvec3(std::sin(angle), 0.25, std::cos(angle)));
  return look_at(eye, center, {0, 1, 0}, 0.85, width, height, 0.05 * radius, 20 * radius);
}

double rays_ms_p50(const Scene& scene, const Box& box, const CompareOptions& options) {
  const Result<RayScene> rays = RayScene::create(scene);
  if (!rays) return 0;
  PictureCaster caster(*rays);
  RasterPicture picture;
  std::vector<double> ms;
  for (int frame = 0; frame <= options.frames; ++frame) {
    const Stopwatch watch;
    caster.draw(camera_of(box, frame, options.width, options.height), {}, options.samples, picture);
    // The first fills caches.
    if (frame > 0) ms.push_back(watch.ms());
  }
  return median_of(ms);
}

}  // namespace

Result<BenchReport> deep_objects(const BenchOptions& options) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) return Error{"RILIEVO_DATA", "is not set: a folder with obj/ and models/ is needed"};
  CompareOptions compare_options;
  compare_options.width = options.quick ? 128 : 640;
  compare_options.height = options.quick ? 72 : 360;
  compare_options.frames = options.quick ? 4 : options.full ? 60 : 16;
  compare_options.shown_frames = 2;
  compare_options.progress = options.progress;

  BenchReport report;
  Table table{"Around deep objects, near by",
              {"object", "drawn by", "p50 ms", "p99 ms", "PSNR dB", "FLIP", "wrong visibility %",
               "bound px", "captures", "polygons", "nailboards", "reliefs"},
              {}};
  double to_nailboards = 1e9, to_rays = 1e9, psnr_db = 1e9;
  double to_nailboards_opengl = 1e9, to_rays_opengl = 1e9;
  for (const char* file :
       {"obj/copperBeech/copperBeech.obj", "models/FlightHelmet/FlightHelmet.gltf"}) {
    const std::filesystem::path path = std::filesystem::path(data) / file;
    const Result<LoadedScene> loaded = load_scene(path);
    if (!loaded) return loaded.error();
    const std::string name = path.stem().string();
    const Scene& scene = loaded->scene;
    const Box box = world_bounds(scene);
    Result<SceneRenderer> renderer = SceneRenderer::create(scene);
    if (!renderer) return renderer.error();
    const auto direct = polygon_drawer(scene, &*renderer, compare_options.samples);
    ImageCacheOptions cache_options;
    cache_options.error_px = kErrorPx;
    std::vector<CachedFrames> caches;  // nailboards and reliefs, by OpenGL and without
    for (SceneRenderer* const by : {&*renderer, static_cast<SceneRenderer*>(nullptr)})
      for (const bool with_reliefs : {false, true}) {
        Result<CachedFrames> made =
            with_reliefs ? cache_with_reliefs(scene, by, cache_options, options.quick)
                         : make_cache(scene, by, cache_options);
        if (!made) return made.error();
        caches.push_back(std::move(*made));
      }
    const auto walk = [&](int frame) {
      return WalkFrame{camera_of(box, frame, compare_options.width, compare_options.height), 0.0};
    };
    const ComparedSource sources[] = {{"direct", direct.get()},
                                      {"nailboards", caches[0].frames.get()},
                                      {"reliefs", caches[1].frames.get()},
                                      {"nailboards-software", caches[2].frames.get()},
                                      {"reliefs-software", caches[3].frames.get()}};
    const Result<Report> compared = compare(sources, walk, compare_options);
    if (!compared) return compared.error();
    std::map<std::string, double> p50s;
    for (const MethodResult& method : compared->methods) {
      const MethodSummary s = summarize(method);
      p50s[method.name] = s.frame_ms.p50;
      if (method.name == "reliefs-software") psnr_db = std::min(psnr_db, s.psnr_db.mean);
      const auto drawn = [&](std::string_view way) {
        for (const auto& [kind, count] : method.drawn_as)
          if (kind == way) return double(count);
        return 0.0;
      };
      table.rows.push_back(
          {name, method.name, fmt::format("{:.1f}", s.frame_ms.p50),
           fmt::format("{:.1f}", s.frame_ms.p99), fmt::format("{:.2f}", s.psnr_db.mean),
           fmt::format("{:.4f}", s.flip.mean), fmt::format("{:.3f}", 100 * s.wrong_visibility.mean),
           method.bound_px_max ? fmt::format("{:.2f}", *method.bound_px_max) : "",
           std::to_string(method.captures), fmt::format("{}", drawn("polygons")),
           fmt::format("{}", drawn("nailboard")), fmt::format("{}", drawn(kLayeredReliefName))});
      report.figures.emplace_back("frame_ms_p50_" + name + "_" + method.name, s.frame_ms.p50);
      report.figures.emplace_back("frame_ms_p99_" + name + "_" + method.name, s.frame_ms.p99);
      report.figures.emplace_back("psnr_db_" + name + "_" + method.name, s.psnr_db.mean);
      for (const EncodedPicture& picture : method.pictures)
        report.pictures.push_back({fmt::format("{} {}", name, method.name), picture});
    }
    const double rays_ms = rays_ms_p50(scene, box, compare_options);
    table.rows.push_back(
        {name, "rays", fmt::format("{:.1f}", rays_ms), "", "", "", "", "", "", "", "", ""});
    report.figures.emplace_back("frame_ms_p50_" + name + "_rays", rays_ms);
    const auto compared_with = [&](const char* figure, double ms, double relief_ms, double& least) {
      report.figures.emplace_back(fmt::format("{}_{}", figure, name), ms / relief_ms);
      least = std::min(least, ms / relief_ms);
    };
    // The faster of the two backends, whichever it is.
    const double nailboards_ms = std::min(p50s["nailboards"], p50s["nailboards-software"]);
    compared_with("p50_ratio_to_nailboards", nailboards_ms, p50s["reliefs-software"],
                  to_nailboards);
    compared_with("p50_ratio_to_rays", rays_ms, p50s["reliefs-software"], to_rays);
    compared_with("p50_ratio_to_nailboards_opengl", p50s["nailboards"], p50s["reliefs"],
                  to_nailboards_opengl);
    compared_with("p50_ratio_to_rays_opengl", rays_ms, p50s["reliefs"], to_rays_opengl);
  }
  report.figures.emplace_back("p50_ratio_to_nailboards", to_nailboards);
  report.figures.emplace_back("p50_ratio_to_rays", to_rays);
  report.figures.emplace_back("p50_ratio_to_nailboards_opengl", to_nailboards_opengl);
  report.figures.emplace_back("p50_ratio_to_rays_opengl", to_rays_opengl);
  report.figures.emplace_back("psnr_db", psnr_db);
  report.tables = {std::move(table)};
  report.notes = {fmt::format(
      "{} frames of {} x {}, {} samples; the eye goes round each object, 2.2 times its radius "
      "away, by 2 to 10 cm a frame where that distance is 70 cm. Error {} pixels for all caches. "
      "Ratios are times over the time of the cache without OpenGL that has a layered relief of all "
      "parts of the object too: the worse of the two objects'; nailboards by the faster of the "
      "backends. Those that end in _opengl are of the same cache with OpenGL. Rays: Embree, as "
      "many "
      "a pixel as samples, without the sky.",
      compare_options.frames, compare_options.width, compare_options.height,
      compare_options.samples, kErrorPx)};
  return report;
}

}  // namespace rilievo::bench
