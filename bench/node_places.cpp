// How many nodes hold all that can be seen, placed by worth and on a grid.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "bench/benches.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/environment_nodes/bake_nodes.h"
#include "rilievo/environment_nodes/placement.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo::bench {
namespace {

constexpr double kEnough = 0.99;

// Nodes in the middles of cells of the region, `across` of them along its longest side; cells are
// cubes where they can be.
std::vector<glm::dvec3> grid_of(const Box& region, int across) {
  const glm::vec3 extent = region.extent();
  const float cell = std::max({extent.x, extent.y, extent.z}) / float(across);
  glm::ivec3 count;
  for (int k = 0; k < 3; ++k) count[k] = std::max(1, int(std::lround(extent[k] / cell)));
  std::vector<glm::dvec3> eyes;
  for (int z = 0; z < count.z; ++z)
    for (int y = 0; y < count.y; ++y)
      for (int x = 0; x < count.x; ++x)
        eyes.emplace_back(glm::vec3(region.min) +
                          extent * (glm::vec3(x, y, z) + 0.5f) / glm::vec3(count));
  return eyes;
}

struct Found {
  std::size_t nodes = 0;  // 0: not reached
  double share = 0;       // held, by those, or by the most that were tried
};

std::string text_of(const Found& found, std::size_t most) {
  return found.nodes > 0 ? std::to_string(found.nodes)
                         : fmt::format("not by {} ({:.2f} %)", most, 100 * found.share);
}

}  // namespace

Result<BenchReport> node_places(const BenchOptions& options) {
  const std::size_t most = options.quick ? 3 : 64;
  std::vector<std::string> names{options.quick ? "builtin:stonehenge?triangles=10000"
                                               : "builtin:stonehenge"};
  names.insert(names.end(), options.scenes.begin(), options.scenes.end());
  BenchReport report;
  Table table{"Nodes that hold 99 % of what is seen from the region",
              {"scene", "placed", "on a grid", "held by 4 placed %", "seconds to place"},
              {}};
  int done = 0;
  for (const std::string& name : names) {
    Scene scene;
    if (name.starts_with("builtin:")) {
      Result<BuiltinScene> made = make_builtin(name);
      if (!made) return made.error();
      scene = std::move(made->scene);
    } else {
      Result<LoadedScene> loaded = load_scene(name);
      if (!loaded) return loaded.error();
      scene = std::move(loaded->scene);
    }
    const Result<RayScene> rays = RayScene::create(scene);
    if (!rays) return rays.error();
    PlacementOptions placement;
    placement.region = usual_region(world_bounds(scene));
    placement.nodes = int(most);
    placement.enough = 0.9995;
    if (options.quick) placement.candidates = 20, placement.eyes = 20, placement.rays = 50;
    const Stopwatch watch;
    const Result<Placement> placed = place_nodes(*rays, placement);
    if (!placed) return Error{name, placed.error().reason};
    const double seconds = watch.ms() / 1000;
    // Judged by rays of which neither knew.
    PlacementOptions judge = placement;
    judge.seed = 77;
    judge.eyes = judge.rays = options.quick ? 50 : 300;
    const auto held = [&](std::vector<glm::dvec3> eyes, std::size_t first) {
      eyes.resize(std::min(first, eyes.size()));
      const Result<double> share = share_held(*rays, judge, eyes);
      return share ? *share : 0.0;
    };
    Found ours, grid;
    // What nodes hold grows with their number.
    std::size_t low = 0, high = placed->eyes.size();
    ours.share = held(placed->eyes, high);
    if (ours.share >= kEnough) {
      while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (held(placed->eyes, middle) >= kEnough ? high : low) = middle;
      }
      ours = {high, held(placed->eyes, high)};
    }
    std::size_t tried = 0;
    for (int across = 1; tried < 2 * most && grid.nodes == 0; ++across) {
      const std::vector<glm::dvec3> eyes = grid_of(placement.region, across);
      if (eyes.size() > 4 * most) break;
      if (eyes.size() == tried) continue;
      tried = eyes.size();
      const double share = held(eyes, tried);
      grid.share = std::max(grid.share, share);
      if (share >= kEnough) grid = {tried, share};
    }
    const double by_four = held(placed->eyes, 4);
    std::string stem = name.substr(name.find_last_of("/:") + 1);
    stem = stem.substr(0, stem.find_first_of(".?"));
    for (char& c : stem)
      if (c == '-') c = '_';
    report.figures.emplace_back("nodes_for_99_placed_" + stem, double(ours.nodes));
    report.figures.emplace_back("nodes_for_99_grid_" + stem, double(grid.nodes));
    report.figures.emplace_back("held_by_4_" + stem, by_four);
    table.rows.push_back({stem, text_of(ours, placed->eyes.size()), text_of(grid, tried),
                          fmt::format("{:.2f}", 100 * by_four), fmt::format("{:.1f}", seconds)});
    if (options.progress) options.progress(++done, int(names.size()));
  }
  report.tables.push_back(std::move(table));
  report.notes = {
      "The region: the middle 60 % of the scene's bounds, at a person's height where there is "
      "room. "
      "What is seen: 100 rays from each of 500 eyes in it; judged by 300 rays from each of 300 "
      "others. A node holds what it sees at no less than 3 degrees, or at the angle of the eye "
      "that saw it.",
      "0 nodes: the share was not reached."};
  return report;
}

}  // namespace rilievo::bench
