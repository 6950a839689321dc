// Each baked kind drawn without OpenGL, against OpenGL and against polygons.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/benches.h"
#include "bench/drawn_by.h"
#include "bench/timing.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/gl/context.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/kinds.h"
#include "rilievo/representation/software/software_factories.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo::bench {
namespace {

constexpr int kKindSamples = 4;

// A kind, and how it is baked and drawn.
struct KindCase {
  const char *name, *kind;
  std::vector<std::pair<const char*, const char*>> bake, draw;
};

std::vector<KindCase> kind_cases(bool surroundings, bool quick) {
  std::vector<KindCase> cases;
  if (surroundings) {
    cases = {{"nodes_merged", "environment-nodes", {}, {}},
             {"nodes_layering", "environment-nodes", {}, {{"merge", "layering"}}}};
    if (quick)
      for (KindCase& one : cases) one.bake = {{"face", "32"}, {"auto", "2"}};
    return cases;
  }
  cases = {{"impostor_surfaces", "layered-impostor", {{"no-fills", "on"}}, {}},
           {"impostor_slices", "layered-impostor", {{"no-fills", "on"}}, {{"warp", "slices"}}},
           {"relief", "layered-relief", {}, {}}};
  if (quick)
    for (KindCase& one : cases) {
      const bool views = std::string_view(one.kind) == "layered-impostor";
      one.bake.emplace_back("size", "16");
      one.bake.emplace_back(views ? "views" : "textures", views ? "12" : "2");
    }
  return cases;
}

Result<OptionValues> values_of(std::span<const Option> options,
                               const std::vector<std::pair<const char*, const char*>>& set) {
  OptionValues values(options);
  for (const auto& [name, value] : set)
    if (Result<> done = values.set(name, value); !done) return done.error();
  return values;
}

// A scene, and the eyes that look at what was baked of it.
struct KindScene {
  std::string name;
  Scene scene;
  std::vector<Camera> cameras = {};
  bool surroundings = false;
  Box eyes = {};  // the region that nodes are baked for
};

KindScene around_object(std::string name, Scene scene, int count, const glm::ivec2& size) {
  const Box bounds = world_bounds(scene);
  const glm::dvec3 center(bounds.center());
  const double radius = double(bounds.radius());
  KindScene made{std::move(name), std::move(scene), {}, false, {}};
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.3) / count;
    const glm::dvec3 to(std::sin(angle), 0.35, std::cos(angle));
    made.cameras.push_back(look_at(center + 2.4 * radius * glm::normalize(to), center, {0, 1, 0},
                                   0.9, size.x, size.y, 0.05 * radius, 30 * radius));
  }
  return made;
}

KindScene within_scene(std::string name, BuiltinScene builtin, int count, const glm::ivec2& size) {
  KindScene made{std::move(name), std::move(builtin.scene), {}, true, {}};
  for (int i = 0; i < count; ++i) {
    const double time = frame_time(builtin.path, 4 * i);
    made.cameras.push_back(camera_at(builtin.path, time, size.x, size.y));
    const glm::vec3 eye(made.cameras.back().position());
    made.eyes.add(eye - 1.0f), made.eyes.add(eye + 1.0f);
  }
  return made;
}

// What all ways of drawing a scene's kinds share.
struct Stage {
  const Scene nothing{};  // for the sky: none
  std::optional<SceneRenderer> renderer;
  std::optional<FrameTarget> target;
};

struct KindRun {
  RunTimes software, opengl;
  double worst_psnr = std::numeric_limits<double>::infinity();  // against OpenGL, of all eyes
};

Result<std::unique_ptr<Drawable>> bake_drawable(const KindScene& scene, const KindCase& one,
                                                CaptureSource& source, DrawableFactory& factory) {
  const Kind& kind = *find_kind(kinds(), one.kind);
  Result<OptionValues> bake = values_of(kind.bake_options, one.bake);
  if (!bake) return bake.error();
  const Result<OptionValues> draw = values_of(kind.draw_options, one.draw);
  if (!draw) return draw.error();
  Result<Baked> baked = kind.bake({source, {}, scene.eyes}, *bake, {});
  if (!baked) return baked.error();
  return factory.make_drawable(std::move(baked->representation), *draw);
}

// Frames of all eyes, one after the other.
std::function<void()> way_of(FrameSource& frames, const KindScene& scene, Stage* stage) {
  return [&frames, &scene, stage, next = std::size_t(0)]() mutable {
    const Camera& camera = scene.cameras[next++ % scene.cameras.size()];
    if (stage) stage->target->begin();
    (void)frames.draw(camera, 0);
    if (!stage) return;
    stage->target->resolve();
    gl::finish();
  };
}

Result<KindRun> run_kind(const KindScene& scene, const KindCase& one, CaptureSource& source,
                         Stage& stage, int runs) {
  auto software_factory = make_factory(software_drawable_rows(), one.kind);
  if (!software_factory) return software_factory.error();
  auto tiles = bake_drawable(scene, one, source, **software_factory);
  if (!tiles) return tiles.error();
  const std::vector<Instance> instances{Instance{}};
  const auto software =
      stored_drawer(stage.nothing, nullptr, kKindSamples, std::move(*tiles), instances);
  std::vector<std::function<void()>> ways{way_of(*software, scene, nullptr)};
  std::unique_ptr<DrawableFactory> factory;
  std::unique_ptr<FrameSource> opengl;
  if (stage.renderer) {
    auto made = make_factory(drawable_rows(), one.kind);
    if (!made) return made.error();
    factory = std::move(*made);
    auto drawable = bake_drawable(scene, one, source, *factory);
    if (!drawable) return drawable.error();
    opengl = stored_drawer(stage.nothing, &*stage.renderer, kKindSamples, std::move(*drawable),
                           instances);
    ways.push_back(way_of(*opengl, scene, &stage));
  }
  // Failures are seen here: each would come again.
  KindRun run;
  for (const Camera& camera : scene.cameras) {
    if (Result<> drawn = software->draw(camera, 0); !drawn) return drawn.error();
    if (!opengl) continue;
    stage.target->begin();
    if (Result<> drawn = opengl->draw(camera, 0); !drawn) return drawn.error();
    stage.target->resolve();
    run.worst_psnr = std::min(run.worst_psnr,
                              psnr_db(stage.target->read(), software->software_target()->color()));
  }
  const std::vector<RunTimes> times = time_in_turn(runs, int(scene.cameras.size()), ways);
  run.software = times[0];
  if (opengl) run.opengl = times[1];
  return run;
}

Result<std::vector<KindScene>> kind_scenes(const BenchOptions& options, const glm::ivec2& size) {
  const int count = options.quick ? 2 : 8;
  std::vector<KindScene> scenes;
  auto teapots =
      make_builtin(options.quick ? "builtin:teapots?triangles=10000" : "builtin:teapots");
  if (!teapots) return teapots.error();
  scenes.push_back(around_object("teapots", std::move(teapots->scene), count, size));
  auto stones =
      make_builtin(options.quick ? "builtin:stonehenge?triangles=10000" : "builtin:stonehenge");
  if (!stones) return stones.error();
  scenes.push_back(within_scene("stonehenge", std::move(*stones), count, size));
  for (const std::string& file : options.scenes) {
    Result<LoadedScene> loaded = load_scene(file);
    if (!loaded) return loaded.error();
    std::string name = std::filesystem::path(file).stem().string();
    scenes.push_back(around_object(std::move(name), std::move(loaded->scene), count, size));
  }
  return scenes;
}

}  // namespace

Result<BenchReport> kinds_without_opengl(const BenchOptions& options) {
  const int runs = options.quick ? 1 : 5;
  const glm::ivec2 size = options.quick ? glm::ivec2(320, 180) : glm::ivec2(1280, 720);
  Result<std::vector<KindScene>> scenes = kind_scenes(options, size);
  if (!scenes) return scenes.error();
  // Only to compare with: without OpenGL its columns stay empty.
  Result<std::unique_ptr<gl::Context>> context = gl::Context::create();
  BenchReport report;
  Stage stage;
  if (context) {
    report.machine.gl_renderer = gl::renderer_name();
    Result<SceneRenderer> renderer = SceneRenderer::create(stage.nothing);
    if (!renderer) return renderer.error();
    stage.renderer.emplace(std::move(*renderer));
    Result<FrameTarget> target = FrameTarget::create(size.x, size.y, kKindSamples);
    if (!target) return target.error();
    stage.target.emplace(std::move(*target));
  }
  const double load_before = machine_load();
  Table table{
      fmt::format("A frame of {} x {}, 4 samples, milliseconds: least and median of the runs",
                  size.x, size.y),
      {"scene", "kind", "software", "", "OpenGL", "", "polygons", "", "OpenGL / software",
       "polygons / software", "worst PSNR to OpenGL, dB"},
      {}};
  const auto number = [](double value) { return fmt::format("{:.2f}", value); };
  int done = 0;
  for (const KindScene& scene : *scenes) {
    Result<RayScene> rays = RayScene::create(scene.scene);
    if (!rays) return rays.error();
    RaySource source(*rays);
    const auto polygons = polygon_drawer(scene.scene, nullptr, kKindSamples);
    const std::function<void()> direct = way_of(*polygons, scene, nullptr);
    const RunTimes raster = time_in_turn(runs, int(scene.cameras.size()), {&direct, 1})[0];
    report.figures.emplace_back(scene.name + "_polygons_ms", raster.median());
    for (const KindCase& one : kind_cases(scene.surroundings, options.quick)) {
      const Result<KindRun> run = run_kind(scene, one, source, stage, runs);
      if (!run) return run.error();
      const std::string name = scene.name + "_" + one.name;
      const double ms = run->software.median();
      report.figures.emplace_back(name + "_ms", ms);
      report.figures.emplace_back(name + "_polygons_over_software", raster.median() / ms);
      std::vector<std::string> row{scene.name,
                                   one.name,
                                   number(run->software.least()),
                                   number(ms),
                                   "",
                                   "",
                                   number(raster.least()),
                                   number(raster.median()),
                                   "",
                                   number(raster.median() / ms),
                                   ""};
      if (stage.renderer) {
        const double opengl = run->opengl.median();
        row[4] = number(run->opengl.least()), row[5] = number(opengl);
        row[8] = number(opengl / ms), row[10] = fmt::format("{:.1f}", run->worst_psnr);
        report.figures.emplace_back(name + "_opengl_over_software", opengl / ms);
        report.figures.emplace_back(name + "_worst_psnr_to_opengl_db", run->worst_psnr);
      }
      table.rows.push_back(std::move(row));
      if (options.progress) options.progress(++done, int(3 * scenes->size()) - 1);
    }
  }
  report.tables.push_back(std::move(table));
  report.notes = {
      fmt::format("{} runs of a frame from each of {} eyes; a run is the median of its frames. "
                  "Kinds are baked by rays with their default options, and drawn without the sky.",
                  runs, scenes->front().cameras.size()),
      "Polygons are the whole scene's, by our rasteriser, with the sky."};
  report_load(load_before, report);
  if (!context) report.notes.push_back("No OpenGL to compare with: " + context.error().message());
  return report;
}

}  // namespace rilievo::bench
