// The paper found the switching between views "distractingly noticeable" under 20 views: by how
// much more than the true frames do frames differ from those before them?

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bench/layered.h"
#include "bench/layered_frames.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/frame/gl/opengl_frames.h"
#include "rilievo/layered_impostor/bake.h"
#include "rilievo/measure/flip.h"
#include "rilievo/method/direct.h"

namespace rilievo::bench {
namespace {

constexpr double kDistance = 4;       // radii
constexpr double kStepDegrees = 0.5;  // of the orbit
constexpr double kTiltDegrees = 35;   // of the orbit's plane, so that it crosses many borders

glm::dvec3 on_orbit(double degrees) {
  const double a = glm::radians(degrees), tilt = glm::radians(kTiltDegrees);
  return kDistance *
         glm::dvec3(std::cos(a), std::sin(a) * std::sin(tilt), std::sin(a) * std::cos(tilt));
}

struct Way {
  const char* figure;
  const char* name;
  LayeredMethod method;
  bool fade;
};
constexpr Way kWays[] = {{"slices_switch", "slices, switched", LayeredMethod::slices, false},
                         {"slices_fade", "slices, faded", LayeredMethod::slices, true},
                         {"surfaces_switch", "surfaces, switched", LayeredMethod::surfaces, false},
                         {"surfaces_fade", "surfaces, faded", LayeredMethod::surfaces, true}};

}  // namespace

Result<> add_jumps(const BenchOptions& options, BenchReport& report) {
  const std::vector<BenchObject> objects = bench_objects(options.quick ? 3000 : 20000);
  const Scene& scene = objects[0].scene;
  const Box box = world_bounds(scene);
  const int size = options.quick ? 48 : 256, steps = options.quick ? 4 : 240;
  Result<SceneRenderer> renderer = SceneRenderer::create(scene);
  if (!renderer) return renderer.error();
  Result<OpenGLTarget> target = OpenGLTarget::create(size, size, 4);
  if (!target) return target.error();
  Result<LayeredDrawer> drawer = LayeredDrawer::create();
  if (!drawer) return drawer.error();

  // FLIP between a frame and the one before it.
  const auto changes = [&](FrameSource& source) -> Result<std::vector<double>> {
    std::vector<double> flips;
    Rgba8Image last;
    for (int i = 0; i <= steps; ++i) {
      const Camera camera = camera_on(box, on_orbit(i * kStepDegrees), size);
      Result<DrawnFrame> shown = draw_frame(source, *target, {camera, 0});
      if (!shown) return shown.error();
      if (i > 0) flips.push_back(flip(last, shown->color));
      last = std::move(shown->color);
    }
    return flips;
  };
  OpenGLFrames direct(*renderer, std::make_unique<DirectChooser>());
  const Result<std::vector<double>> true_changes = changes(direct);
  if (!true_changes) return true_changes.error();

  Table table{"Jumps: FLIP between a frame and the one before it, above that of the true frames",
              {"views", "slices, switched", "faded", "surfaces, switched", "faded",
               "mean: slices, switched", "faded", "surfaces, switched", "faded"},
              {}};
  Plot plot{"Frame to frame, 12 views", "orbit, degrees", "FLIP to the frame before", {}};
  Curve curve{"true frames", {}, {}};
  for (std::size_t i = 0; i < true_changes->size(); ++i) {
    curve.x.push_back(double(i + 1) * kStepDegrees);
    curve.y.push_back((*true_changes)[i]);
  }
  const std::vector<double> x = curve.x;
  plot.curves.push_back(std::move(curve));
  int done = 0;
  for (const auto& [count, spread] :
       {std::pair(12, ViewSpread::faces_12), std::pair(20, ViewSpread::vertices_20),
        std::pair(32, ViewSpread::both_32)}) {
    BakeOptions bake;
    bake.views.spread = spread;
    bake.camera.size = size;
    OpenGLSource scene_source(*renderer);
    const Result<LayeredImpostor> impostor = bake_layered(scene_source, {}, bake);
    if (!impostor) return impostor.error();
    std::vector<std::string> most{std::to_string(count)}, means;
    for (const Way& way : kWays) {
      LayeredOptions layered_options;
      layered_options.method = way.method;
      if (!way.fade) layered_options.handover = 0;
      const auto source = impostor_source(*renderer, *drawer, *impostor, layered_options);
      if (!source) return source.error();
      const Result<std::vector<double>> drawn = changes(**source);
      if (!drawn) return drawn.error();
      double jump = 0, sum = 0;
      for (std::size_t i = 0; i < drawn->size(); ++i) {
        const double more = (*drawn)[i] - (*true_changes)[i];
        jump = std::max(jump, more);
        sum += more;
      }
      report.figures.emplace_back(fmt::format("jump_{}_{}", way.figure, count), jump);
      most.push_back(fmt::format("{:.4f}", jump));
      means.push_back(fmt::format("{:.4f}", sum / double(drawn->size())));
      if (count == 12) plot.curves.push_back({way.name, x, *drawn});
      if (options.progress) options.progress(++done, 3 * int(std::size(kWays)));
    }
    most.insert(most.end(), means.begin(), means.end());
    table.rows.push_back(std::move(most));
  }
  report.tables.push_back(std::move(table));
  report.plots.push_back(std::move(plot));
  report.notes.push_back(fmt::format(
      "Jumps: {} steps of {} degrees on an orbit of 4 radii, tilted by {} degrees. Switched: "
      "handover 0. Faded: the default.",
      steps, kStepDegrees, kTiltDegrees));
  return Done{};
}

}  // namespace rilievo::bench
