// Figure 4 of [Schaufler 1998] as a plot: how many pixels of the object show nothing when a single
// picture is seen from beside its own direction.

#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bench/layered.h"
#include "bench/layered_frames.h"
#include "bench/report.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/frame/gl/opengl_frames.h"
#include "rilievo/layered_impostor/bake.h"
#include "rilievo/measure/visibility.h"
#include "rilievo/method/direct.h"

namespace rilievo::bench {
namespace {

constexpr double kTearsDistance = 4;                                        // of the eyes, radii
constexpr int kTearsStep = 2, kMaxDegrees = 30, kFigure = 20, kShown = 20;  // degrees

struct TearsWay {
  const char* figure;
  const char* name;
  LayeredMethod method = LayeredMethod::slices;
  float overlap = 0;
  bool pieces = false, solid = false;
};
constexpr TearsWay kTearsWays[] = {
    {"overlap_0", "samples, no overlap"},
    {"overlap_0.25", "samples, overlap 0.25", LayeredMethod::slices, 0.25f},
    {"overlap_0.5", "samples, overlap 0.5", LayeredMethod::slices, 0.5f},
    {"overlap_1", "samples, overlap 1", LayeredMethod::slices, 1.0f},
    {"pieces", "pieces of surface, no overlap", LayeredMethod::slices, 0, true},
    {"pieces_solid", "pieces, solid inside", LayeredMethod::slices, 0, true, true},
    {"surfaces", "the walk: what the picture lacks", LayeredMethod::surfaces, 0, true},
};

// `offset` from the direction, towards `azimuth`. Radians.
glm::dvec3 beside(const glm::dvec3& direction, double offset, double azimuth) {
  const glm::dvec3 other = std::abs(direction.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 a = glm::normalize(glm::cross(other, direction)), b = glm::cross(direction, a);
  return std::cos(offset) * direction +
         std::sin(offset) * (std::cos(azimuth) * a + std::sin(azimuth) * b);
}

// One picture of the impostor, as an impostor; solid if it knows the others' inside.
LayeredImpostor alone(const LayeredImpostor& impostor, std::size_t view, const TearsWay& way) {
  LayeredImpostor one;
  one.name = impostor.name;
  one.bounds = impostor.bounds;
  one.slicing = impostor.slicing;
  one.slicing.overlap = way.overlap;
  one.slicing.pieces = way.pieces;
  one.views = view_set_from_directions({impostor.views.directions[view]});
  one.pictures = {impostor.pictures[view]};
  one.surfaces = {impostor.surfaces[view]};
  one.complete = {impostor.complete[view]};
  one.sees_through = {impostor.sees_through[view]};
  if (!way.solid)
    for (SurfaceTexel& texel : one.surfaces[0].texels.texels()) texel.inside = 0;
  one.slices = {slice_surface(one.surfaces[0], one.slicing)};
  return one;
}

struct Eye {
  Camera camera;
  DrawnFrame truth;
};

}  // namespace

Result<> add_tears(const BenchOptions& options, BenchReport& report) {
  const std::vector<BenchObject> objects = bench_objects(options.quick ? 3000 : 20000);
  const Scene& scene = objects[0].scene;
  const Box box = world_bounds(scene);
  const int size = options.quick ? 48 : 256;
  const int azimuths = options.quick ? 1 : options.full ? 6 : 2;
  const std::size_t every = options.quick ? 16 : options.full ? 4 : 8;  // view of the 32
  Result<SceneRenderer> renderer = SceneRenderer::create(scene);
  if (!renderer) return renderer.error();
  Result<OpenGLTarget> target = OpenGLTarget::create(size, size, 4);
  if (!target) return target.error();
  Result<LayeredDrawer> drawer = LayeredDrawer::create();
  if (!drawer) return drawer.error();
  BakeOptions bake;
  bake.camera.size = size;
  bake.fills = false;
  OpenGLSource scene_source(*renderer);
  const Result<LayeredImpostor> impostor = bake_layered(scene_source, {}, bake);
  if (!impostor) return impostor.error();

  constexpr std::size_t kOffsets = kMaxDegrees / kTearsStep + 1;
  std::vector<std::vector<Visibility>> found(std::size(kTearsWays),
                                             std::vector<Visibility>(kOffsets));
  OpenGLFrames direct(*renderer, std::make_unique<DirectChooser>());
  for (std::size_t view = 0; view < impostor->pictures.size(); view += every) {
    std::vector<std::vector<Eye>> eyes(kOffsets);
    for (std::size_t o = 0; o < kOffsets; ++o)
      for (int a = 0; a < (o == 0 ? 1 : azimuths); ++a) {
        const glm::dvec3 direction =
            beside(impostor->views.directions[view], glm::radians(double(o) * kTearsStep),
                   2 * glm::pi<double>() * (a + 0.25) / azimuths);
        const Camera camera = camera_on(box, kTearsDistance * direction, size);
        Result<DrawnFrame> truth = draw_frame(direct, *target, {camera, 0});
        if (!truth) return truth.error();
        eyes[o].push_back({camera, std::move(*truth)});
      }
    for (std::size_t w = 0; w < std::size(kTearsWays); ++w) {
      LayeredOptions layered_options;
      layered_options.method = kTearsWays[w].method;
      layered_options.max_views = 1;
      const auto source = impostor_source(*renderer, *drawer, alone(*impostor, view, kTearsWays[w]),
                                          layered_options);
      if (!source) return source.error();
      for (std::size_t o = 0; o < kOffsets; ++o)
        for (const Eye& eye : eyes[o]) {
          const Result<DrawnFrame> shown = draw_frame(**source, *target, {eye.camera, 0});
          if (!shown) return shown.error();
          const Visibility one = compare_visibility(eye.truth.objects, shown->objects);
          found[w][o].counted_objects += one.counted_objects;
          found[w][o].uncovered += one.uncovered;
          if (view == 4 && o == kShown / kTearsStep && &eye == &eyes[o][0])
            report.pictures.push_back(
                png_picture(fmt::format("Tears, figure 4: one picture from {} degrees beside: {}",
                                        kShown, kTearsWays[w].name),
                            shown->color));
        }
    }
    if (options.progress) options.progress(int(view + every), int(impostor->pictures.size()));
  }

  Table table{
      "Tears: percent of the teapot's pixels, away from its outline, that show nothing; one "
      "picture alone, 64 layers",
      {"texels and overlap", "0 deg", "10 deg", "20 deg", "30 deg"},
      {}};
  Plot plot{"Tears (figure 4)", "eye beside the picture's direction, degrees", "% uncovered", {}};
  for (std::size_t w = 0; w < std::size(kTearsWays); ++w) {
    Curve curve{kTearsWays[w].name, {}, {}};
    std::vector<std::string> row{kTearsWays[w].name};
    for (std::size_t o = 0; o < kOffsets; ++o) {
      const double share = found[w][o].uncovered_share();
      const int degrees = int(o) * kTearsStep;
      curve.x.push_back(degrees);
      curve.y.push_back(100 * share);
      if (degrees % 10 == 0) row.push_back(fmt::format("{:.3f}", 100 * share));
      if (degrees == kFigure)
        report.figures.emplace_back(fmt::format("tears_{}_at_{}deg", kTearsWays[w].figure, kFigure),
                                    share);
    }
    table.rows.push_back(std::move(row));
    plot.curves.push_back(std::move(curve));
  }
  report.tables.push_back(std::move(table));
  report.plots.push_back(std::move(plot));
  report.notes.push_back(fmt::format(
      "Tears: one of {} of the 32 views, {} eyes around each at 4 radii, no neighbours. The "
      "ray march leaves open what the picture does not hold; slices of samples above it "
      "are torn. Slices of pieces lie below it: they swell by up to a texel over the "
      "edges of holes.",
      every, azimuths));
  return Done{};
}

}  // namespace rilievo::bench
