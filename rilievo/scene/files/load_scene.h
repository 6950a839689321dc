// Which scene does a file hold?
//
// glTF 2.0 (.gltf, .glb), Wavefront OBJ, PLY and STL. What a file is, its first bytes say; its name
// only where they leave it open. Files that a scene refers to (buffers, pictures, materials) are
// read from its own folder and those below it, each once; nothing is ever fetched from elsewhere.
// A path that leads outside of that folder, after ".." and symbolic links are resolved, is refused
// unless LoadOptions::allow_outside.
//
// Bad input ends in an Error with a reason: no exception leaves these functions, and memory stays
// within LoadOptions::max_bytes. It also stays within 64 MiB + 32 times the bytes of the files +
// the decoded pixels, so that a small file costs little; bytes that a compressed mesh (Draco,
// meshoptimizer) becomes count half as bytes of files. Messages call the options as the command
// line does. What a file asks for and cannot be had without harm to the rest (a picture that cannot
// be decoded, an optional extension) is left out with a warning.
//
// How glTF maps to a Scene:
//   - a node with a mesh is one Object, each of its GPU instances too; meshes are shared;
//   - the first animation moves nodes; skins and morph targets are posed once, at
//   LoadOptions::time,
//     and skinned objects then stand still in world space;
//   - lights are scaled together so that they light the scene's centre as the default sun would:
//     exporters disagree about units by factors of 683 and 4 pi, and there is no exposure to set;
//   - transmission becomes blended alpha, specular-glossiness becomes metallic-roughness
//   (warnings).
// OBJ, PLY, STL: every named group is an Object; materials are those of the .mtl file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "rilievo/core/result.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

struct LoadOptions {
  double time = 0.0;  // seconds: skins and morph targets are posed at this time
  // --memory-limit-mb: bound on what loading allocates, files and intermediate data included.
  std::uint64_t max_bytes = std::uint64_t(4) << 30;
  // --allow-outside: may a scene refer to files that do not lie in its own folder, or below it?
  bool allow_outside = false;
};

struct LoadedScene {
  Scene scene;  // finished and valid; at least one object
  std::vector<std::string> warnings;
};

// Any thread.
[[nodiscard]] Result<LoadedScene> load_scene(const std::filesystem::path& path,
                                             const LoadOptions& options = {});

// The same from memory. `name` stands for the path in errors, and its extension decides where the
// bytes do not; no other file is read.
[[nodiscard]] Result<LoadedScene> load_scene(std::span<const std::uint8_t> bytes,
                                             const std::string& name,
                                             const LoadOptions& options = {});

}  // namespace rilievo
