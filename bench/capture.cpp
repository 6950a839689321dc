// The cost of capturing a picture: by OpenGL, by the rasteriser made for pictures, by rays.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <vector>

#include "bench/benches.h"
#include "bench/timing.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/raster_source.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/nailboard/gl/nailboard_capture.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo::bench {
namespace {

constexpr int kSize = 512;  // texels a side

struct Measured {
  std::uint64_t triangles = 0;
  double opengl_ms = 0, rasterizer_ms = 0, rays_ms = 0, copy_ms = 0;
  double rasterizer_db = 0, rays_db = 0;  // against OpenGL
  int lost = 0;                           // objects that OpenGL shows and the rasteriser does not
  double other_objects = 0;               // share of texels whose centres show another object
};

// Of the objects in one sample a texel, by the one capture call.
Result<> compare_objects(SceneRenderer& renderer, const Camera& camera, Measured& m) {
  OpenGLSource opengl(renderer);
  RasterSource rasterizer(renderer.placed());
  const Result<CapturedPicture> a = opengl.capture({.camera = camera, .samples = 1});
  if (!a) return a.error();
  const Result<CapturedPicture> b = rasterizer.capture({.camera = camera, .samples = 1});
  if (!b) return b.error();
  const auto in_a = a->picture.object.texels(), in_b = b->picture.object.texels();
  std::vector<std::array<int, 2>> texels(renderer.scene().objects.size() + 1);
  int other = 0;
  for (std::size_t i = 0; i < in_a.size(); ++i) {
    ++texels[in_a[i]][0], ++texels[in_b[i]][1];
    other += in_a[i] != in_b[i];
  }
  m.other_objects = double(other) / double(in_a.size());
  for (std::size_t object = 1; object < texels.size(); ++object)
    m.lost += texels[object][0] > 3 && texels[object][1] == 0;
  return Done{};
}

Rgba8Image from_top(const RasterPicture& picture) {
  Rgba8Image image(picture.width, picture.height);
  const auto width = std::size_t(picture.width);
  for (int y = 0; y < picture.height; ++y)
    std::copy_n(picture.color.begin() + std::ptrdiff_t(std::size_t(y) * width), width,
                image.row(picture.height - 1 - y).begin());
  return image;
}

// All of a scene in one picture, from above.
Result<Measured> measure(const Scene& scene, int runs) {
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
  std::vector<Nailboard> taken;
  for (const CaptureBy by : {CaptureBy::opengl, CaptureBy::rasterizer}) {
    Result<NailboardCapture> nailboards =
        NailboardCapture::create(*renderer, by, {}, DepthMode::exact);
    if (!nailboards) return nailboards.error();
    NailboardAtlas& atlas = nailboards->atlas();
    const auto slot = atlas.allocate(kSize, kSize);
    if (!slot) return Error{"bench", "no room for one picture"};
    (by == CaptureBy::rasterizer ? m.rasterizer_ms : m.opengl_ms) = finished_ms(runs, 1, [&] {
      nailboards->capture(*camera, objects, *slot);
      static_cast<void>(atlas.blocks(*slot));
    });
    taken.push_back(atlas.read(*slot, picture_geometry(*camera)));
  }
  if (Result<> compared = compare_objects(*renderer, *camera, m); !compared)
    return compared.error();
  m.rasterizer_db = psnr_db(taken[0].color, taken[1].color);
  std::vector<std::uint8_t> copy(std::size_t(kSize) * kSize * 5);  // colour and Delta
  const std::vector<std::uint8_t> source(copy.size(), 1);
  m.copy_ms = finished_ms(runs, 1, [&] { std::memcpy(copy.data(), source.data(), copy.size()); });

  Result<RayScene> rays = RayScene::create(scene);
  if (!rays) return rays.error();
  PictureCaster caster(*rays);
  RasterPicture cast;
  m.rays_ms = finished_ms(runs, 1, [&] { caster.draw(*camera, {}, AtlasOptions{}.samples, cast); });
  m.rays_db = psnr_db(taken[0].color, from_top(cast));
  return m;
}

// What is measured: forests of all sizes, and the models of others that are at hand.
struct Subject {
  std::string name, key;
  std::function<Result<Scene>()> make;
};

std::vector<Subject> subjects(bool quick) {
  std::vector<Subject> out;
  for (const std::uint64_t triangles : {10'000u, 100'000u, 1'000'000u, 10'000'000u}) {
    out.push_back({"forest", std::to_string(triangles), [triangles]() -> Result<Scene> {
                     Result<BuiltinScene> made =
                         make_builtin(fmt::format("builtin:forest?triangles={}", triangles));
                     if (!made) return made.error();
                     return std::move(made->scene);
                   }});
    if (quick) return out;
  }
  const char* const data = std::getenv("RILIEVO_DATA");
  if (!data) return out;
  for (const auto& [name, file] :
       {std::pair{"FlightHelmet", "models/FlightHelmet/FlightHelmet.gltf"},
        std::pair{"copperBeech", "obj/copperBeech/copperBeech.obj"},
        std::pair{"chess-board", "models/chess-board.glb"}}) {
    const std::filesystem::path path = std::filesystem::path(data) / file;
    if (std::filesystem::exists(path))
      out.push_back({name, name, [path]() -> Result<Scene> {
                       Result<LoadedScene> loaded = load_scene(path);
                       if (!loaded) return loaded.error();
                       return std::move(loaded->scene);
                     }});
  }
  return out;
}

}  // namespace

Result<BenchReport> capture(const BenchOptions& options) {
  const std::vector<Subject> all = subjects(options.quick);
  const int runs = options.quick ? 1 : 7;
  BenchReport report;
  Table table{
      fmt::format("A scene in one picture of {} x {} texels, four samples each", kSize, kSize),
      {"scene", "triangles", "OpenGL ms", "rasteriser ms", "times", "rays ms", "copies",
       "OpenGL against rasteriser, dB", "against rays, dB", "objects lost",
       "texels of other objects, %"},
      {}};
  Curve by_opengl{"OpenGL", {}, {}}, by_rasterizer{"rasteriser", {}, {}}, by_rays{"rays", {}, {}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Result<Scene> scene = all[i].make();
    if (!scene) return scene.error();
    const Result<Measured> m = measure(*scene, runs);
    if (!m) return m.error();
    const double times = m->opengl_ms / m->rasterizer_ms;
    table.rows.push_back(
        {all[i].name, std::to_string(m->triangles), fmt::format("{:.1f}", m->opengl_ms),
         fmt::format("{:.1f}", m->rasterizer_ms), fmt::format("{:.1f}", times),
         fmt::format("{:.1f}", m->rays_ms), fmt::format("{:.0f}", m->rasterizer_ms / m->copy_ms),
         fmt::format("{:.1f}", m->rasterizer_db), fmt::format("{:.1f}", m->rays_db),
         std::to_string(m->lost), fmt::format("{:.3f}", 100 * m->other_objects)});
    const std::pair<Curve*, double> points[] = {
        {&by_opengl, m->opengl_ms}, {&by_rasterizer, m->rasterizer_ms}, {&by_rays, m->rays_ms}};
    if (all[i].name == "forest")
      for (const auto& [curve, ms] : points) {
        curve->x.push_back(double(m->triangles));
        curve->y.push_back(ms);
      }
    report.figures.push_back({"rasterizer_times_" + all[i].key, times});
    report.figures.push_back({"psnr_db_" + all[i].key, m->rasterizer_db});
    report.figures.push_back({"rays_times_" + all[i].key, m->opengl_ms / m->rays_ms});
    report.figures.push_back({"rays_psnr_db_" + all[i].key, m->rays_db});
    report.figures.push_back({"objects_lost_" + all[i].key, double(m->lost)});
    if (options.progress) options.progress(int(i) + 1, int(all.size()));
  }
  report.tables = {std::move(table)};
  report.plots = {{"Cost of a capture of a forest",
                   "triangles",
                   "ms",
                   {by_opengl, by_rasterizer, by_rays},
                   true,
                   true,
                   true}};
  report.notes = {
      "OpenGL and rasteriser: with Delta, blocks and the way to the GPU; `times`: the first by the "
      "second. `copies`: the rasteriser's time by that of a memcpy of colour and Delta.",
      "Objects lost: those in more than three texels of OpenGL's picture and in none of the "
      "rasteriser's; none is left to OpenGL.",
      "Rays: by Embree, a ray a sample, shaded as the rasteriser shades.",
      "Models of others are measured if RILIEVO_DATA names the folder that has them."};
  return report;
}

}  // namespace rilievo::bench
