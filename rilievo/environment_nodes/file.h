// How are environment nodes kept in a file?
//
// As their pictures (io/exr.h): one part of an OpenEXR file a face, six parts a node, in the order
// +x -x +y -y +z -z. What makes nodes of them are string attributes:
//   rilievo.file.representation   "environment-nodes"
//   rilievo.file.mesh             "TRIANGLES ERROR_PX REACH": the budget or 0, pixels, metres or 0
// Meshes follow from the pictures and are made again on loading.
#pragma once

#include <filesystem>

#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/io/exr.h"

namespace rilievo {

// Colours are rounded to halfs (io/exr.h).
[[nodiscard]] Result<> save_environment_nodes(const std::filesystem::path& path,
                                              const EnvironmentNodes& nodes);

[[nodiscard]] bool says_environment_nodes(const FileAttributes& attributes);

// Reads every face once, so that what is damaged is found, but one node at a time: the pictures
// stay in the file. The error names the file, the face and what is wrong with it.
[[nodiscard]] Result<EnvironmentNodes> open_environment_nodes(const std::filesystem::path& path);

}  // namespace rilievo
