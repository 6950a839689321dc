#include "rilievo/scene/solid_materials.h"

#include <gtest/gtest.h>

namespace rilievo {
namespace {

// One mesh with a blended material that has a texture and colours, all of alpha 1.
Scene blended_scene() {
  Scene scene;
  scene.images.emplace_back(4, 4, glm::u8vec4(10, 20, 30, 255));
  scene.textures.emplace_back();
  Material material;
  material.alpha_mode = AlphaMode::blend;
  material.base_color_texture.texture = 0;
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.material = 0;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.colors.assign(3, glm::vec4(0.5f, 0.5f, 0.5f, 1.0f));
  mesh.indices = {0, 1, 2};
  scene.meshes.push_back(mesh);
  return scene;
}

AlphaMode mode_after(Scene scene) {
  make_solid_materials_opaque(scene);
  return scene.materials[0].alpha_mode;
}

TEST(SolidMaterials, that_let_nothing_through_become_opaque) {
  EXPECT_EQ(mode_after(blended_scene()), AlphaMode::opaque);
}

TEST(SolidMaterials, stay_blended_if_anything_lets_light_through) {
  Scene by_factor = blended_scene();
  by_factor.materials[0].base_color.a = 0.99f;
  EXPECT_EQ(mode_after(by_factor), AlphaMode::blend);
  Scene by_texel = blended_scene();
  by_texel.images[0](3, 2).a = 254;
  EXPECT_EQ(mode_after(by_texel), AlphaMode::blend);
  Scene by_vertex = blended_scene();
  by_vertex.meshes[0].colors[2].a = 0.5f;
  EXPECT_EQ(mode_after(by_vertex), AlphaMode::blend);
  Scene glass = blended_scene();
  glass.materials[0].transmission = 0.5f;
  EXPECT_EQ(mode_after(glass), AlphaMode::blend);
}

// Whichever of them comes last.
TEST(SolidMaterials, one_mesh_that_lets_light_through_keeps_the_material_of_all_blended) {
  for (const int clear : {0, 1}) {
    Scene shared = blended_scene();
    shared.meshes.push_back(shared.meshes[0]);
    shared.meshes[std::size_t(clear)].colors[1].a = 0.5f;
    EXPECT_EQ(mode_after(shared), AlphaMode::blend) << clear;
  }
}

TEST(SolidMaterials, without_a_texture_the_factor_alone_decides) {
  Scene plain = blended_scene();
  plain.materials[0].base_color_texture.texture = -1;
  EXPECT_EQ(mode_after(plain), AlphaMode::opaque);
  plain.materials[0].base_color.a = 0.5f;
  EXPECT_EQ(mode_after(plain), AlphaMode::blend);
}

TEST(SolidMaterials, masks_stay_masks) {
  Scene masked = blended_scene();
  masked.materials[0].alpha_mode = AlphaMode::mask;
  EXPECT_EQ(mode_after(masked), AlphaMode::mask);
}

}  // namespace
}  // namespace rilievo
