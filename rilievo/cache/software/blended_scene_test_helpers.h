// A scene in which much blends, for tests of both ways of drawing.
#pragma once

#include <utility>

#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {

// Panes and balls that blend, before and behind each other and what is opaque; textured, with
// colours at the corners, one- and two-sided, and one around the eye.
inline BuiltinScene blended_scene() {
  BuiltinScene made = std::move(*make_builtin("builtin:teapots?triangles=20000"));
  Scene& scene = made.scene;
  const Box bounds = world_bounds(scene);
  const float radius = bounds.radius();
  Image<glm::u8vec4> texels(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      texels(x, y) = {std::uint8_t(4 * x), std::uint8_t(4 * y), 128,
                      std::uint8_t(64 + 128 * ((x / 8 + y / 8) % 2))};
  scene.images.push_back(texels);
  Texture texture;
  texture.image = int(scene.images.size()) - 1;
  scene.textures.push_back(texture);
  Random random(5);
  for (int i = 0; i < 12; ++i) {
    Material material;
    material.alpha_mode = AlphaMode::blend;
    material.base_color = {random.unit(), random.unit(), random.unit(), random.between(0.2f, 0.8f)};
    material.double_sided = i % 2 == 0;
    material.unlit = i % 5 == 0;
    if (i % 3 == 0) material.base_color_texture.texture = int(scene.textures.size()) - 1;
    scene.materials.push_back(material);
    Mesh mesh;
    const glm::vec3 at =
        bounds.center() +
        0.8f * radius *
            glm::vec3(random.between(-1, 1), random.between(-0.3f, 0.6f), random.between(-1, 1));
    const glm::vec3 u =
        0.4f * radius *
        glm::normalize(glm::vec3(random.between(-1, 1), 0.1f, random.between(-1, 1)));
    const glm::vec3 v(0, 0.3f * radius, 0);
    mesh.positions = {at - u - v, at + u - v, at + u + v, at - u + v};
    mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
    mesh.uv[0] = {{0, 1}, {2, 1}, {2, 0}, {0, 0}};
    if (i % 4 == 1) mesh.colors = {{1, 1, 1, 1}, {1, 0, 0, 0.2f}, {0, 1, 0, 1}, {0, 0, 1, 0.5f}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    mesh.material = int(scene.materials.size()) - 1;
    scene.meshes.push_back(mesh);
    Model model;
    model.parts.push_back({int(scene.meshes.size()) - 1, glm::mat4(1.0f)});
    scene.models.push_back(model);
    Object object;
    object.model = int(scene.models.size()) - 1;
    scene.objects.push_back(object);
  }
  finish(scene);
  return made;
}

}  // namespace rilievo
