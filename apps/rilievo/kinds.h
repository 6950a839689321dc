// The options of the kinds of representation, made from the list of kinds.
//
// Commands that bake one kind have them by name. Kinds can share an option's name; it is added to a
// command once. Commands that draw any kind have one option for all: --set KIND.NAME=VALUE.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "rilievo/representation/kind_methods.h"

namespace rilievo::app {

void add_kind_options(CLI::App& command, KindOptionsOf which, KindOptions& options);

// --set. `options` outlives the command.
void add_set_option(CLI::App& command, KindOptions& options);
// All that --set takes: KIND.NAME.
[[nodiscard]] std::vector<std::string> set_names();
// `rilievo info --kinds`: prints all kinds with their options, or writes them as JSON.
[[nodiscard]] Result<> list_kinds(const std::string& json_file);

}  // namespace rilievo::app
