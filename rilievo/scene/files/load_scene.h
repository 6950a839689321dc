// Loads the scene of a file.
//
// Reads glTF 2.0 (.gltf, .glb), Wavefront OBJ, PLY and STL. The first bytes of a file decide its
// format; its name matters only where they are ambiguous. Files that a scene refers to (buffers,
// pictures, materials) are read from its own folder and those below it, each once; nothing is ever
// fetched from the network. A path that leads outside of that folder, after ".." and symbolic links
// are resolved, is refused unless LoadOptions::allow_outside is set.
//
// Bad input ends in an Error with a reason. No exception leaves these functions, and memory stays
// within LoadOptions::max_bytes. It also stays within 64 MiB + 32 times the bytes of the files +
// the decoded pixels, so that a small file costs little; the decompressed bytes of a mesh (Draco,
// meshoptimizer) count half as bytes of files. Messages name the options as the command line does.
// A part that cannot be loaded but can be left out without harm (a picture that cannot be decoded,
// an optional extension) is left out with a warning.
//
// How glTF maps to a Scene:
// - Each node with a mesh is one Object, and so is each of its GPU instances. Meshes are shared.
// - The first animation moves nodes. Skins and morph targets are posed once, at LoadOptions::time
//   (at other times: scene/bend.h); skinned objects then stand still in world space.
// - All lights are scaled by one factor so that they light the scene's centre as the default sun
//   would: exporters disagree about units by factors of 683 and 4 pi, and there is no exposure.
// - Transmission becomes blended alpha, and specular-glossiness metallic-roughness, with a warning.
//
// Coordinates far from 0 lose nothing: Scene::world has an origin for them (core/world_space.h).
//
// Points and lines are read from glTF, OBJ and PLY; a PLY file without faces and edges shows its
// vertices. In OBJ, PLY and STL, each named group is an Object; materials come from the .mtl file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rilievo/core/result.h"
#include "rilievo/scene/bend.h"
#include "rilievo/scene/point_size.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The parts to load, and the memory to use. Names beginning with -- are the command line's.
struct LoadOptions {
  double time = 0.0;  // seconds; skins and morph targets are posed at this time
  // --memory-limit-mb: limit on what loading allocates, including files and intermediate data.
  std::uint64_t max_bytes = std::uint64_t(4) << 30;
  // --allow-outside: permits files that lie neither in the scene's folder nor below it.
  bool allow_outside = false;
  // --point-size: how large points are drawn.
  PointSize point_size;
  // --up and --units: which axis of the file points up, and how long a unit is, where it is not as
  // usual: +y, metres. A file's numbers stay; the scene is turned and scaled.
  std::optional<UpAxis> up = {};
  std::optional<double> metres_per_unit = {};
  // Keeps what bends meshes, so that scene/bend.h can pose them at other times.
  bool deformations = false;
};

// A loaded scene, with what the user should know about it.
struct LoadedScene {
  Scene scene;                        // finished and valid; at least one object
  Deformations deformations;          // if they were asked for
  std::vector<std::string> warnings;  // at most ten lines; alike ones are folded
};

// Loads a file. Any thread.
[[nodiscard]] Result<LoadedScene> load_scene(const std::filesystem::path& path,
                                             const LoadOptions& options = {});

// Loads a file in memory. Errors name it `name`, whose extension decides the format where the bytes
// are ambiguous. No other file is read.
[[nodiscard]] Result<LoadedScene> load_scene(std::span<const std::uint8_t> bytes,
                                             const std::string& name,
                                             const LoadOptions& options = {});

}  // namespace rilievo
