// Shading against the formulas as appendix B of the glTF 2.0 specification writes them.
#include "rilievo/render/opengl/scene_shaders.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/capture/gl/capture_picture.h"
#include "rilievo/core/color.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/shading/shading_test_helpers.h"
#include "rilievo/render/wall_test_helpers.h"

namespace rilievo {
namespace {

using SceneShaders = gl::ContextTest;
class SceneShadersTest : public SceneShaders, public testing::WithParamInterface<Projection> {};

TEST_P(SceneShadersTest, shade_as_the_specification_says) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<float> u(0, 1);
  const auto direction = [&] {
    std::normal_distribution<float> n;
    return glm::normalize(glm::vec3(n(rng), n(rng), n(rng)));
  };
  int compared = 0, in_the_sun = 0;
  for (int round = 0; round < 60; ++round) {
    Material m;
    m.base_color = {u(rng), u(rng), u(rng), 1};
    m.roughness = 0.2f + 0.8f * u(rng);  // what is smoother mirrors the sun in a few pixels
    m.metallic = round % 3 == 0 ? u(rng) : 0.0f;
    if (round % 4 == 0) m.emissive = {u(rng), 0, u(rng)};
    m.double_sided = round % 2;
    Scene scene = wall_scene(2, m);
    Light sun;
    sun.direction = direction(), sun.intensity = {3, 2, 1};
    scene.lights = {sun};
    scene.objects[0].placement = glm::rotate(glm::mat4(1), 6.0f * u(rng), direction());
    finish(scene);
    const glm::dvec3 n(scene.objects[0].placement[2]);
    const Incident lit = incident_by_definition(sun, {});
    glm::dvec3 eye(4.0f * direction());
    if (glm::dot(eye, n) < 0 && !m.double_sided) eye = -eye;
    auto camera = tight_camera(GetParam(), eye, {0.1, 1, 0}, world_bounds(scene));
    ASSERT_TRUE(camera.ok());
    camera->width = 9, camera->height = 9;
    auto renderer = SceneRenderer::create(scene);
    ASSERT_TRUE(renderer.ok()) << renderer.error().message();
    auto picture = capture_picture(*renderer, *camera, {.samples = 1});
    ASSERT_TRUE(picture.ok());
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 9; ++x) {
        if (picture->depth(x, y) == kNoDepth) continue;
        const glm::dvec3 at =
            world_from_raster(*camera, {x + 0.5, y + 0.5}, double(picture->depth(x, y)));
        const glm::dvec3 to_eye = glm::normalize(camera->position() - at);
        glm::dvec3 facing = n, v = GetParam() == Projection::perspective ? to_eye
                                   : GetParam() == Projection::parallel  ? -camera->forward()
                                                                         : camera->forward();
        if (camera->keeps_farthest() ? glm::dot(n, to_eye) > 0 : glm::dot(n, to_eye) < 0)
          facing = -n;
        // What faces away from a back-perspective picture's axis is seen from beside it.
        if (camera->keeps_farthest())
          v = glm::normalize(v + std::max(0.0, 0.17 - glm::dot(facing, v)) * facing);
        // Edge on, a float's rounding decides which side is seen.
        if (std::abs(glm::dot(n, to_eye)) < 0.02) continue;
        const glm::dvec3 expected = shade_by_definition(m, {&lit, 1}, scene.sky, facing, v);
        for (int k = 0; k < 3; ++k)
          // A part in 2^11 of a half float, normals of ten bits, and floats in the lobe of the
          // smoothest material.
          ASSERT_NEAR(picture->color(x, y)[k], expected[k], 0.004 * expected[k] + 0.002)
              << "round " << round << ", texel " << x << ", " << y;
        ++compared;
        in_the_sun += glm::dot(facing, glm::dvec3(sun.direction)) < 0;
      }
  }
  EXPECT_GT(compared, 500);
  EXPECT_GT(in_the_sun, compared / 4);
}

INSTANTIATE_TEST_SUITE_P(AllProjections, SceneShadersTest,
                         testing::Values(Projection::perspective, Projection::back_perspective,
                                         Projection::parallel));

// Less than black in a captured picture would darken what lights give it.
TEST_F(SceneShaders, a_rough_black_metal_is_black) {
  Material black;
  black.base_color = {0, 0, 0, 1}, black.metallic = 1, black.roughness = 1;
  Scene scene = wall_scene(2, black);
  Light none;
  none.intensity = glm::vec3(0);
  scene.lights = {none};
  finish(scene);
  auto camera = tight_camera(Projection::parallel, {0, 0, 5}, {0, 1, 0}, world_bounds(scene));
  ASSERT_TRUE(camera.ok());
  camera->width = camera->height = 4;
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  auto picture = capture_picture(*renderer, *camera, {.samples = 1});
  ASSERT_TRUE(picture.ok());
  ASSERT_NE(picture->depth(2, 2), kNoDepth);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(picture->color(2, 2)[k], 0);
}

// A hole's edge covers a share of a texel, and of its light no other share.
TEST_F(SceneShaders, cover_as_much_of_a_masked_texel_as_they_light) {
  Material white;
  white.unlit = white.double_sided = true;
  white.alpha_mode = AlphaMode::mask;
  Scene scene = wall_scene(2, white);
  Mesh& mesh = scene.meshes[0];
  // Alpha falls from 1 to 0 askew.
  for (const glm::vec3& p : mesh.positions)
    mesh.colors.emplace_back(1, 1, 1, 0.5f + 0.3f * p.x + 0.2f * p.y);
  finish(scene);
  auto camera = tight_camera(Projection::parallel, {0, 0, 5}, {0, 1, 0}, world_bounds(scene));
  ASSERT_TRUE(camera.ok());
  camera->width = camera->height = 32;
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  auto picture = capture_picture(*renderer, *camera, {.samples = 4});
  ASSERT_TRUE(picture.ok());
  int partly = 0;
  double sum = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const glm::vec4 c = picture->color(x, y);
      sum += c.a;
      partly += c.a > 0 && c.a < 1;
      EXPECT_EQ(c.a * 4, std::round(c.a * 4));
      for (int k = 0; k < 3; ++k) EXPECT_EQ(c[k], c.a);
    }
  EXPECT_GT(partly, 8);
  // Half of the wall; a texel on the edge is empty if its middle is a hole, by half of one at most.
  EXPECT_NEAR(sum, 512, 0.5 * partly);
}

TEST_F(SceneShaders, encode_what_is_linear_as_srgb) {
  Material unlit;
  unlit.unlit = true;
  Scene scene = wall_scene(2, unlit);
  scene.meshes[0].colors = {{0, 0, 0, 1}, {1, 1, 1, 1}, {1, 1, 1, 1}, {0, 0, 0, 1}};
  finish(scene);
  constexpr int kWidth = 4096;
  auto camera = tight_camera(Projection::parallel, {0, 0, 5}, {0, 1, 0}, world_bounds(scene));
  ASSERT_TRUE(camera.ok());
  camera->width = kWidth, camera->height = 1;
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  auto target = FrameTarget::create(kWidth, 1, 1);
  ASSERT_TRUE(target.ok());
  target->begin();
  const std::uint32_t all[] = {0};
  renderer->draw_opaque(*camera, all, OutputEncoding::srgb);
  target->resolve();
  const Rgba8Image frame = target->read();
  double worst = 0;
  for (int x = 0; x < kWidth; ++x) {
    const glm::dvec3 at = world_from_raster(*camera, {x + 0.5, 0.5}, 5);
    if (std::abs(at.x) > 0.999) continue;
    worst = std::max(worst,
                     std::abs(frame(x, 0).r - 255.0 * srgb_from_linear(float(0.5 + 0.5 * at.x))));
  }
  // Rounding to a byte, the polynomial's fifth of one, and what an interpolated colour is off.
  EXPECT_LE(worst, 0.75);
  EXPECT_GE(worst, 0.45);  // all of a byte's range has been seen
}

}  // namespace
}  // namespace rilievo
