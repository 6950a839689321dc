// Which sub-commands are there? Each adds its options to the parser and runs if it was chosen.
//
// Exit codes: 0 success; 2 bad usage, bad input or lost output, with one line
// `rilievo: WHERE: reason` on the error output; 1 an error of the program itself.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "rilievo/core/result.h"

namespace rilievo::app {

struct Command {
  CLI::App* parser = nullptr;
  // `command_line` is what was typed, for reports that say how to do it again.
  std::function<Result<>(const std::string& command_line)> run;
};

[[nodiscard]] Command info_command(CLI::App& app);
[[nodiscard]] Command scene_command(CLI::App& app);
[[nodiscard]] Command bake_command(CLI::App& app);
[[nodiscard]] Command export_command(CLI::App& app);
[[nodiscard]] Command web_command(CLI::App& app);
[[nodiscard]] Command serve_command(CLI::App& app);
[[nodiscard]] Command render_command(CLI::App& app);
[[nodiscard]] Command compare_command(CLI::App& app);
[[nodiscard]] Command bench_command(CLI::App& app);
#ifdef RILIEVO_VIEWER
[[nodiscard]] Command view_command(CLI::App& app);
#endif

}  // namespace rilievo::app
