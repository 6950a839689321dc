#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo {

Mesh make_ground(const Ground& ground, const glm::vec2& corner, float size, int cells) {
  const glm::vec3 center{corner.x + 0.5f * size, 0, corner.y + 0.5f * size};
  Mesh mesh;
  mesh.name = "ground";
  GridShape shape;
  shape.nu = shape.nv = cells;
  // z x x points up.
  add_grid(mesh, shape, [&](float u, float v) {
    const float x = corner.x + size * v, z = corner.y + size * u;
    const glm::vec3 point{x, ground.height(x, z), z};
    return BuiltVertex{point - center, ground.color(point)};
  });
  const float step = 0.5f * size / float(cells);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p = mesh.positions[i] + center;
    const float dx = ground.height(p.x + step, p.z) - ground.height(p.x - step, p.z);
    const float dz = ground.height(p.x, p.z + step) - ground.height(p.x, p.z - step);
    mesh.normals[i] = glm::normalize(glm::vec3(-dx, 2 * step, -dz));
  }
  return mesh;
}

}  // namespace rilievo
