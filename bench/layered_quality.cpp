#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "bench/layered.h"
#include "bench/layered_frames.h"
#include "bench/report.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/frame/gl/opengl_frames.h"
#include "rilievo/layered_impostor/bake.h"
#include "rilievo/layered_impostor/error.h"
#include "rilievo/measure/report.h"
#include "rilievo/method/direct.h"

namespace rilievo::bench {
namespace {

constexpr int kFrame = 256;

struct Plan {
  std::vector<std::pair<int, ViewSpread>> views;
  std::vector<int> sizes, layers;
  int eyes = 500;        // for the teapot ...
  int other_eyes = 100;  // ... and for the other objects
  int slow_every = 10;
  int frame = kFrame;
  int shrink = 1;  // divides the pictures' size
};

Plan make_plan(bool quick, bool full) {
  Plan plan;
  plan.views = {
      {12, ViewSpread::faces_12}, {20, ViewSpread::vertices_20}, {32, ViewSpread::both_32}};
  plan.sizes = {64, 128, 256};
  plan.layers = {16, 64, 256};
  if (!full) plan.eyes = 12, plan.other_eyes = 5;
  if (quick) {
    plan.views = {plan.views.back()};
    plan.sizes = {256};
    plan.layers = {64};
    plan.eyes = plan.other_eyes = 2;
    plan.frame = 64;
    plan.shrink = 8;
  }
  return plan;
}

// One object with its true frames.
struct Subject {
  const BenchObject& object;
  SceneRenderer renderer;
  std::vector<Camera> cameras;
  std::vector<DrawnFrame> truths;
};

Result<Subject> make_subject(const BenchObject& object, OpenGLTarget& target, int eyes, int size) {
  Result<SceneRenderer> renderer = SceneRenderer::create(object.scene);
  if (!renderer) return renderer.error();
  EyeOptions eye_options;
  eye_options.count = eyes;
  eye_options.size = size;
  Subject subject{
      object, std::move(*renderer), random_eyes(world_bounds(object.scene), eye_options), {}};
  OpenGLFrames direct(subject.renderer, std::make_unique<DirectChooser>());
  for (const Camera& camera : subject.cameras) {
    Result<DrawnFrame> shown = draw_frame(direct, target, {camera, 0});
    if (!shown) return shown.error();
    subject.truths.push_back(std::move(*shown));
  }
  return subject;
}

struct Measured {
  std::string object, warp, setting;  // setting: VIEWS_SIZE_LAYERS, as figures have it
  int views = 0, size = 0, layers = 0;
  bool fill = true;
  Quality quality;
};

void add_row(const Measured& m, Table& table, BenchReport& report) {
  const Quality& q = m.quality;
  table.rows.push_back({m.object, m.warp, std::to_string(m.views), std::to_string(m.size),
                        m.layers ? std::to_string(m.layers) : "", m.fill ? "yes" : "no",
                        fmt::format("{:.2f}", q.psnr_db.mean), fmt::format("{:.2f}", q.psnr_db.min),
                        fmt::format("{:.2f}", q.object_psnr_db.mean),
                        fmt::format("{:.4f}", q.ssim.mean), fmt::format("{:.4f}", q.flip.mean),
                        fmt::format("{:.4f}", 100 * q.uncovered),
                        fmt::format("{:.4f}", 100 * q.wrong), fmt::format("{:.1f}", q.frame_ms)});
  const std::pair<const char*, double> stats[] = {
      {"psnr_db", q.psnr_db.mean}, {"object_psnr_db", q.object_psnr_db.mean},
      {"ssim", q.ssim.mean},       {"flip", q.flip.mean},
      {"uncovered", q.uncovered},  {"wrong_visibility", q.wrong},
      {"frame_ms_p50", q.frame_ms}};
  for (const auto& [name, value] : stats)
    report.figures.emplace_back(
        fmt::format("{}_{}_{}{}", name, m.object, m.setting, m.fill ? "" : "_unfilled"), value);
}

class Sweep {
 public:
  Sweep(const Plan& plan, OpenGLTarget& target, LayeredDrawer& drawer, BenchReport& report)
      : plan_(plan), target_(target), drawer_(drawer), report_(report) {}

  // The object's pictures in one setting, drawn in every way that is asked for.
  Result<> measure(Subject& subject, const LayeredImpostor& impostor, int size, bool walk,
                   bool unfilled) {
    const int views = int(impostor.pictures.size()), layers = impostor.slicing.layers;
    if (views == 32 && size == 256 && layers == 64) add_bounds(subject, impostor);
    for (const LayeredMethod method : {LayeredMethod::slices, LayeredMethod::surfaces}) {
      const bool slices = method == LayeredMethod::slices;
      if (!slices && !walk) continue;
      for (const bool fill : {true, false}) {
        if (!fill && !unfilled) continue;
        LayeredOptions options;
        options.method = method;
        if (!fill) options.max_views = 1;
        const auto source = impostor_source(subject.renderer, drawer_, impostor, options);
        if (!source) return source.error();
        const Result<Quality> quality =
            measure_quality(target_, **source, subject.cameras, subject.truths, plan_.slow_every);
        if (!quality) return quality.error();
        const std::string setting = slices ? fmt::format("{}_{}_{}", views, size, layers)
                                           : fmt::format("{}_{}_surfaces", views, size);
        add_row({subject.object.name, slices ? "slices" : "surfaces", setting, views, size,
                 slices ? layers : 0, fill, *quality},
                table_, report_);
        if (Result<> shown = show(subject, **source, setting, fill); !shown) return shown;
      }
    }
    return Done{};
  }

  void finish() {
    report_.tables.push_back(std::move(table_));
    report_.tables.push_back(std::move(bounds_));
  }

 private:
  // What the bound claims for an eye at 4 radii.
  void add_bounds(const Subject& subject, const LayeredImpostor& impostor) {
    const Camera camera = camera_on(world_bounds(subject.object.scene), {0, 0, 4}, plan_.frame);
    const LayeredErrorStats stats =
        layered_error_stats(impostor, {.method = LayeredMethod::slices});
    const LayeredError slices = bound_layered_error(stats, impostor.bounds, glm::dmat4(1), camera);
    const LayeredError walk =
        bound_layered_error(layered_error_stats(impostor, {.method = LayeredMethod::surfaces}),
                            impostor.bounds, glm::dmat4(1), camera);
    const auto of_radius = [&](double metres) {
      return fmt::format("{:.2f}", 100 * metres / double(impostor.bounds.radius()));
    };
    bounds_.rows.push_back(
        {subject.object.name, of_radius(stats.slice), of_radius(stats.reach),
         of_radius(stats.texel), fmt::format("{:.2f}", slices.surface_px),
         fmt::format("{:.2f}", slices.sample_px), fmt::format("{:.2f}", slices.total_px),
         fmt::format("{:.2f}", walk.sample_px), fmt::format("{:.2f}", walk.total_px)});
    report_.figures.emplace_back("bound_px_slices_" + subject.object.name, slices.total_px);
    report_.figures.emplace_back("bound_px_surfaces_" + subject.object.name, walk.total_px);
  }

  // Two frames of the settings that are compared most.
  Result<> show(Subject& subject, FrameSource& source, const std::string& setting, bool fill) {
    if (subject.object.name != "teapot" && subject.object.name != "house") return Done{};
    if (!fill || (setting != "32_256_64" && setting != "32_256_surfaces")) return Done{};
    const bool walk = setting == "32_256_surfaces";
    const int shown_eyes = subject.object.name == "teapot" ? 2 : 1;
    for (int eye = 0; eye < shown_eyes; ++eye) {
      const DrawnFrame& truth = subject.truths[std::size_t(eye)];
      const Result<DrawnFrame> frame =
          draw_frame(source, target_, {subject.cameras[std::size_t(eye)], 0});
      if (!frame) return frame.error();
      const auto add = [&](const std::string& what, const Rgba8Image& picture) {
        report_.pictures.push_back(
            png_picture(fmt::format("{}, eye {}: {}", subject.object.name, eye, what), picture));
      };
      if (!walk) add("drawn directly", truth.color);
      add(walk ? "32 views of 256, surfaces" : "32 views of 256, 64 slices", frame->color);
      add(walk ? "surfaces, difference" : "slices, difference",
          difference_picture(truth.color, frame->color));
    }
    return Done{};
  }

  const Plan& plan_;
  OpenGLTarget& target_;
  LayeredDrawer& drawer_;
  BenchReport& report_;
  Table table_{"Likeness to direct drawing",
               {"object", "warp", "views", "size", "layers", "holes filled", "PSNR dB", "least dB",
                "object's dB", "SSIM", "FLIP", "uncovered %", "wrong %", "ms p50"},
               {}};
  Table bounds_{
      "What the bound claims (layered_impostor/error.h): 32 views of 256, 64 layers; percent "
      "of the radius, and pixels for an eye at 4 radii",
      {"object", "slice", "piece", "texel", "slices: to the surface, px", "to the sample, px",
       "to the source of the colour, px", "surfaces: to the sample, px",
       "to the source of the colour, px"},
      {}};
};

}  // namespace

Result<> add_quality(const BenchOptions& options, BenchReport& report) {
  const Plan plan = make_plan(options.quick, options.full);
  const std::vector<BenchObject> objects = bench_objects(options.quick ? 3000 : 20000);
  Result<OpenGLTarget> target = OpenGLTarget::create(plan.frame, plan.frame, 4);
  if (!target) return target.error();
  Result<LayeredDrawer> drawer = LayeredDrawer::create();
  if (!drawer) return drawer.error();
  Sweep sweep(plan, *target, *drawer, report);
  const int total =
      int(plan.views.size() * plan.sizes.size() * plan.layers.size() + objects.size() - 1);
  int done = 0;
  for (const BenchObject& object : objects) {
    const bool first = &object == &objects[0];
    Result<Subject> subject =
        make_subject(object, *target, first ? plan.eyes : plan.other_eyes, plan.frame);
    if (!subject) return subject.error();
    for (const auto& [count, spread] : plan.views) {
      for (const int size : plan.sizes) {
        // The other objects in one setting.
        if (!first && (count != 32 || size != 256)) continue;
        BakeOptions bake;
        bake.views.spread = spread;
        bake.camera.size = size / plan.shrink;
        bake.fills = false;
        OpenGLSource source(subject->renderer);
        Result<LayeredImpostor> baked = bake_layered(source, {}, bake);
        if (!baked) return baked.error();
        for (const int layers : plan.layers) {
          if (!first && layers != 64) continue;
          if (options.progress) options.progress(done++, total);
          SliceOptions slicing;
          slicing.layers = layers;
          Result<LayeredImpostor> impostor = make_layered_impostor(baked->pictures, slicing);
          if (!impostor) return impostor.error();
          FillOptions fill_options;
          if (options.quick) fill_options.size = 24;
          find_fill_slices(*impostor, fill_options);
          const Result<> measured = sweep.measure(*subject, *impostor, size, layers == 64, first);
          if (!measured) return measured;
        }
      }
    }
  }
  if (options.progress) options.progress(total, total);
  sweep.finish();
  const auto figure = [&](const std::string& name) {
    for (const auto& [known, value] : report.figures)
      if (known == name) return value;
    return 0.0;
  };
  report.figures.emplace_back("second_warp_gain_db", figure("psnr_db_teapot_32_256_surfaces") -
                                                         figure("psnr_db_teapot_32_256_64"));
  report.figures.emplace_back(
      "second_warp_time_ratio",
      figure("frame_ms_p50_teapot_32_256_surfaces") / figure("frame_ms_p50_teapot_32_256_64"));
  report.notes.push_back(fmt::format(
      "{} seeded random eyes all around the teapot ({} around the other objects) at 3 to 5 radii "
      "of the ball around the box; frames of {} x {}, which that ball fills, so that a pixel is "
      "about as large as a texel of 256. Every frame has the scene's sky, drawn alike in both, and "
      "4 samples a pixel. PSNR over the whole frame, and over the pixels whose middle shows the "
      "object. Uncovered: of the pixels of the object that are not within 1 pixel of its outline; "
      "as figures, shares. SSIM and FLIP of every {}th frame.",
      plan.eyes, plan.other_eyes, plan.frame, plan.frame, plan.slow_every));
  report.notes.push_back(
      "Both warps with their defaults: views fade into each other. \"No\" in the column of holes: "
      "the nearest view alone.");
  return Done{};
}

}  // namespace rilievo::bench
