// Against a ray through every pixel, from within scenes.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/render/raster/whole_frames_test_helpers.h"

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

TEST(RasterFrames, draws_what_rays_meet_when_triangles_reach_behind_the_eye) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(-1, 1);
  int covered = 0, different = 0, pixels = 0;
  for (int round = 0; round < 24; ++round) {
    const Scene scene = scene_around(rng);
    RasterFrames raster(scene);
    RayFrames rays(scene);
    const double time = round % 2 ? 0.4 : 0.0;
    raster.set_time(time);
    ASSERT_TRUE(rays.set_time(time));
    const glm::dvec3 eye(0.2 * u(rng), 0.2 * u(rng), 0.2 * u(rng));
    const Camera camera = look_at(eye, eye + glm::dvec3(u(rng), 0.4 * u(rng), u(rng)), {0, 1, 0},
                                  1.2, 64, 48, 0.05, 100);
    ObjectPicture drawn, cast;
    ASSERT_TRUE(raster.draw_objects(camera, drawn).ok());
    rays.draw_objects(camera, cast);
    for (std::size_t i = 0; i < drawn.object.size(); ++i) {
      ++pixels;
      covered += cast.object[i] != kNoObject;
      // window_z is steep near the eye; this is a thousandth of the nearest metre's.
      if (drawn.object[i] != cast.object[i] || std::abs(drawn.depth[i] - cast.depth[i]) > 1e-3f)
        ++different;
    }
    RasterPicture colors, cast_colors;
    ASSERT_TRUE(raster.draw(camera, 4, colors).ok());
    rays.draw(camera, 4, cast_colors);
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

// A crumpled floor of many runs, below and behind the eye, and crumpled walls that stand on it.
Scene fine_scene(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(-1, 1);
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].double_sided = true;
  constexpr int kSide = 90;
  for (int m = 0; m < 2; ++m) {
    Mesh mesh;
    mesh.material = 0;
    for (int y = 0; y <= kSide; ++y)
      for (int x = 0; x <= kSide; ++x) {
        const glm::vec2 at = 2.0f * glm::vec2(x, y) / float(kSide) - 1.0f;
        const float up = 0.01f * u(rng);
        mesh.positions.push_back(m == 0 ? glm::vec3(20 * at.x, up - 1, 20 * at.y)
                                        : glm::vec3(2 * at.x, 2 * at.y, up));
        mesh.normals.emplace_back(0, 1, 0);
      }
    for (std::uint32_t y = 0; y < kSide; ++y)
      for (std::uint32_t x = 0; x < kSide; ++x) {
        const std::uint32_t a = y * (kSide + 1) + x, c = a + kSide + 1;
        mesh.indices.insert(mesh.indices.end(), {a, a + 1, c, a + 1, c + 1, c});
      }
    scene.meshes.push_back(mesh);
    scene.models.emplace_back();
    scene.models.back().parts = {{m, glm::mat4(1)}};
  }
  for (int i = 0; i < 7; ++i) {
    Object object;
    object.model = i > 0;
    const glm::vec3 at(8 * u(rng), 0.5f * u(rng), 8 * u(rng));
    if (i > 0)
      object.placement = glm::rotate(glm::translate(glm::mat4(1), at), 3 * u(rng), {0, 1, 0});
    scene.objects.push_back(object);
  }
  finish(scene);
  return scene;
}

// Runs of triangles that cannot be seen are left out, and nothing else: as without their bounds,
// and as rays see it.
TEST(RasterFrames, leaves_out_no_run_that_can_be_seen) {
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> u(-1, 1);
  int different = 0, pixels = 0;
  for (int round = 0; round < 8; ++round) {
    const Scene scene = fine_scene(rng);
    Scene without = scene;
    for (Mesh& mesh : without.meshes) mesh.run_bounds.clear();
    RasterFrames raster(scene), all(without);
    RayFrames rays(scene);
    for (int view = 0; view < 6; ++view) {
      const glm::dvec3 eye(6 * u(rng), 0.5 * u(rng), 6 * u(rng));
      const Camera camera = look_at(eye, eye + glm::dvec3(u(rng), 0.4 * u(rng), u(rng)), {0, 1, 0},
                                    1.2, 160, 120, 0.05, 100);
      RasterPicture seen, expected;
      ASSERT_TRUE(raster.draw(camera, 4, seen).ok());
      ASSERT_TRUE(all.draw(camera, 4, expected).ok());
      ASSERT_EQ(seen.color, expected.color) << round << ", " << view;
      ASSERT_EQ(seen.depth, expected.depth);
      ObjectPicture drawn, cast;
      ASSERT_TRUE(raster.draw_objects(camera, drawn).ok());
      rays.draw_objects(camera, cast);
      for (std::size_t i = 0; i < drawn.object.size(); ++i)
        ++pixels, different += drawn.object[i] != cast.object[i];
    }
  }
  EXPECT_LE(different, pixels / 200);  // centres that lie on an edge, within rounding
}

TEST(RayFrames, places_what_moves_as_rays_built_for_that_time_do) {
  std::mt19937 rng(6);
  const Scene scene = scene_around(rng);
  const Camera camera = look_at({0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 1.0, 40, 30, 0.1, 100);
  RayFrames moved(scene);
  for (const double time : {0.7, 0.2}) {
    ASSERT_TRUE(moved.set_time(time));
    const auto built = RayScene::create(scene, time);
    ASSERT_TRUE(built.ok());
    PictureCaster caster(*built);
    RasterPicture a, b;
    moved.draw(camera, 4, a);
    caster.draw(camera, {}, 4, b);
    EXPECT_EQ(a.color, b.color);
    EXPECT_EQ(a.depth, b.depth);
  }
}

}  // namespace
}  // namespace rilievo
