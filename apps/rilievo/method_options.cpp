#include "apps/rilievo/method_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/rilievo/checks.h"
#include "apps/rilievo/machine.h"
#include "rilievo/representation/kinds.h"

namespace rilievo::app {
namespace {

std::vector<std::string_view> surroundings_kinds() {
  std::vector<std::string_view> names;
  for (const Kind* kind : kinds())
    if (kind->stands_for == StandsFor::surroundings) names.push_back(kind->name);
  return names;
}

}  // namespace

void add_budget_options(CLI::App& command, const std::string& of, double& capture_ms, double& late,
                        double& max_spike) {
  command
      .add_option(
          "--capture-ms", capture_ms,
          of + ": time for captures beside the frame, in ms, which does not wait for them; "
               "what is late is drawn with a larger error (default: captures are part of the "
               "frame, within a budget of triangles, which makes runs repeatable)")
      ->check(in_range(0.1, 1000.0))
      ->type_name("T");
  command
      .add_option("--late", late,
                  fmt::format("{}: with --capture-ms, how many times their limits the errors and "
                              "gaps of what is late may be (1: nothing is late, but more of a "
                              "frame is coarse; default {:g})",
                              of, late))
      ->check(in_range(1.0, 100.0))
      ->type_name("X");
  command
      .add_option("--max-spike", max_spike,
                  fmt::format("{}: how many times as much as the frames before one may cost, "
                              "by the costs of --machine; after a cut, what costs more is coarse "
                              "for some frames, with a larger error (0: no limit; default {:g})",
                              of, max_spike))
      ->check(in_range(0.0, 1000.0))
      ->type_name("X");
}

void add_method_options(CLI::App& command, MethodOptions& options) {
  command
      .add_option("--delta-bits", options.delta_bits,
                  "Bits of a picture's depth (Delta) per texel (default 8)")
      ->check(CLI::IsMember({2, 4, 6, 8, 16}));
  command
      .add_option_function<std::string>(
          "--depth",
          [&options](const std::string& depth) {
            options.depth_mode = depth == "linear" ? DepthMode::linear : DepthMode::exact;
          },
          "How nailboards write depth (default exact)")
      ->check(CLI::IsMember({"exact", "linear"}));
  command.add_flag("--outlines", options.outlines,
                   "Outline everything that is drawn from a picture");
  command
      .add_option(
          "--draw", options.draw,
          "What draws the frames: opengl, software (without OpenGL), or automatic: whichever is "
          "faster at polygons here, by --machine or measured first; OpenGL still draws direct, and "
          "kinds, which it bakes of a scene (default)")
      ->check(CLI::IsMember({"opengl", "software", "automatic"}));
  command
      .add_option(
          "--angle", options.angle_degrees,
          "flat, nailboard: capture a picture again after its object has moved by this angle, as "
          "seen from the eye (default 0.7)")
      ->check(in_range(0.0, 90.0))
      ->type_name("DEGREES");
  command
      .add_option("--memory-mb", options.memory_mb,
                  "Limit on the memory for pictures (default 256)")
      ->check(in_range(1, 65536))
      ->type_name("MB");
  command
      .add_option("--error-px", options.error_px,
                  "cache, lod, auto: the largest position error of a picture or a level, in pixels "
                  "(default 1)")
      ->check(in_range(0.01, 100.0))
      ->type_name("E");
  command
      .add_option(
          "--gap-px", options.gap_px,
          "cache: the largest width of a gap where a surface was hidden at capture, in pixels "
          "(default twice --error-px); keyframes: rays look for hidden surfaces where gaps may be "
          "wider (default 4; at least 1)")
      ->check(in_range(0.01, 1e6))
      ->type_name("E");
  add_budget_options(command, "cache", options.capture_ms, options.late, options.max_spike);
  command
      .add_option(
          "--bake-mb", options.bake_mb,
          "cache: the part of --memory-mb for representations of heavy objects (--bake-as), baked "
          "before the first frame; they carry the light of the bake along (default 0)")
      ->check(in_range(0, 65536))
      ->type_name("MB");
  add_machine_option(command, "cache", options.machine);
  command.add_flag("--levels", options.levels,
                   "cache without OpenGL: draw and capture objects that stand still by levels of "
                   "detail, whose bounded error is part of --error-px");
  command.add_flag("--bake-together", options.bake_together,
                   "cache: bake all objects that stand still as one, a thing of many parts");
  command.add_flag("!--no-fade", options.fade, "cache: new pictures replace old ones at once");
  command
      .add_option("--texel-px", options.texel_px,
                  "Baked kinds: draw an object as polygons if its texels would be larger than this "
                  "(default 4)")
      ->check(in_range(0.01, 10000.0))
      ->type_name("PIXELS");
  command
      .add_option("--bake-as", options.bake_as,
                  fmt::format("cache: the kinds to bake into --bake-mb (default {})",
                              fmt::join(options.bake_as, ",")))
      ->delimiter(',')
      ->check(CLI::Validator(
          [](std::string& name) {
            return kind_method(name).kind
                       ? std::string()
                       : fmt::format("'{}' is no kind: {}", name, fmt::join(kind_names(), ", "));
          },
          ""))
      ->type_name("A,B,...");
  command
      .add_option("--bake-beyond", options.bake_beyond,
                  fmt::format("cache: kinds of surroundings ({}) stand for what lies farther from "
                              "the path than this (default a tenth of the scene's radius)",
                              fmt::join(surroundings_kinds(), ", ")))
      ->check(in_range(0.0, 1e9))
      ->type_name("METRES");
  command
      .add_option(
          "--source", options.source,
          "keyframes: who makes them: raster, rays, raytrace or exec:PROGRAM (default raster); "
          "where frames go by the clock the last two work beside them, after coarse ones by rays")
      ->type_name("SOURCE");
  command
      .add_option(
          "--program-scene", options.program_scene,
          "keyframes: what the program of --source exec:PROGRAM opens instead of SCENE, such "
          "as room.blend")
      ->type_name("FILE");
  command
      .add_option("--keyframe-ms", options.keyframe_ms,
                  "keyframes: time that a frame spends on the next keyframe, in ms, and more where "
                  "holes take more; after a jump a coarse one is made first (default: view "
                  "and --real-time 8, or three eighths of a frame; else a sixteenth of a keyframe, "
                  "which makes runs repeatable)")
      ->check(in_range(0.1, 1000.0))
      ->type_name("T");
  command
      .add_option("--keyframe-samples", options.keyframe_samples,
                  "keyframes: samples of a texel (default 4)")
      ->check(CLI::IsMember({1, 4, 16}));
  command
      .add_option("--fps", options.fps,
                  fmt::format("auto: frames a second that are enough: of all methods that keep it "
                              "the best in quality draws (0: as many as can be; default {:g})",
                              options.fps))
      ->check(in_range(0.0, 1000.0))
      ->type_name("N");
  command
      .add_option("--loss-db", options.loss_db,
                  "auto: how much farther than direct drawing frames may be from what is true, in "
                  "dB; up to twice as much where the cache's are (default 4)")
      ->check(in_range(0.0, 100.0))
      ->type_name("DB");
  command.add_flag(
      "--by-clock", options.by_clock,
      "auto: decide by the time that frames take, which makes no two runs alike (view, "
      "and compare --real-time, do), and not by counts of work; keyframes by raytrace and exec: "
      "are made beside the frames, which wait for them otherwise");
  add_impostor_options(command, options.impostors);
  add_set_option(command, options.kinds);
}

}  // namespace rilievo::app
