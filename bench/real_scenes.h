// Scenes that benches walk through: such as users have, of others' models, with walks as people
// move; built-in ones; and files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/core/result.h"
#include "rilievo/scene/scene.h"

namespace rilievo::bench {

// Walks go there and back for so long: slow methods draw on until all frames are kept.
inline constexpr double kLongestWalk = 120;  // seconds

struct RealWalk {
  std::string name;
  CameraPath path;  // its times are those of the clock
};

// Made when it is its turn: some take gigabytes.
struct RealScene {
  std::string name;
  std::function<Result<Scene>()> make;
  std::function<std::vector<RealWalk>(const Scene&)> walks;
};

// Of a folder of models: 100 helmets with 15 textures, a grove of 64 trees with textured leaves, a
// town of 1200 buildings, vehicles and street parts, a cave and a gallery. Without a folder:
// helmets, grove and town of built-in models with made textures. `quick`: few copies.
[[nodiscard]] std::vector<RealScene> real_scenes(const std::filesystem::path& data, bool quick);
// A built-in scene, with its own path.
[[nodiscard]] RealScene builtin_scene(const std::string& name);
// The scenes that a bench is to walk through (BenchOptions::scenes): names of real_scenes() of
// RILIEVO_DATA, built-in scenes, and files, each with the walks that lie beside it as NAME-*.json,
// or an orbit; without any, all of real_scenes().
[[nodiscard]] std::vector<RealScene> bench_scenes(const BenchOptions& options);

// How copies are planted: on a square grid, each moved, turned and scaled a little.
struct PlantOptions {
  int count = 0;
  double spacing = 1;
  std::uint64_t seed = 1;
  double ground = 0;  // half the side of a ground plane; 0: none
};
// Copies of models, whose meshes, materials and textures are shared.
[[nodiscard]] Scene plant(std::span<const Scene> models, const PlantOptions& options);

}  // namespace rilievo::bench
