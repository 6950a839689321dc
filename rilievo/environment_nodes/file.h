// How are environment nodes stored in a file?
//
// As their pictures (io/exr.h): each face is a part of an OpenEXR file, six parts for each node, in
// the order +x -x +y -y +z -z. These string attributes make them nodes:
//   rilievo.file.representation   "environment-nodes"
//   rilievo.file.mesh             "TRIANGLES ERROR_PX REACH": the budget or 0, pixels, metres or 0
// Meshes follow from the pictures and are computed on loading.
#pragma once

#include <filesystem>

#include "rilievo/core/world_space.h"
#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/io/exr.h"

namespace rilievo {

// Saves nodes. Colours are rounded to half precision (io/exr.h).
[[nodiscard]] Result<> save_environment_nodes(const std::filesystem::path& path,
                                              const EnvironmentNodes& nodes,
                                              const WorldSpace& world = {});

// Do the attributes say that the pictures are environment nodes?
[[nodiscard]] bool matches_environment_nodes(const FileAttributes& attributes);

// Opens a file. Reads every face once to find damage, one node at a time; the pictures stay in the
// file. The error names the file, the face and the reason.
[[nodiscard]] Result<EnvironmentNodes> open_environment_nodes(const std::filesystem::path& path);

}  // namespace rilievo
