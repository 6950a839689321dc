#include "bench/capture.h"

#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <functional>
#include <vector>

#include "rilievo/gl/context.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/stats.h"
#include "rilievo/nailboard/gl/picture_atlas.h"
#include "rilievo/render/raster/raster_picture.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {
namespace {

constexpr int kSize = 512;  // texels a side

double median_ms(int runs, const std::function<void()>& work) {
  std::vector<double> ms;
  for (int run = 0; run < runs + 1; ++run) {
    gl::finish();
    const auto start = std::chrono::steady_clock::now();
    work();
    gl::finish();
    const auto end = std::chrono::steady_clock::now();
    // The first one touches memory.
    if (run > 0) ms.push_back(std::chrono::duration<double, std::milli>(end - start).count());
  }
  return percentile(ms, 0.5);
}

struct Measured {
  std::uint64_t triangles = 0;
  double opengl_ms = 0, rasterizer_ms = 0, rays_ms = 0, copy_ms = 0, psnr_db = 0;
};

// A whole forest in one picture, from above.
Result<Measured> measure(std::uint64_t triangles, int runs) {
  Result<BuiltinScene> forest = make_builtin(fmt::format("builtin:forest?triangles={}", triangles));
  if (!forest) return forest.error();
  const Scene& scene = forest->scene;
  Result<SceneRenderer> renderer = SceneRenderer::create(scene);
  if (!renderer) return renderer.error();
  const Box box = world_bounds(scene);
  const glm::dvec3 eye =
      glm::dvec3(box.center()) + 1.6 * double(box.radius()) * glm::dvec3(0.3, 0.7, 0.6);
  Result<Camera> camera = tight_camera(Projection::perspective, eye, {0, 1, 0}, box);
  if (!camera) return camera.error();
  camera->width = camera->height = kSize;
  std::vector<std::uint32_t> objects;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) objects.push_back(i);

  Measured m;
  m.triangles = count_triangles(scene);
  AtlasOptions options;
  std::vector<Nailboard> taken;
  for (const bool rasterized : {false, true}) {
    options.rasterized = rasterized ? &scene : nullptr;
    Result<PictureAtlas> atlas = PictureAtlas::create(options);
    if (!atlas) return atlas.error();
    const auto slot = atlas->allocate(kSize, kSize);
    if (!slot) return Error{"bench", "no room for one picture"};
    (rasterized ? m.rasterizer_ms : m.opengl_ms) = median_ms(runs, [&] {
      atlas->capture(*renderer, *camera, objects, *slot);
      static_cast<void>(atlas->blocks(*slot));
    });
    taken.push_back(atlas->read(*slot, picture_geometry(*camera)));
  }
  m.psnr_db = psnr_db(taken[0].color, taken[1].color);
  std::vector<std::uint8_t> copy(std::size_t(kSize) * kSize * 5);  // colour and Delta
  const std::vector<std::uint8_t> source(copy.size(), 1);
  m.copy_ms = median_ms(runs, [&] { std::memcpy(copy.data(), source.data(), copy.size()); });

  Result<RayScene> rays = RayScene::create(scene);
  if (!rays) return rays.error();
  Camera four_rays = *camera;  // a texel
  four_rays.width *= 2, four_rays.height *= 2;
  m.rays_ms = median_ms(1, [&] { static_cast<void>(cast_picture(*rays, four_rays)); });
  return m;
}

}  // namespace

Result<BenchReport> capture(const BenchOptions& options) {
  std::vector<std::uint64_t> sizes{10'000, 100'000, 1'000'000, 10'000'000};
  if (options.quick) sizes.resize(1);
  const int runs = options.quick ? 1 : 7;
  BenchReport report;
  Table table{
      fmt::format("A forest in one picture of {} x {} texels, four samples each", kSize, kSize),
      {"triangles", "OpenGL ms", "rasteriser ms", "times", "rays ms", "copies",
       "OpenGL against rasteriser, dB"},
      {}};
  Curve by_opengl{"OpenGL", {}, {}}, by_rasterizer{"rasteriser", {}, {}}, by_rays{"rays", {}, {}};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const Result<Measured> m = measure(sizes[i], runs);
    if (!m) return m.error();
    const double times = m->opengl_ms / m->rasterizer_ms;
    table.rows.push_back({std::to_string(m->triangles), fmt::format("{:.1f}", m->opengl_ms),
                          fmt::format("{:.1f}", m->rasterizer_ms), fmt::format("{:.1f}", times),
                          fmt::format("{:.0f}", m->rays_ms),
                          fmt::format("{:.0f}", m->rasterizer_ms / m->copy_ms),
                          fmt::format("{:.1f}", m->psnr_db)});
    const std::pair<Curve*, double> points[] = {
        {&by_opengl, m->opengl_ms}, {&by_rasterizer, m->rasterizer_ms}, {&by_rays, m->rays_ms}};
    for (const auto& [curve, ms] : points) {
      curve->x.push_back(double(m->triangles));
      curve->y.push_back(ms);
    }
    report.figures.push_back({fmt::format("rasterizer_times_{}", sizes[i]), times});
    report.figures.push_back({fmt::format("psnr_db_{}", sizes[i]), m->psnr_db});
    if (options.progress) options.progress(int(i) + 1, int(sizes.size()));
  }
  report.tables = {std::move(table)};
  report.plots = {{"Cost of a capture",
                   "triangles",
                   "ms",
                   {by_opengl, by_rasterizer, by_rays},
                   true,
                   true,
                   true}};
  report.notes = {
      "OpenGL and rasteriser: with Delta, blocks and the way to the GPU; `times`: the first by the "
      "second. `copies`: the rasteriser's time by that of a memcpy of colour and Delta.",
      "Rays: four a texel by Embree, one at a time, diffuse shading only."};
  return report;
}

}  // namespace rilievo::bench
