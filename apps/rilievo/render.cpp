// rilievo render SCENE -o DIR: draws the frames of a path into PNG files.

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "apps/rilievo/command.h"
#include "apps/rilievo/frame_options.h"
#include "apps/rilievo/methods.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "apps/rilievo/scene_file.h"
#include "rilievo/capture/frame_target.h"
#include "rilievo/gl/context.h"
#include "rilievo/io/png.h"

namespace rilievo::app {
namespace {

struct Options {
  std::string scene, output, method = "direct";
  FrameOptions frames;
  MethodOptions methods;
};

Result<> draw_frames(const Options& options, const FramePlan& plan, FrameSource& source) {
  Result<FrameTarget> target =
      FrameTarget::create(options.frames.width, options.frames.height, options.frames.samples);
  if (!target) return target.error();
  if (Result<> made = make_folder(options.output); !made) return made;
  Progress progress("frame");
  for (int frame = 0; frame < plan.frames; ++frame) {
    progress.show(frame, plan.frames);
    const double time = frame_time(plan.path, frame);
    const Camera camera = camera_at(plan.path, time, options.frames.width, options.frames.height);
    target->begin();
    if (Result<> drawn = source.draw(camera, time); !drawn) return drawn;
    target->resolve();
    const std::filesystem::path file =
        std::filesystem::path(options.output) / fmt::format("frame_{:05}.png", frame);
    if (Result<> saved = save_png(file, target->read()); !saved) return saved;
  }
  return Done{};
}

Result<> render(const Options& options) {
  const Result<OpenedScene> opened = open_scene(options.scene);
  if (!opened) return opened.error();
  const Result<FramePlan> plan = plan_frames(options.frames, *opened);
  if (!plan) return plan.error();
  const auto context = gl::Context::create();
  if (!context) return context.error();
  Result<SceneRenderer> renderer = SceneRenderer::create(opened->scene);
  if (!renderer) return renderer.error();
  const Result<std::unique_ptr<FrameSource>> source =
      make_source(options.method, options.methods, *renderer);
  if (!source) return source.error();
  return draw_frames(options, *plan, **source);
}

}  // namespace

Command render_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("render", "Draw the frames of a camera path");
  command->add_option("SCENE", options->scene, kSceneHelp)->required();
  command->add_option("-o,--output", options->output, "Folder for frame_00000.png ...")
      ->required()
      ->type_name("DIR");
  command->add_option("--method", options->method, "How the frames are drawn (default direct)")
      ->check(CLI::IsMember(method_names()));
  add_frame_options(*command, options->frames);
  add_method_options(*command, options->methods);
  command->footer("Example: rilievo render model.glb --orbit 60 --size 640x360 -o frames");
  return {command, [options] { return render(*options); }};
}

}  // namespace rilievo::app
