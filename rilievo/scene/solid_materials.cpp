#include "rilievo/scene/solid_materials.h"

#include <algorithm>

namespace rilievo {
namespace {

bool is_solid(const Rgba8Image& image) {
  return std::all_of(image.texels().begin(), image.texels().end(),
                     [](const glm::u8vec4& texel) { return texel.a == 255; });
}

bool is_solid(const Material& material, const Scene& scene) {
  if (material.base_color.a < 1 || material.transmission > 0) return false;
  const int texture = material.base_color_texture.texture;
  return texture < 0 ||
         is_solid(scene.images[std::size_t(scene.textures[std::size_t(texture)].image)]);
}

}  // namespace

void make_solid_materials_opaque(Scene& scene) {
  std::vector<std::uint8_t> lets_through(scene.materials.size(), 0);
  for (const Mesh& mesh : scene.meshes)
    if (mesh.material >= 0 && std::any_of(mesh.colors.begin(), mesh.colors.end(),
                                          [](const glm::vec4& color) { return color.a < 1; }))
      lets_through[std::size_t(mesh.material)] = 1;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    Material& material = scene.materials[i];
    if (material.alpha_mode == AlphaMode::blend && !lets_through[i] && is_solid(material, scene))
      material.alpha_mode = AlphaMode::opaque;
  }
}

}  // namespace rilievo
