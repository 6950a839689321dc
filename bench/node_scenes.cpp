#include "bench/node_scenes.h"

#include <utility>

#include "rilievo/capture/gl/capture_picture.h"
#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {

Result<Scene> teapot_room(bool quick) {
  Result<BuiltinScene> made =
      make_builtin(quick ? "builtin:teapots?triangles=10000" : "builtin:teapots");
  if (!made) return made.error();
  Scene scene = std::move(made->scene);
  Material plaster;
  plaster.name = "plaster", plaster.base_color = {0.5f, 0.55f, 0.6f, 1},
  plaster.double_sided = true;
  scene.materials.push_back(plaster);
  Mesh walls;
  walls.name = "walls", walls.material = int(scene.materials.size()) - 1;
  const glm::vec3 low(-14, -1, -11), high(15, 9, 12);
  for (int k = 0; k < 3; ++k)
    for (const bool at_high : {false, true}) {
      const std::uint32_t first = std::uint32_t(walls.positions.size());
      glm::vec3 normal(0);
      normal[k] = at_high ? -1.0f : 1.0f;
      for (int c = 0; c < 4; ++c) {
        glm::vec3 p;
        p[k] = at_high ? high[k] : low[k];
        p[(k + 1) % 3] = (c & 1) ? high[(k + 1) % 3] : low[(k + 1) % 3];
        p[(k + 2) % 3] = (c & 2) ? high[(k + 2) % 3] : low[(k + 2) % 3];
        walls.positions.push_back(p);
        walls.normals.push_back(normal);
      }
      for (const std::uint32_t i : {0u, 1u, 2u, 1u, 3u, 2u}) walls.indices.push_back(first + i);
    }
  scene.meshes.push_back(std::move(walls));
  Model model;
  model.name = "walls", model.parts.push_back({int(scene.meshes.size()) - 1});
  scene.models.push_back(std::move(model));
  Object object;
  object.name = "walls", object.model = int(scene.models.size()) - 1;
  scene.objects.push_back(std::move(object));
  finish(scene);
  return scene;
}

Result<EnvironmentMap> capture_node(SceneRenderer& renderer, const glm::dvec3& eye, int size) {
  EnvironmentMap map;
  const std::array<Camera, 6> cameras = environment_cameras(eye, size, 0.05, 500);
  for (std::size_t f = 0; f < 6; ++f) {
    CaptureOptions options;
    options.with_sky = true;
    Result<DepthImage> face = capture_picture(renderer, cameras[f], options);
    if (!face) return face.error();
    map.faces[f] = *std::move(face);
  }
  if (Result<> valid = validate_environment(map); !valid) return valid.error();
  return map;
}

NodeMesh budget_mesh(const EnvironmentMap& map, std::size_t triangles) {
  TriangulateOptions options;
  options.triangles = triangles;
  options.error_px = 0;
  return triangulate(map, options);
}

glm::dvec3 eye_beside(const RayScene& rays, const glm::dvec3& node, const glm::dvec3& reach,
                      Random& random) {
  const auto in = [&] { return double(random.between(-1, 1)); };
  for (;;) {
    const glm::dvec3 eye = node + reach * glm::dvec3(in(), in(), in());
    if (rays.occluded(glm::vec3(node), glm::vec3(eye - node), 0, 1.05f)) continue;
    bool near = false;
    for (int k = 0; k < 24 && !near; ++k) {
      const glm::vec3 to = glm::normalize(glm::vec3(glm::dvec3(in(), in(), in())) + 1e-4f);
      near = rays.occluded(glm::vec3(eye), to, 0, 0.3f);
    }
    if (!near) return eye;
  }
}

Camera any_frame(const glm::dvec3& eye, int width, int height, Random& random) {
  const auto in = [&] { return double(random.between(-1, 1)); };
  const glm::dvec3 to(in(), in(), in());
  return look_at(eye, eye + to + 1e-3, {0, 1, 0}, double(random.between(0.4f, 1.4f)), width, height,
                 0.05, 100);
}

}  // namespace rilievo::bench
