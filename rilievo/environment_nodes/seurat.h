// How are captures for Google's Seurat read and written as pictures with depth, and as nodes?
//
// manifest.json contains view groups, each with some views from about one point. A view has a
// camera (image size, clip_from_eye_matrix and world_from_eye_matrix row by row, OpenGL's axes) and
// two images, OpenEXR or PNG, with the names of the channels for colour, alpha and depth. Depth is
//   WINDOW_Z   of the camera's own planes, in [0, 1]
//   EYE_Z      distance along the optical axis
//   RAY_DEPTH  distance along the line of sight
// A texel shows nothing if its depth is not positive and finite, or if its alpha is 0. Colours are
// linear in OpenEXR and sRGB in PNG. Matrices that are rigid up to 1 % are rounded to the nearest
// rigid motion; others are refused, and so are matrices that are no projection.
#pragma once

#include <filesystem>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"

namespace rilievo {

// A capture.
struct SeuratCapture {
  glm::dvec3 headbox_center{0.0};
  std::vector<std::vector<DepthImage>> groups;  // at least one, each with at least one view
};

// Loads a capture. `path` is the manifest or the folder of manifest.json. The error names the file
// and the reason. `allow_outside` permits images outside the manifest's folder.
[[nodiscard]] Result<SeuratCapture> load_seurat_capture(const std::filesystem::path& path,
                                                        bool allow_outside = false);

}  // namespace rilievo
