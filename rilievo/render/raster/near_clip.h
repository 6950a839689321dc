// How are triangles rasterised that reach behind the eye?
//
// The rasteriser projects corners, so that all of them must lie before the eye. A triangle that
// crosses the near plane is cut there, and far outside of the sides of the frame, where single
// precision would otherwise not suffice. All else stays as it is. Internal to render/raster.
#pragma once

#include <cstdint>
#include <deque>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/render/raster/sample_raster.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The cut pieces of meshes, as instances of their own.
class NearClip {
 public:
  // Removes all pieces.
  void clear();
  // Does the box reach to the near plane, at w = `z_near`?
  [[nodiscard]] static bool crosses(const RasterInstance& instance, const Box& bounds,
                                    float z_near);
  // Cuts the triangles of `mesh` that cross the plane. `instance` places the mesh in a frame of
  // width x height texels; it then draws only triangles beyond the plane. Are there any pieces?
  bool cut(const Mesh& mesh, int width, int height, float z_near, RasterInstance& instance);

  // The pieces, ready to be drawn; their triangles have the numbers of those that they are cut
  // from. Valid until clear().
  [[nodiscard]] const std::vector<RasterInstance>& instances() const { return instances_; }

 private:
  struct Pieces {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec2> uv;
    std::vector<glm::vec4> colors;
    std::vector<std::uint32_t> indices, numbers;
    RasterMask mask;
  };
  std::deque<Pieces> pieces_;  // instances point into them; kept for the next frames
  std::size_t used_ = 0;       // of those
  std::vector<RasterInstance> instances_;
};

}  // namespace rilievo
