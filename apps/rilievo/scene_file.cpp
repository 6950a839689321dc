#include "apps/rilievo/scene_file.h"

#include <map>

#include "apps/rilievo/output.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo::app {

void add_file_limits(CLI::App& command, FileLimits& limits) {
  command
      .add_option("--memory-limit-mb", limits.memory_mb,
                  "Limit on the memory for reading a scene's files (default 4096)")
      ->check(CLI::Range(1, 1 << 20))
      ->type_name("MB");
  command.add_flag("--allow-outside", limits.allow_outside,
                   "Permit a scene to refer to files outside of its folder");
  command
      .add_option_function<std::string>(
          "--point-size",
          [&limits](const std::string& text) { limits.point_size = *parse_point_size(text); },
          "Diameter of points: in the scene's units (0.02), in pixels (2px), or auto: what closes "
          "a surface of them (default)")
      ->check([](const std::string& text) {
        return parse_point_size(text) ? std::string()
                                      : "'" + text + "' is no size such as 0.02, 2px or auto";
      })
      ->type_name("SIZE");
  command
      .add_option("--up", limits.up,
                  "Which axis of a scene's file points up (default y, as glTF has it)")
      ->transform(
          CLI::CheckedTransformer(
              std::map<std::string, UpAxis>{{"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}},
              CLI::ignore_case)
              .description("{x,y,z}"))
      ->type_name("AXIS");
  command
      .add_option("--units", limits.metres_per_unit,
                  "What a scene's file counts in (default m, as glTF does)")
      ->transform(CLI::CheckedTransformer(
                      std::map<std::string, double>{
                          {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"ft", 0.3048}, {"in", 0.0254}},
                      CLI::ignore_case)
                      .description("{m,cm,mm,ft,in}"))
      ->type_name("UNIT");
}

Result<> expect_no_units(const std::string& text, const FileLimits& limits) {
  if (limits.up) return Error{"--up", "is for files of scenes, which " + text + " is not"};
  if (limits.metres_per_unit)
    return Error{"--units", "is for files of scenes, which " + text + " is not"};
  return Done{};
}

Result<OpenedScene> open_scene(const std::string& text, const FileLimits& limits, double time,
                               bool deformations) {
  if (is_builtin(text)) {
    if (Result<> good = expect_no_units(text, limits); !good) return good.error();
    Result<BuiltinScene> built = make_builtin(text);
    if (!built) return built.error();
    return OpenedScene{std::move(built->scene), {}, std::move(built->path)};
  }
  Result<LoadedScene> loaded = load_scene(text, {.time = time,
                                                 .max_bytes = limits.bytes(),
                                                 .allow_outside = limits.allow_outside,
                                                 .point_size = limits.point_size,
                                                 .up = limits.up,
                                                 .metres_per_unit = limits.metres_per_unit,
                                                 .deformations = deformations});
  if (!loaded) return loaded.error();
  for (const std::string& warning : loaded->warnings) complain(text + ": warning: " + warning);
  return OpenedScene{std::move(loaded->scene), std::move(loaded->deformations), {}};
}

}  // namespace rilievo::app
