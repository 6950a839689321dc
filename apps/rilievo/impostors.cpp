#include "apps/rilievo/impostors.h"

#include "apps/rilievo/checks.h"
#include "apps/rilievo/output.h"
#include "rilievo/cache/gl/impostor_frames.h"
#include "rilievo/frame/software/software_chosen_frames.h"
#include "rilievo/nailboard/software/software_boards.h"

namespace rilievo::app {

void add_impostor_options(CLI::App& command, ImpostorOptions& options) {
  command
      .add_option("--shader", options.shader,
                  "relief-impostor: who shades the pictures: raytrace, sdf:torus, sdf:gyroid, "
                  "sdf:menger, or exec:PROGRAM, which is started (default raytrace)")
      ->check(CLI::Validator(
          [](std::string& text) {
            const Result<> known = check_shader(text);
            return known ? std::string() : known.error().message();
          },
          ""))
      ->type_name("SHADER");
  command
      .add_option("--objects", options.objects,
                  "relief-impostor: the objects that are impostors, by name, or #0, #1, ... "
                  "(default all)")
      ->delimiter(',')
      ->type_name("NAME,...");
  command
      .add_option("--workers", options.workers,
                  "relief-impostor: threads that render pictures (default 1)")
      ->check(in_range(1, 64))
      ->type_name("N");
  command
      .add_option("--store", options.store,
                  "relief-impostor: a file that keeps finished pictures, searched before anything "
                  "is rendered; made if it is not there")
      ->type_name("FILE");
  command
      .add_option("--store-mb", options.store_mb,
                  "relief-impostor: the size of the store; the pictures used least recently go "
                  "first (default 4096)")
      ->check(in_range(1, 1 << 20))
      ->type_name("MB");
  command
      .add_option(
          "--impostor-texels", options.texels,
          "relief-impostor: the most texels a side of a picture, which otherwise has one for "
          "each pixel (default 1024)")
      ->check(in_range(16, 1024))
      ->type_name("N");
  command
      .add_option("--impostor-samples", options.samples,
                  "relief-impostor: samples a texel (default 4)")
      ->check(in_range(1, 4096))
      ->type_name("N");
}

namespace {

// How far programs that shade in the background give way to frames, as of nice(1).
constexpr int kGiveWay = 10;

Result<ImpostorContent> make_content(const ImpostorOptions& options, const Scene& scene) {
  const auto warn = [](const std::string& text) { complain("warning: " + text); };
  ImpostorContentOptions with;
  with.shader = options.shader;
  with.objects = options.objects;
  with.workers = options.workers;
  with.store = options.store;
  with.store_options.max_bytes = std::uint64_t(options.store_mb) << 20;
  with.exec.warn = warn;
  if (options.background) with.exec.nice = kGiveWay;
  with.warn = warn;
  with.deformations = options.deformations;
  return make_impostor_content(scene, 0.0, with);
}

ImpostorFramesOptions frames_options(const ImpostorOptions& options, bool outlines) {
  ImpostorFramesOptions frames;
  frames.workers.size = options.texels;
  frames.workers.samples = options.samples;
  frames.background = options.background;
  frames.workers.gives_way = options.background;
  frames.outlines = outlines;
  return frames;
}

}  // namespace

Result<std::unique_ptr<FrameSource>> make_impostor_frames(const ImpostorOptions& options,
                                                          bool outlines, SceneRenderer& renderer) {
  Result<ImpostorContent> content = make_content(options, renderer.scene());
  if (!content) return content.error();
  renderer.set_time(0.0);
  Result<std::unique_ptr<ImpostorFrames>> made =
      ImpostorFrames::create(renderer, std::move(*content), frames_options(options, outlines));
  if (!made) return made.error();
  return {std::move(*made)};
}

Result<std::unique_ptr<FrameSource>> make_software_impostor_frames(const ImpostorOptions& options,
                                                                   bool outlines, int samples,
                                                                   const Scene& scene) {
  Result<ImpostorContent> content = make_content(options, scene);
  if (!content) return content.error();
  Result<std::unique_ptr<SoftwareChosenFrames>> made = SoftwareChosenFrames::create(
      scene, samples, outlines,
      [&](const PlacedScene& placed) -> Result<std::unique_ptr<FrameChooser>> {
        return {std::make_unique<ImpostorChooser>(placed, std::make_unique<SoftwareBoards>(),
                                                  std::move(*content),
                                                  frames_options(options, outlines))};
      },
      options.deformations);
  if (!made) return made.error();
  return {std::move(*made)};
}

}  // namespace rilievo::app
