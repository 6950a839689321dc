// What does drawing take on a machine, on the command line: measured, shown, stored and used.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "rilievo/cache/prices/machine_costs.h"

namespace rilievo::app {

// Measures this machine, with OpenGL if there is one, and prints the costs; or writes them to
// `json`, if it is not empty, as --machine reads them.
[[nodiscard]] Result<> describe_machine(const std::string& json);

// --machine FILE. `of` begins the help: "cache".
void add_machine_option(CLI::App& command, const std::string& of,
                        std::optional<MachineCosts>& costs);

}  // namespace rilievo::app
