// How are captures for Google's Seurat read and written as pictures with depth, and as nodes?
//
// manifest.json: view groups, each some views from about one point. A view has a camera (image
// size, clip_from_eye_matrix and world_from_eye_matrix row by row, OpenGL's axes) and two images,
// OpenEXR or PNG, with the names of the channels that hold colour, alpha and depth. Depth is
//   WINDOW_Z   of the camera's own planes, in [0, 1]
//   EYE_Z      distance along the optical axis
//   RAY_DEPTH  distance along the line of sight
// and where it is not a positive finite number, or alpha is 0, a texel shows nothing. Colours of
// OpenEXR are linear, of PNG sRGB. Matrices that are rigid up to 1 % are rounded to the nearest
// rigid motion; all others, and lenses that are no projection, are refused.
#pragma once

#include <filesystem>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"

namespace rilievo {

struct SeuratCapture {
  glm::dvec3 headbox_center{0.0};
  std::vector<std::vector<DepthImage>> groups;  // at least one, of at least one view
};

// `path` is the manifest, or a folder that holds manifest.json. The error names the file and what
// is wrong with it.
[[nodiscard]] Result<SeuratCapture> load_seurat_capture(const std::filesystem::path& path);

// Six views at one point, square, 90 degrees wide, one for each direction, however turned about
// their axes: as a node, its faces in order. Nearest texels; none is interpolated.
[[nodiscard]] Result<EnvironmentMap> environment_from_views(const std::vector<DepthImage>& views);

// manifest.json and two OpenEXR files a face into `folder`, which is made; depths as EYE_Z.
[[nodiscard]] Result<> save_seurat_capture(const std::filesystem::path& folder,
                                           const EnvironmentMap& map);

}  // namespace rilievo
