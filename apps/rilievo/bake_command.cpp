#include "apps/rilievo/bake_command.h"

#include "apps/rilievo/checks.h"
#include "rilievo/capture/shaders/software_shader.h"

namespace rilievo::app {

void add_source_options(CLI::App& command, BakeCommand& options) {
  command
      .add_option("--source", options.source.source,
                  "Of a scene: who takes the pictures: raster, rays, raytrace (shadows, "
                  "reflections), or exec:PROGRAM, a renderer that is started (default OpenGL, or "
                  "rays)")
      ->check(CLI::Validator(
          [](std::string& text) {
            const Result<> known = check_source(text);
            return known ? std::string() : known.error().message();
          },
          ""))
      ->type_name("SOURCE");
  command.add_option("--samples", options.source.samples, "Samples of a texel (default 4)")
      ->check(in_range(1, 4096))
      ->type_name("N");
  auto* only = command
                   .add_option("--only", options.source.only,
                               "Take pictures of this object alone, by its name in the scene, in "
                               "the light of all; may be repeated")
                   ->type_name("NAME")
                   ->allow_extra_args(false);
  command
      .add_option("--without", options.source.without,
                  "Leave this object out of the pictures, but not its shadow and its reflections, "
                  "if the source makes such; may be repeated")
      ->type_name("NAME")
      ->allow_extra_args(false)
      ->excludes(only);
  command
      .add_option("--noise", options.source.noise,
                  "exec:PROGRAM: a texel gets no more samples once its noise is below this, by the "
                  "program's own measure (Cycles': 0.1 is coarse, 0.01 fine)")
      ->check(in_range(1e-4, 1.0))
      ->type_name("E");
  command
      .add_option("--around-samples", options.source.around_samples,
                  "exec:PROGRAM, layered impostors and reliefs: samples of the pictures from all "
                  "around, which show what a view's own picture does not (default --samples)")
      ->check(in_range(1, 4096))
      ->type_name("N");
  command
      .add_option("--program-scene", options.source.program_scene,
                  "exec:PROGRAM: the file that the program opens instead of SCENE, whose surfaces "
                  "count: a room.blend beside its room.glb")
      ->type_name("FILE");
  command.add_flag("--axis-depth", options.axis_depth,
                   "exec:PROGRAM with a scene of its own: Z is the distance along the axis "
                   "(default: two small pictures tell)");
  command
      .add_option("--store", options.store,
                  "raytrace, exec:PROGRAM: keeps finished pictures, so that a bake that was ended "
                  "goes on (default OUTPUT.pictures)")
      ->type_name("FILE");
  command.add_flag("--preview", options.preview,
                   "raytrace, exec:PROGRAM: first a coarse result in the output's place, refined "
                   "three times");
  command
      .add_option_function<std::string>(
          "--progress",
          [&options](const std::string& how) { options.json_progress = how == "json"; },
          "line: on a terminal; json: lines of JSON on the error output (default line)")
      ->check(CLI::IsMember({"line", "json"}));
  command
      .add_option("--plan", options.plan,
                  "raytrace, exec:PROGRAM: write the bake's plan in pieces, and bake nothing; or "
                  "the plan of --piece and --join")
      ->type_name("FILE.json");
  command
      .add_option("--pieces", options.pieces,
                  "--plan, --slurm: so many pieces, at most one for each picture (default: as many "
                  "as take equally long to 20 %, by coarse pictures)")
      ->check(in_range(1, 1'000'000))
      ->type_name("N");
  command.add_option("--piece", options.piece, "Make this piece of --plan, from 0")
      ->check(in_range(0, 1'000'000))
      ->type_name("I");
  command.add_flag("--join", options.join, "Finish the bake from the pieces of --plan");
  command
      .add_option("--slurm", options.at_a_time,
                  "raytrace, exec:PROGRAM: Slurm makes the pieces, at most N at a time; waits, and "
                  "joins them")
      ->check(in_range(1, 1'000'000))
      ->type_name("N");
}

Result<BakeStep> step_of(const BakeCommand& command) {
  const bool piece = command.piece.has_value();
  const bool slow = is_slow_source(command.source.source);
  if (piece && command.join) return Error{"--piece", "excludes --join"};
  if (piece || command.join) {
    const std::string option = piece ? "--piece" : "--join";
    if (command.plan.empty()) return Error{option, "needs --plan FILE"};
    if (!command.scene.empty())
      return Error{"SCENE", "is what the plan says: leave it out with " + option};
    return piece ? BakeStep::piece : BakeStep::join;
  }
  if (command.scene.empty()) return Error{"SCENE", "is required"};
  if (command.output.empty()) return Error{"--output", "is required"};
  const auto only = [&](bool given, const char* option) -> Result<> {
    if (given && !slow) return Error{option, "is for --source raytrace and exec:PROGRAM"};
    return Done{};
  };
  for (const Result<>& good :
       {only(!command.plan.empty(), "--plan"), only(command.at_a_time.has_value(), "--slurm"),
        only(!command.store.empty(), "--store"), only(command.preview, "--preview")})
    if (!good) return good.error();
  const bool program = !program_named(command.source.source).empty();
  if (!program && !command.source.program_scene.empty())
    return Error{"--program-scene", "is for --source exec:PROGRAM"};
  if (!program && command.source.noise > 0)
    return Error{"--noise", "is for --source exec:PROGRAM: others give all texels all samples"};
  if (!program && command.source.around_samples > 0)
    return Error{"--around-samples", "is for --source exec:PROGRAM"};
  if (!program && command.axis_depth) return Error{"--axis-depth", "is for --source exec:PROGRAM"};
  if (command.axis_depth && command.ray_depth) return Error{"--axis-depth", "excludes --ray-depth"};
  if (command.pieces && !command.at_a_time && command.plan.empty())
    return Error{"--pieces", "is for --plan and --slurm"};
  if (command.at_a_time) return BakeStep::slurm;
  return command.plan.empty() ? BakeStep::whole : BakeStep::plan;
}

}  // namespace rilievo::app
