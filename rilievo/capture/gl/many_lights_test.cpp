// A scene of more lights than any array would hold: whoever draws it shades them all.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/capture/gl/capture_picture.h"
#include "rilievo/core/color.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/render/raster/raster_picture.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/shading/shading_test_helpers.h"
#include "rilievo/render/wall_test_helpers.h"

namespace rilievo {
namespace {

constexpr int kSize = 64;

// Walls in each other's way that face anywhere, under lights of all kinds.
Scene lit_walls(int lights) {
  std::mt19937 rng(4);
  std::uniform_real_distribution<float> u(0, 1);
  std::normal_distribution<float> normal;
  const auto direction = [&] {
    return glm::normalize(glm::vec3(normal(rng), normal(rng), normal(rng)));
  };
  Material material;
  material.base_color = {0.9f, 0.7f, 0.5f, 1};
  material.roughness = 0.5f, material.metallic = 0.3f, material.double_sided = true;
  Scene scene = wall_scene(3, material);
  scene.objects.resize(4);
  for (Object& wall : scene.objects)
    wall.placement =
        glm::rotate(glm::translate(glm::mat4(1), direction()), 6.0f * u(rng), direction());
  for (int i = 0; i < lights; ++i) {
    Light light;
    light.kind = Light::Kind(i % 3);
    light.direction = direction();
    light.position = 3.0f * direction();
    light.intensity = (i % 3 ? 0.15f : 0.03f) * glm::vec3(u(rng), u(rng), u(rng));
    light.range = i % 2 ? 0.0f : 8.0f;
    light.inner_cone = 0.2f, light.outer_cone = 1.4f;
    scene.lights.push_back(light);
  }
  finish(scene);
  return scene;
}

// What a texel shows by definition: of all that arrives, and of all but the last light.
struct Expected {
  glm::dvec3 shaded, without_last;
};

Expected expected_at(const Scene& scene, const Camera& camera, const glm::dvec3& at, glm::dvec3 n) {
  const glm::dvec3 v = glm::normalize(camera.position() - at);
  if (glm::dot(n, v) < 0) n = -n;
  std::vector<Incident> incident;
  for (const Light& light : scene.lights) incident.push_back(incident_by_definition(light, at));
  const Material& m = scene.materials[0];
  Expected expected;
  expected.shaded = shade_by_definition(m, incident, scene.sky, n, v);
  incident.pop_back();
  expected.without_last = shade_by_definition(m, incident, scene.sky, n, v);
  return expected;
}

using ManyLights = gl::ContextTest;

TEST_F(ManyLights, are_all_shaded_whoever_draws) {
  for (const int lights : {2, 16, 17, 100, 1000}) {
    Scene scene = lit_walls(lights);
    for (Light& light : scene.lights) light.intensity *= 100.0f / float(lights);
    // What comes last is what an array would drop.
    scene.lights.back().kind = Light::Kind::directional;
    scene.lights.back().direction = glm::normalize(glm::vec3(-1, -1, -1));
    scene.lights.back().intensity = {0.3f, 0.6f, 0.9f};
    auto camera = tight_camera(Projection::perspective, {6, 5, 7}, {0, 1, 0}, world_bounds(scene));
    ASSERT_TRUE(camera.ok());
    camera->width = camera->height = kSize;

    auto renderer = SceneRenderer::create(scene);
    ASSERT_TRUE(renderer.ok()) << renderer.error().message();
    auto by_opengl = capture_picture(*renderer, *camera, {.samples = 1});
    ASSERT_TRUE(by_opengl.ok()) << by_opengl.error().message();
    PictureRasterizer rasterizer(scene);
    std::vector<std::uint32_t> objects;
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i) objects.push_back(i);
    RasterPicture by_rasterizer;
    rasterizer.draw(*camera, objects, renderer->poses(), 1, by_rasterizer);
    auto rays = RayScene::create(scene);
    ASSERT_TRUE(rays.ok());
    const DepthImage by_rays = cast_picture(*rays, *camera);

    int compared = 0, last_counts = 0;
    for (int y = 1; y + 1 < kSize; ++y)
      for (int x = 1; x + 1 < kSize; ++x) {
        // Where two surfaces meet, each renderer may take either.
        const std::uint32_t object = by_opengl->object(x, y);
        bool same = object != kNoObject && by_rays.object(x, y) == object;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) same &= by_opengl->object(x + dx, y + dy) == object;
        if (!same) continue;
        const glm::dvec3 at =
            world_from_raster(*camera, {x + 0.5, y + 0.5}, double(by_opengl->depth(x, y)));
        const glm::dvec3 n(scene.objects[object - 1].placement[2]);
        // Edge on, a float's rounding decides which side is seen.
        if (std::abs(glm::dot(n, glm::normalize(camera->position() - at))) < 0.05) continue;
        const Expected expected = expected_at(scene, *camera, at, n);
        const glm::u8vec4 bytes =
            by_rasterizer.color[std::size_t(kSize - 1 - y) * kSize + std::size_t(x)];
        for (int k = 0; k < 3; ++k) {
          // A part in 2^11 of a half float, normals of ten bits, and floats in the lobe.
          ASSERT_NEAR(by_opengl->color(x, y)[k], expected.shaded[k],
                      0.004 * expected.shaded[k] + 0.002)
              << lights << " lights, texel " << x << ", " << y;
          // A byte's rounding, and a quarter of one of the sRGB curve's polynomial.
          ASSERT_NEAR(bytes[k], 255 * srgb_from_linear(std::min(float(expected.shaded[k]), 1.0f)),
                      0.5 + 0.25 + 0.05)
              << lights << " lights, texel " << x << ", " << y;
          // Embree's hits are as far off as a float, in the lobe of the light.
          ASSERT_NEAR(by_rays.color(x, y)[k], expected.shaded[k], 1e-3 * expected.shaded[k] + 1e-4)
              << lights << " lights, texel " << x << ", " << y;
        }
        ++compared;
        last_counts += expected.shaded.b - expected.without_last.b > 0.02;
      }
    EXPECT_GT(compared, 300) << lights;
    // More than any tolerance above.
    EXPECT_GT(last_counts, compared / 2) << lights;
  }
}

}  // namespace
}  // namespace rilievo
