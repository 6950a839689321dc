// The options of the drawing methods on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "apps/rilievo/impostors.h"
#include "apps/rilievo/kinds.h"
#include "rilievo/method/method.h"

namespace rilievo::app {

// The library's options, and who draws.
struct MethodOptions : rilievo::MethodOptions {
  std::string draw = "automatic";  // opengl, software; automatic: as is faster here
};

void add_method_options(CLI::App& command, MethodOptions& options);
// --capture-ms T, --late X and --max-spike X. `of` begins the help: "cache".
void add_budget_options(CLI::App& command, const std::string& of, double& capture_ms, double& late,
                        double& max_spike);

}  // namespace rilievo::app
