// Where do the meshes of a picture lie in its raster? Internal to render/raster.
#pragma once

#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/render/raster/sample_raster.h"
#include "rilievo/render/shading/seen_triangles.h"

namespace rilievo {

// How a camera shows the points or lines of a mesh.
[[nodiscard]] RasterStrokes make_strokes(const Camera& camera, const Mesh& mesh,
                                         const glm::mat4& relative_from_mesh);

// Lets the farthest be the nearest: z becomes 1 - z, and what lies beyond the far plane is drawn on
// it.
void keep_farthest(RasterInstance& instance);

// Makes one instance for each placed mesh. Masks lie in `masks`, to which instances point.
void make_instances(const Camera& camera, std::span<const PlacedMesh> placed,
                    std::vector<RasterInstance>& instances, std::vector<RasterMask>& masks);

}  // namespace rilievo
