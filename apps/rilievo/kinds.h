// The options of the kinds of representation, made from the list of kinds.
//
// Kinds can share an option's name; it is added to a command once. Where a command has an option of
// that name itself, the kinds' option is called --view-NAME.
#pragma once

#include <CLI/CLI.hpp>

#include "rilievo/representation/kind_methods.h"

namespace rilievo::app {

void add_kind_options(CLI::App& command, KindOptionsOf which, KindOptions& options);

}  // namespace rilievo::app
