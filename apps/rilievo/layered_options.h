// The options that say how layered impostors are baked.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "rilievo/core/result.h"
#include "rilievo/layered_impostor/gl/bake_layered.h"

namespace rilievo::app {

struct LayeredBakeOptions {
  int views = 32;
  bool hemisphere = false;
  int ring = 0;  // views; 0: none
  int size = 256;
  int layers = 64;
  float overlap = 0;
};

// `size_name` is what the size of the pictures is called where --size is that of the frames.
void add_layered_options(CLI::App& command, LayeredBakeOptions& options,
                         const std::string& size_name);

// The error says which of the options do not go together.
[[nodiscard]] Result<BakeOptions> bake_options(const LayeredBakeOptions& options);

}  // namespace rilievo::app
