// How does a scene become a file that other programs open?
//
// glTF 2.0, binary (.glb), everything in one file: meshes, materials, textures (PNG), nodes with
// their animation, lights, cameras. What loading makes of the file draws the same frames at any
// time. Differences that remain:
//   - objects may come back in another order, and those of a model that stands still in many places
//     become instances of one node (EXT_mesh_gpu_instancing) and lose their names;
//   - a part that a model places by a matrix is written in the model's space;
//   - cameras whose axis does not pass through the image's centre, and back-perspective ones, are
//     left out, as is the sky: glTF has no words for them.
#pragma once

#include <filesystem>

#include "rilievo/core/result.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// Replaces the file at once or not at all. Refuses scenes that are not valid, and files of 4 GiB or
// more, which the format cannot hold.
[[nodiscard]] Result<> save_glb(const Scene& scene, const std::filesystem::path& path);

}  // namespace rilievo
