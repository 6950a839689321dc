// What `rilievo bake` was asked for.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "apps/rilievo/bake_source.h"
#include "apps/rilievo/scene_file.h"
#include "rilievo/representation/kind_methods.h"

namespace rilievo::app {

struct BakeCommand {
  std::string scene, output, json, as{default_kind().name};
  double fov_degrees = 0;   // of a deep image that does not say; 0: not given
  bool ray_depth = false;   // of a deep image or a program: Z is along the line of sight
  bool axis_depth = false;  // of a program: Z is along the axis
  KindOptions kinds;
  FileLimits limits;
  SourceOptions source;
  std::string store;             // of finished pictures; empty: beside the output
  bool preview = false;          // coarse walks first
  bool json_progress = false;    // lines of JSON
  std::string counted = "view";  // what progress counts
  // In pieces:
  std::string plan;              // the file of the plan
  std::optional<int> pieces;     // how many, at most; none: as many as are even
  std::optional<int> piece;      // the one to make
  bool join = false;             // finish, from the pieces
  std::optional<int> at_a_time;  // by Slurm, so many pieces
};

// --source and what belongs to it.
void add_source_options(CLI::App& command, BakeCommand& options);

// What a bake of the pieces of `plan` comes to.
enum class BakeStep { whole, plan, piece, join, slurm };
// The error names the option that does not go with the others.
[[nodiscard]] Result<BakeStep> step_of(const BakeCommand& command);

}  // namespace rilievo::app
