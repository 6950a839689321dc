// The options of --method relief-impostor.
#pragma once

#include <CLI/CLI.hpp>

#include "rilievo/method/method.h"

namespace rilievo::app {

void add_impostor_options(CLI::App& command, ReliefImpostorOptions& options);

}  // namespace rilievo::app
