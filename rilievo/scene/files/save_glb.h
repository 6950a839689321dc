// Saves a scene as a file that other programs open.
//
// Binary glTF 2.0 (.glb), one file: meshes, materials, textures (PNG), nodes with their animation,
// lights, cameras. The loaded file draws the same frames at any time. It differs in this:
// - Objects can come back in another order. Static instances of one model become instances of one
//   node (EXT_mesh_gpu_instancing) and lose their names.
// - A part that its model places by a matrix is written in the model's space.
// - A scene with an origin (core/world_space.h) hangs below a node that has it.
// - Glass (KHR_materials_transmission) keeps its alpha, and loses its transmission and its index of
//   refraction, which only rays show.
// - Cameras whose axis does not pass through the image's centre, back-perspective cameras and the
//   sky are left out, because glTF cannot express them.
#pragma once

#include <filesystem>

#include "rilievo/core/result.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// Saves a scene. The file is replaced at once or not at all. Fails for invalid scenes, and for
// files of 4 GiB or more, which the format cannot hold.
[[nodiscard]] Result<> save_glb(const Scene& scene, const std::filesystem::path& path);

}  // namespace rilievo
