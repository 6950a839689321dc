// The work of drawing an object as polygons: counts, the same on all machines.
#pragma once

#include <cstdint>

namespace rilievo {

// The work of rasterising one mesh.
struct MeshWork {
  std::uint64_t projected = 0;  // triangles that had to be projected
  std::uint64_t filled = 0;     // ... and those of them that had to be filled
};

// The work of one object in one frame, by the rasteriser: most triangles of a scene are hidden by
// others and left out early (render/raster/sample_raster.h).
struct ObjectWork {
  std::uint32_t object = 0;                 // index into Scene::objects
  std::uint64_t projected = 0, filled = 0;  // of all its meshes; by rays: 0
  std::uint64_t shaded = 0;                 // pairs of a pixel and a triangle that were shaded
};

}  // namespace rilievo
