// Which options do the drawing methods take on the command line?
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apps/rilievo/impostors.h"
#include "apps/rilievo/kinds.h"
#include "rilievo/cache/machine_costs.h"
#include "rilievo/cache/policy.h"
#include "rilievo/core/picture_geometry.h"

namespace rilievo::app {

inline constexpr std::size_t kMegabyte = std::size_t(1) << 20;

struct MethodOptions {
  std::string draw = "automatic";  // opengl, software; automatic: as is faster here
  int delta_bits = 8;
  std::string depth = "exact";
  bool outlines = false;
  double angle_degrees = 0.7;  // flat, nailboard
  int memory_mb = 256;
  double error_px = 1;                // cache
  double gap_px = 0;                  // cache; 0: twice error_px
  bool levels = false;                // cache, without OpenGL: levels of detail
  double capture_ms = 0;              // cache; 0: a budget by triangles
  double late = CacheOptions{}.late;  // cache, with capture_ms
  double max_spike = 0;               // cache; 0: no limit
  bool fade = true;                   // cache
  int bake_mb = 0;                    // cache; 0: bakes nothing
  std::vector<std::string> bake_as{
      std::string(default_kind().name)};  // cache: kinds that are baked
  std::optional<double> bake_beyond;      // cache: metres
  bool bake_together = false;             // cache: all that stands still as one
  double texel_px = 4;                    // kinds drawn for objects
  KindOptions kinds;
  ImpostorOptions impostors;                 // relief-impostor
  Box eyes = {};                             // where eyes will be; empty: not known
  std::optional<MachineCosts> machine = {};  // cache; none: the costs built in
};

void add_method_options(CLI::App& command, MethodOptions& options);
// --capture-ms T, --late X and --max-spike X. `of` begins the help: "cache".
void add_budget_options(CLI::App& command, const std::string& of, double& capture_ms, double& late,
                        double& max_spike);

// Of nailboards: --depth.
[[nodiscard]] DepthMode depth_mode(const MethodOptions& options);

}  // namespace rilievo::app
