#include "rilievo/scene/take_as.h"

namespace rilievo {

glm::dmat3 upright_from(UpAxis up) {
  switch (up) {
    case UpAxis::x:
      return {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
    case UpAxis::y:
      break;
    case UpAxis::z:
      return {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
  }
  return glm::dmat3(1.0);
}

void take_as(Scene& scene, UpAxis up, double metres_per_unit) {
  const double scale = metres_per_unit;
  const glm::dmat3 turn = upright_from(up), linear = scale * turn;
  scene.world.up = up;
  scene.world.metres_per_unit = scale;
  if (up == UpAxis::y && scale == 1) return;
  scene.world.origin = linear * scene.world.origin;

  for (Object& object : scene.objects) {
    if (object.node >= 0)
      ++object.node;
    else
      object.placement = glm::mat4(glm::dmat4(linear) * glm::dmat4(object.placement));
  }
  // Nodes hang below a new one.
  if (!scene.nodes.empty()) {
    for (Node& node : scene.nodes) ++node.parent;
    Node root;
    root.rotation = glm::quat(glm::quat_cast(turn));
    root.scale = glm::vec3(float(scale));
    scene.nodes.insert(scene.nodes.begin(), root);
    for (Channel& channel : scene.channels) ++channel.node;
  }
  for (Light& light : scene.lights) {
    light.position = glm::vec3(linear * glm::dvec3(light.position));
    light.direction = glm::normalize(glm::vec3(turn * glm::dvec3(light.direction)));
    light.range *= float(scale);
    if (light.kind != Light::Kind::directional) light.intensity *= float(scale * scale);
  }
  for (Camera& camera : scene.cameras) {
    glm::dmat4& pose = camera.world_from_eye;
    const glm::dvec3 eye = linear * glm::dvec3(pose[3]);
    pose = glm::dmat4(turn * glm::dmat3(pose));
    pose[3] = glm::dvec4(eye, 1);
    camera.z_near *= scale, camera.z_far *= scale;
    if (camera.projection != Projection::parallel) continue;
    ImageWindow& window = camera.window;
    window = {scale * window.left, scale * window.right, scale * window.bottom, scale * window.top};
  }
}

}  // namespace rilievo
