// What the benches of environment nodes look at.
#pragma once

#include "rilievo/core/depth_image.h"
#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/node_mesh.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo::bench {

// The teapots of the built-in scene in a closed room.
[[nodiscard]] Result<Scene> teapot_room(bool quick);
inline constexpr glm::dvec3 kRoomNode{0.5, 2.2, 5.5};

// By OpenGL, sky included.
[[nodiscard]] Result<EnvironmentMap> capture_node(SceneRenderer& renderer, const glm::dvec3& eye,
                                                  int size);
[[nodiscard]] NodeMesh budget_mesh(const EnvironmentMap& map, std::size_t triangles);

// An eye that the node at `node` sees, within `reach` of it along each axis and 0.3 m from
// surfaces.
[[nodiscard]] glm::dvec3 eye_beside(const RayScene& rays, const glm::dvec3& node,
                                    const glm::dvec3& reach, Random& random);
// A frame at `eye` that looks anywhere.
[[nodiscard]] Camera any_frame(const glm::dvec3& eye, int width, int height, Random& random);

}  // namespace rilievo::bench
