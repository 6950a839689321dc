// A cache with layered impostors that were baked before (S1.7, S2).
//
// Heavy teapots that spin about themselves, so fast that no flat picture lasts: drawn directly, by
// a cache, and by caches that may draw impostors, as walks or as slices. Figures: frame_ms_p50_*,
// psnr_db_*, bound_px_max_*, layered_share_*, for direct, cache, walk, slices.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <string_view>

#include "bench/benches.h"
#include "bench/drawn_by.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/compare/compare.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/measure/report_summary.h"
#include "rilievo/measure/stats.h"
#include "rilievo/representation/bake_objects.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {
namespace {

constexpr double kTurn = 0.5;     // radians a frame
constexpr double kFrame_s = 0.1;  // time from frame to frame
constexpr float kApart = 9;       // metres between teapots 6.4 m wide

// `rows` by `rows` of them; every other one rests.
Result<Scene> teapots(int triangles, int rows, int frames) {
  Result<BuiltinScene> one = make_builtin(fmt::format("builtin:teapot?triangles={}", triangles));
  if (!one) return one.error();
  Scene scene = std::move(one->scene);
  const Object teapot = scene.objects.front();
  scene.objects.clear();
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < rows; ++column) {
      const glm::vec3 place(kApart * (float(column) - 0.5f * float(rows - 1)), 0,
                            kApart * (float(row) - 0.5f * float(rows - 1)));
      Object object = teapot;
      if ((row + column) % 2 == 0) {
        object.node = int(scene.nodes.size());
        Node node;
        node.translation = place;
        scene.nodes.push_back(node);
        Channel turn{object.node, Channel::Path::rotation, Channel::Interpolation::linear, {}, {}};
        for (int i = 0; i <= frames; ++i) {
          const double half = 0.5 * kTurn * i + row;
          turn.times.push_back(float(kFrame_s * i));
          turn.values.push_back({0, std::sin(half), 0, std::cos(half)});
        }
        scene.channels.push_back(std::move(turn));
      } else {
        object.placement = glm::translate(glm::mat4(1), place) * teapot.placement;
      }
      scene.objects.push_back(object);
    }
  scene.duration = kFrame_s * frames;
  finish(scene);
  return scene;
}

Result<CachedFrames> cache_with(SceneRenderer& renderer, const char* warp, bool quick) {
  constexpr std::size_t kAll = std::size_t(256) << 20;
  const Kind& kind = layered_impostor_kind();
  Result<std::unique_ptr<DrawableFactory>> factory = make_factory(drawable_rows(), kind.name);
  if (!factory) return factory.error();
  ObjectDrawablesOptions bake{OptionValues(kind.bake_options), OptionValues(kind.draw_options)};
  if (Result<> set = bake.draw.set("warp", warp); !set) return set.error();
  if (quick)
    for (const auto& [name, value] : {std::pair{"views", "12"}, {"size", "32"}})
      if (Result<> set = bake.bake.set(name, value); !set) return set.error();
  bake.max_bytes = kAll / 2;
  OpenGLSource source(renderer);
  Result<std::vector<ObjectDrawable>> drawables =
      bake_object_drawables(renderer.placed(), source, kind, **factory, bake);
  if (!drawables) return drawables.error();
  ImageCacheOptions options;
  options.max_bytes = kAll;
  for (const ObjectDrawable& one : *drawables) options.max_bytes -= one.drawable->bytes();
  Result<CachedFrames> cache = make_cache(renderer.scene(), &renderer, options);
  if (!cache) return cache.error();
  cache->cache->add_alternatives(std::move(*drawables), std::move(*factory));
  return cache;
}

}  // namespace

Result<BenchReport> spinning(const BenchOptions& options) {
  CompareOptions compare_options;
  compare_options.width = options.quick ? 160 : 1280;
  compare_options.height = options.quick ? 90 : 720;
  compare_options.frames = options.quick ? 4 : 60;
  compare_options.shown_frames = 2;
  compare_options.progress = options.progress;
  const int triangles = options.quick ? 20'000 : 200'000, rows = options.quick ? 2 : 5;
  const Result<Scene> scene = teapots(triangles, rows, compare_options.frames);
  if (!scene) return scene.error();
  Result<SceneRenderer> renderer = SceneRenderer::create(*scene);
  if (!renderer) return renderer.error();

  const auto direct = polygon_drawer(*scene, &*renderer, 4);
  const Result<CachedFrames> alone = make_cache(*scene, &*renderer, {});
  if (!alone) return alone.error();
  const Result<CachedFrames> walk = cache_with(*renderer, "surfaces", options.quick);
  if (!walk) return walk.error();
  const Result<CachedFrames> slices = cache_with(*renderer, "slices", options.quick);
  if (!slices) return slices.error();

  // Slowly around all of them.
  const auto frame_at = [&](int frame) {
    const double angle = 0.01 * frame, distance = 4.0 * kApart;
    const glm::dvec3 eye(distance * std::sin(angle), 0.5 * distance, distance * std::cos(angle));
    return WalkFrame{look_at(eye, {0, 0, 0}, {0, 1, 0}, 0.8, compare_options.width,
                             compare_options.height, 0.5, 500),
                     kFrame_s * frame};
  };
  const ComparedSource sources[] = {{"direct", direct.get()},
                                    {"cache", alone->frames.get()},
                                    {"walk", walk->frames.get()},
                                    {"slices", slices->frames.get()}};
  const Result<Report> compared = compare(sources, frame_at, compare_options);
  if (!compared) return compared.error();

  BenchReport report;
  Table table{"Heavy objects that spin",
              {"drawn by", "p50 ms", "p99 ms", "PSNR dB", "FLIP", "wrong visibility %", "bound px",
               "captures", "polygons", "nailboards", "of groups", "impostors"},
              {}};
  for (const MethodResult& method : compared->methods) {
    const MethodSummary s = summarize(method);
    const auto drawn = [&](std::string_view way) {
      for (const auto& [name, count] : method.drawn_as)
        if (name == way) return double(count);
      return 0.0;
    };
    const double all = drawn("polygons") + drawn("nailboard") + drawn(kLayeredImpostorName);
    table.rows.push_back(
        {method.name, fmt::format("{:.1f}", s.frame_ms.p50), fmt::format("{:.1f}", s.frame_ms.p99),
         fmt::format("{:.2f}", s.psnr_db.mean), fmt::format("{:.4f}", s.flip.mean),
         fmt::format("{:.4f}", 100 * s.wrong_visibility.mean),
         method.bound_px_max ? fmt::format("{:.2f}", *method.bound_px_max) : "",
         std::to_string(method.captures), fmt::format("{}", drawn("polygons")),
         fmt::format("{}", drawn("nailboard")), fmt::format("{}", drawn("hierarchy")),
         fmt::format("{}", drawn(kLayeredImpostorName))});
    report.figures.emplace_back("frame_ms_p50_" + method.name, s.frame_ms.p50);
    report.figures.emplace_back("psnr_db_" + method.name, s.psnr_db.mean);
    report.figures.emplace_back("bound_px_max_" + method.name, method.bound_px_max.value_or(0));
    report.figures.emplace_back("layered_share_" + method.name, drawn(kLayeredImpostorName) / all);
    for (const EncodedPicture& picture : method.pictures)
      report.pictures.push_back({method.name, picture});
  }
  report.tables = {std::move(table)};
  report.notes = {fmt::format(
      "{} teapots of {} triangles, every other one turns by {} radians a frame; {} frames of {} x "
      "{}, 256 MB for everything, error 1 pixel. An impostor carries along the light in which it "
      "was baked: that is most of what it loses.",
      rows * rows, scene->models.front().triangles, kTurn, compare_options.frames,
      compare_options.width, compare_options.height)};
  return report;
}

}  // namespace rilievo::bench
