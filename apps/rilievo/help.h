// The help of commands with many options, completion for shells, and the manual page: all from the
// commands' own options.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace rilievo::app {

// Puts options that few need into groups of their own, by what they are of ("cache: ..."); --help
// shows the others and says how many more --help-all shows.
void group_options(CLI::App& command);
// Leaves only the options that --help shows.
void show_usual_options(CLI::App& app);

// A script that completes commands, options and their fixed values. `shell` is bash or zsh.
[[nodiscard]] std::string completion_script(const CLI::App& app, const std::string& shell);
// The manual page, in roff.
[[nodiscard]] std::string manual_page(const CLI::App& app, const std::string& version);

}  // namespace rilievo::app
