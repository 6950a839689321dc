// rilievo bake SCENE -o FILE.exr: pictures with depth of a scene from all around, in one file that
// draws without the scene.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/rilievo/capture.h"
#include "apps/rilievo/checks.h"
#include "apps/rilievo/command.h"
#include "apps/rilievo/layered_options.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "apps/rilievo/scene_file.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/frame/gl/direct_frames.h"
#include "rilievo/gl/context.h"
#include "rilievo/io/rgbd.h"
#include "rilievo/layered_impostor/file.h"
#include "rilievo/measure/stats.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo::app {
namespace {

struct Options {
  std::string scene, output, json, as = "layered-impostor";
  FileLimits limits;
  LayeredBakeOptions bake;
  std::vector<double> box;
  bool around = false;
};

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What one frame of the scene costs without pictures, all of it in view; milliseconds, median.
Result<double> direct_ms(SceneRenderer& renderer, int width, int height) {
  Result<FrameTarget> target = FrameTarget::create(width, height, 4);
  if (!target) return target.error();
  constexpr int kFrames = 5;
  const CameraPath path = orbit_path(world_bounds(renderer.scene()), kFrames);
  DirectFrames direct(renderer);
  std::vector<double> ms;
  // One more to warm up.
  for (int frame = 0; frame <= kFrames; ++frame) {
    const Camera camera = camera_at(path, frame_time(path, frame), width, height);
    const Clock::time_point start = Clock::now();
    target->begin();
    if (Result<> drawn = direct.draw(camera, 0); !drawn) return drawn.error();
    target->resolve();
    gl::finish();
    if (frame > 0) ms.push_back(1e3 * seconds_since(start));
  }
  return summarize(ms).p50;
}

struct Baked {
  LayeredImpostor impostor;
  double capture_s = 0, slice_s = 0, save_s = 0;
  std::size_t file_bytes = 0;

  [[nodiscard]] double seconds() const { return capture_s + slice_s + save_s; }
  [[nodiscard]] double ms_per_view() const {
    return 1e3 * seconds() / double(impostor.pictures.size());
  }
};

Result<Baked> bake(const Options& options, SceneRenderer& renderer) {
  Result<BakeOptions> bake = bake_options(options.bake);
  if (!bake) return bake.error();
  Baked baked;
  Progress progress("view");
  const Clock::time_point start = Clock::now();
  bake->progress = [&](int done, int total) {
    progress.show(done, total);
    baked.capture_s = seconds_since(start);
  };
  Result<LayeredImpostor> impostor = bake_layered(renderer, *bake);
  if (!impostor) return Error{options.scene, impostor.error().reason};
  baked.slice_s = seconds_since(start) - baked.capture_s;
  baked.impostor = std::move(*impostor);
  const Clock::time_point saving = Clock::now();
  if (Result<> saved = save_layered_impostor(options.output, baked.impostor); !saved)
    return saved.error();
  baked.save_s = seconds_since(saving);
  // A device has no size.
  if (std::filesystem::is_regular_file(options.output))
    baked.file_bytes = std::filesystem::file_size(options.output);
  return baked;
}

Result<> report_bake(const Options& options, const Baked& baked, SceneRenderer& renderer) {
  const int size = options.bake.size;
  const Result<double> small = direct_ms(renderer, size, size);
  if (!small) return small.error();
  const Result<double> large = direct_ms(renderer, 1280, 720);
  if (!large) return large.error();
  const LayeredFigures figures = analyze_layered_impostor(baked.impostor);
  const std::size_t views = baked.impostor.pictures.size();
  const nlohmann::json json{
      {"schema", "rilievo-bake-1"},
      {"scene", options.scene},
      {"as", options.as},
      {"triangles", count_triangles(renderer.scene())},
      {"views", views},
      {"size", size},
      {"layers", options.bake.layers},
      {"overlap", options.bake.overlap},
      {"file_bytes", baked.file_bytes},
      {"paper_bytes", figures.paper_bytes},
      {"coverage", double(figures.covered_texels) / (double(views) * double(size) * double(size))},
      {"fill_saved", figures.fill_saved},
      {"seconds",
       {{"capture", baked.capture_s},
        {"slice", baked.slice_s},
        {"save", baked.save_s},
        {"total", baked.seconds()}}},
      {"ms_per_view", baked.ms_per_view()},
      {"direct_ms", {{fmt::format("{0}x{0}", size), *small}, {"1280x720", *large}}},
      {"direct_frames_per_view",
       {{fmt::format("{0}x{0}", size), baked.ms_per_view() / *small},
        {"1280x720", baked.ms_per_view() / *large}}}};
  return write_json(options.json, json);
}

Result<> run(const Options& options) {
  if (!is_picture_file(options.output))
    return Error{options.output, "pictures are written as OpenEXR: the name must end in .exr"};
  // Before the time is spent.
  if (Result<> good = expect_outputs({options.output, options.json}); !good) return good;
  if (Result<BakeOptions> bake = bake_options(options.bake); !bake) return bake.error();
  if (holds_pictures(options.scene))
    return Error{options.scene, "holds pictures already: a scene is baked"};
  if (is_rgbd_capture(options.scene))
    return bake_capture({options.scene, options.output, options.json, options.bake, options.limits,
                         options.box, options.around});
  if (!options.box.empty() || options.around)
    return Error{options.scene, "is no capture: --box and --around are for photographs"};
  const Result<OpenedScene> opened = open_scene(options.scene, options.limits);
  if (!opened) return opened.error();
  const std::filesystem::path folder = std::filesystem::path(options.output).parent_path();
  if (Result<> made = make_folder(folder); !made) return made;
  const auto context = gl::Context::create();
  if (!context) return context.error();
  Result<SceneRenderer> renderer = SceneRenderer::create(opened->scene);
  if (!renderer) return renderer.error();
  const Result<Baked> baked = bake(options, *renderer);
  if (!baked) return baked.error();
  if (!options.json.empty()) return report_bake(options, *baked, *renderer);
  print("{}: {} views of {}x{}, {:.1f} MB, {:.1f} s\n", options.output,
        baked->impostor.pictures.size(), options.bake.size, options.bake.size,
        1e-6 * double(baked->file_bytes), baked->seconds());
  return Done{};
}

}  // namespace

Command bake_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("bake", "Take pictures of a scene from all around, into one file");
  command
      ->add_option("SCENE", options->scene,
                   std::string(kSceneHelp) +
                       ", or a capture: a folder of photographs with depth and their poses")
      ->required();
  command->add_option("--as", options->as, "What is made of it (default layered-impostor)")
      ->check(CLI::IsMember({"layered-impostor"}));
  add_layered_options(*command, options->bake, "--size");
  command
      ->add_option("--box", options->box,
                   "Of a capture: only what lies between two corners (default all)")
      ->delimiter(',')
      ->expected(6)
      ->check(finite())
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
  command->add_flag(
      "--around", options->around,
      "Of a capture: views around the box, as of a scene, instead of at its own cameras");
  command->add_option("-o,--output", options->output, "The file to write")
      ->required()
      ->type_name("FILE.exr");
  add_json_option(*command, options->json);
  add_file_limits(*command, options->limits);
  command->footer(
      "Example: rilievo bake model.glb --as layered-impostor --views 32 --size 256 -o model.exr\n"
      "         rilievo bake capture/ --box -1,-1,0,1,1,2 -o corner.exr\n"
      "         rilievo render model.exr --orbit 60 -o frames");
  return {command, [options](const std::string&) { return run(*options); }};
}

}  // namespace rilievo::app
