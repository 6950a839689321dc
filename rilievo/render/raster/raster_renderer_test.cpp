// Against a ray through every pixel, from within scenes.
#include "rilievo/render/raster/raster_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/render/rays/ray_renderer.h"

namespace rilievo {
namespace {

// Long triangles in all directions, most of which reach past the eye at the origin; a third of them
// with holes; one object moves.
Scene scene_around(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(-1, 1);
  Scene scene;
  scene.images.emplace_back(4, 4, glm::u8vec4(255));
  for (int i = 0; i < 4; ++i) scene.images[0](i, i).a = 0;
  Texture holes;
  holes.nearest = true;
  scene.textures.push_back(holes);
  for (int m = 0; m < 3; ++m) {
    Material material;
    material.double_sided = m > 0;
    if (m == 2) {
      material.alpha_mode = AlphaMode::mask;
      material.base_color_texture.texture = 0;
    }
    scene.materials.push_back(material);
    Mesh mesh;
    mesh.material = m;
    for (std::uint32_t t = 0; t < 8; ++t) {
      const glm::vec3 center = 2.0f * glm::normalize(glm::vec3(u(rng), u(rng), u(rng)));
      for (int k = 0; k < 3; ++k) {
        mesh.positions.push_back(center + 6.0f * glm::vec3(u(rng), u(rng), u(rng)));
        mesh.normals.emplace_back(0, 0, 1);
        mesh.uv[0].emplace_back(0.6f * u(rng), 0.6f * u(rng));
        mesh.indices.push_back(3 * t + std::uint32_t(k));
      }
    }
    scene.meshes.push_back(mesh);
    scene.models.emplace_back();
    scene.models.back().parts = {{m, glm::mat4(1)}};
    Object object;
    object.model = m;
    if (m == 1) object.placement = glm::scale(glm::mat4(1), {-1, 1, 1});
    scene.objects.push_back(object);
  }
  scene.nodes.resize(1);
  scene.objects[0].node = 0;
  scene.channels = {{0,
                     Channel::Path::translation,
                     Channel::Interpolation::linear,
                     {0, 1},
                     {{0, 0, 0, 0}, {1, 2, 0, 0}}}};
  scene.duration = 1;
  finish(scene);
  return scene;
}

TEST(RasterRenderer, draws_what_rays_meet_when_triangles_reach_behind_the_eye) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(-1, 1);
  int covered = 0, different = 0, pixels = 0;
  for (int round = 0; round < 24; ++round) {
    const Scene scene = scene_around(rng);
    RasterRenderer raster(scene);
    const auto rays = RayRenderer::create(scene);
    ASSERT_TRUE(rays.ok());
    const double time = round % 2 ? 0.4 : 0.0;
    ASSERT_TRUE(raster.set_time(time).ok());
    ASSERT_TRUE((*rays)->set_time(time).ok());
    const glm::dvec3 eye(0.2 * u(rng), 0.2 * u(rng), 0.2 * u(rng));
    const Camera camera = look_at(eye, eye + glm::dvec3(u(rng), 0.4 * u(rng), u(rng)), {0, 1, 0},
                                  1.2, 64, 48, 0.05, 100);
    ObjectPicture drawn, cast;
    ASSERT_TRUE(raster.draw_objects(camera, drawn).ok());
    ASSERT_TRUE((*rays)->draw_objects(camera, cast).ok());
    for (std::size_t i = 0; i < drawn.object.size(); ++i) {
      ++pixels;
      covered += cast.object[i] != kNoObject;
      // window_z is steep near the eye; this is a thousandth of the nearest metre's.
      if (drawn.object[i] != cast.object[i] || std::abs(drawn.depth[i] - cast.depth[i]) > 1e-3f)
        ++different;
    }
    RasterPicture colors, cast_colors;
    ASSERT_TRUE(raster.draw(camera, 4, colors).ok());
    ASSERT_TRUE((*rays)->draw(camera, 4, cast_colors).ok());
    int other = 0;
    for (std::size_t i = 0; i < colors.color.size(); ++i)
      for (int k = 0; k < 4; ++k)
        if (std::abs(int(colors.color[i][k]) - int(cast_colors.color[i][k])) > 2) {
          ++other;
          break;
        }
    // Samples that lie on an edge, or on a hole's, within rounding.
    EXPECT_LE(other, int(colors.color.size()) / 100) << round;
  }
  EXPECT_GT(covered, pixels / 2);
  // The same for centres.
  EXPECT_LE(different, pixels / 200);
}

TEST(RayRenderer, places_what_moves_as_rays_built_for_that_time_do) {
  std::mt19937 rng(6);
  const Scene scene = scene_around(rng);
  const Camera camera = look_at({0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 1.0, 40, 30, 0.1, 100);
  const auto moved = RayRenderer::create(scene);
  ASSERT_TRUE(moved.ok());
  for (const double time : {0.7, 0.2}) {
    ASSERT_TRUE((*moved)->set_time(time).ok());
    const auto built = RayScene::create(scene, time);
    ASSERT_TRUE(built.ok());
    PictureCaster caster(*built);
    RasterPicture a, b;
    ASSERT_TRUE((*moved)->draw(camera, 4, a).ok());
    caster.draw(camera, {}, 4, b);
    EXPECT_EQ(a.color, b.color);
    EXPECT_EQ(a.depth, b.depth);
  }
}

}  // namespace
}  // namespace rilievo
