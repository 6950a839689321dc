// Direct drawing against a ray caster that tests every triangle.
#include "rilievo/render/opengl/scene_renderer.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/core/depth_image.h"
#include "rilievo/gl/context.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/wall_test_helpers.h"

namespace rilievo {
namespace {

// Outward-facing tetrahedra: closed, so that culling by face may change nothing.
Mesh tetrahedron() {
  Mesh mesh;
  const glm::vec3 p[] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const int faces[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  for (const auto& f : faces) {
    const glm::vec3 n = glm::normalize(glm::cross(p[f[1]] - p[f[0]], p[f[2]] - p[f[0]]));
    for (int k : f) {
      mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
      mesh.positions.push_back(p[k]);
      mesh.normals.push_back(n);
    }
  }
  return mesh;
}

Scene random_scene(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(-1, 1);
  Scene scene;
  scene.name = "tetrahedra";
  scene.meshes = {tetrahedron()};
  Model model;
  model.parts = {Part{}};
  scene.models = {model};
  for (int i = 0; i < 25; ++i) {
    Object object;
    object.placement = glm::translate(glm::mat4(1), 3.0f * glm::vec3(u(rng), u(rng), u(rng)));
    object.placement =
        glm::rotate(object.placement, 3.0f * u(rng), glm::normalize(glm::vec3(u(rng), u(rng), 1)));
    // Mirrored ones too.
    object.placement = glm::scale(object.placement, glm::vec3(i % 3 ? 1.0f : -1.0f, 1.0f, 0.7f));
    scene.objects.push_back(object);
  }
  finish(scene);
  return scene;
}

struct Hit {
  std::uint32_t object = kNoObject;
  double eye_z = kNoDepth;
};

// The sample that the camera keeps on the ray through `raster`, by testing every triangle.
Hit cast(const Scene& scene, const Camera& camera, const glm::dvec2& raster) {
  const glm::dvec3 a = world_from_raster(camera, raster, camera.z_near);
  const glm::dvec3 b = world_from_raster(camera, raster, camera.z_far);
  Hit best;
  double best_t = camera.keeps_farthest() ? -1 : 2;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    const Mesh& mesh = scene.meshes[0];
    for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
      glm::dvec3 v[3];
      for (int c = 0; c < 3; ++c)
        v[c] = glm::dvec3(scene.objects[i].placement *
                          glm::vec4(mesh.positions[mesh.indices[k + c]], 1));
      const glm::dvec3 e1 = v[1] - v[0], e2 = v[2] - v[0], d = b - a, h = glm::cross(d, e2);
      const double det = glm::dot(e1, h);
      if (std::abs(det) < 1e-12) continue;
      const glm::dvec3 s = a - v[0], q = glm::cross(s, e1);
      const double x = glm::dot(s, h) / det, y = glm::dot(d, q) / det, t = glm::dot(e2, q) / det;
      if (x < 0 || y < 0 || x + y > 1 || t < 0 || t > 1) continue;
      if (camera.keeps_farthest() ? t > best_t : t < best_t) {
        best_t = t;
        best.object = i + 1;
      }
    }
  }
  if (best.object) {
    const glm::dvec3 eye =
        glm::dvec3(eye_from_world(camera) * glm::dvec4(glm::mix(a, b, best_t), 1));
    best.eye_z = -eye.z;
  }
  return best;
}

class SceneRendererTest : public testing::TestWithParam<Projection> {};

TEST_P(SceneRendererTest, shows_what_a_ray_caster_shows) {
  auto context = gl::Context::create();
  ASSERT_TRUE(context.ok()) << context.error().message();
  std::mt19937 rng(5);
  const Scene scene = random_scene(rng);
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();

  const glm::dvec3 eye(9, 5, 11);
  auto camera = tight_camera(GetParam(), eye, {0, 1, 0}, world_bounds(scene));
  ASSERT_TRUE(camera.ok());
  camera->width = 96, camera->height = 80;
  auto probe = ProbeTarget::create(camera->width, camera->height);
  ASSERT_TRUE(probe.ok());
  probe->begin(camera->keeps_farthest());
  std::vector<std::uint32_t> visible;
  renderer->cull(*camera, visible);
  EXPECT_EQ(visible.size(), scene.objects.size());
  renderer->draw_objects(*camera, visible);
  const auto objects = probe->read_objects();
  const auto depth = probe->read_eye_z(*camera);
  ASSERT_TRUE(gl::check_errors("test").ok());

  int covered = 0, wrong = 0;
  double worst = 0;
  for (int y = 0; y < camera->height; ++y)
    for (int x = 0; x < camera->width; ++x) {
      const Hit hit = cast(scene, *camera, {x + 0.5, y + 0.5});
      covered += hit.object != kNoObject;
      if (objects(x, y) != hit.object) {
        ++wrong;
      } else if (hit.object) {
        worst = std::max(worst, std::abs(depth(x, y) - hit.eye_z) / hit.eye_z);
      }
    }
  EXPECT_GT(covered, 1500);
  // Pixels whose centre lies within the rasteriser's 1/256 of an edge may go either way: of some
  // 1000 edge pixels that is a handful.
  EXPECT_LE(wrong, 10);
  // The same 1/256 of a pixel on the steepest face, and a float's rounding of window_z.
  EXPECT_LT(worst, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(AllProjections, SceneRendererTest,
                         testing::Values(Projection::perspective, Projection::back_perspective,
                                         Projection::parallel));

TEST(SceneRenderer, a_white_unlit_wall_fills_the_frame_with_white) {
  auto context = gl::Context::create();
  ASSERT_TRUE(context.ok());
  Material white;
  white.unlit = true;
  Scene scene = wall_scene(10, white);
  finish(scene);
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  for (int samples : {1, 4}) {
    auto target = FrameTarget::create(32, 16, samples);
    ASSERT_TRUE(target.ok()) << target.error().message();
    target->begin();
    const std::uint32_t all[] = {0};
    renderer->draw_opaque(look_at({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 1, 32, 16, 0.1, 10), all,
                          OutputEncoding::srgb);
    target->resolve();
    const Rgba8Image frame = target->read();
    for (const glm::u8vec4& texel : frame.texels()) ASSERT_EQ(texel, glm::u8vec4(255));
  }
}

// As where a picture that was refused leaves its share to polygons that already have another.
TEST(SceneRenderer, draws_all_shares_of_an_object) {
  auto context = gl::Context::create();
  ASSERT_TRUE(context.ok());
  Material white;
  white.unlit = true;
  Scene scene = wall_scene(10, white);
  scene.objects.resize(2, scene.objects[0]);
  scene.objects[1].placement[3].z = -1;
  finish(scene);
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  auto target = FrameTarget::create(64, 64, 4);
  ASSERT_TRUE(target.ok()) << target.error().message();
  const auto white_pixels = [&](std::span<const CrossFade> shares) {
    target->begin();
    renderer->draw_cross_fades(look_at({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 1, 64, 64, 0.1, 10), shares,
                               OutputEncoding::srgb);
    target->resolve();
    int count = 0;
    const Rgba8Image frame = target->read();
    for (const glm::u8vec4& texel : frame.texels()) count += texel.r == 255;
    return count;
  };
  const CrossFade three[] = {{0, 0.2f, 1}, {1, 0, 0.1f}, {0, 0, 0.2f}};
  EXPECT_EQ(white_pixels(three), 64 * 64);
  // The hash is evenly spread: a share of it is that share of the pixels, to 2 %.
  const CrossFade apart[] = {{0, 0, 0.2f}, {0, 0.4f, 0.6f}, {0, 0.9f, 1}};
  EXPECT_NEAR(white_pixels(apart), 0.5 * 64 * 64, 0.02 * 64 * 64);
  EXPECT_EQ(white_pixels({}), 0);
}

// One sun has a shader of its own; a lamp that gives no light calls for the one of any lights.
TEST(SceneRenderer, one_sun_lights_as_any_lights_do) {
  auto context = gl::Context::create();
  ASSERT_TRUE(context.ok());
  std::mt19937 rng(6);
  Scene scene = random_scene(rng);
  Light sun, lamp;
  sun.direction = glm::normalize(glm::vec3(-1, -3, -2)), sun.intensity = {3, 2, 1};
  lamp.kind = Light::Kind::point, lamp.intensity = glm::vec3(0);
  scene.lights = {sun};
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  const Camera camera = look_at({9, 5, 11}, {0, 0, 0}, {0, 1, 0}, 0.6, 96, 80, 0.1, 40);
  std::vector<std::uint32_t> visible;
  renderer->cull(camera, visible);
  const auto draw = [&] {
    auto target = FrameTarget::create(camera.width, camera.height, 1);
    EXPECT_TRUE(target.ok());
    target->begin();
    renderer->draw_opaque(camera, visible, OutputEncoding::srgb);
    target->resolve();
    return target->read();
  };
  const Rgba8Image sunlit = draw();
  scene.lights = {sun, lamp};  // may change while the renderer lives
  const Rgba8Image by_any = draw();
  scene.lights = {sun, sun};
  const Rgba8Image brighter = draw();
  int differing = 0;
  for (std::size_t i = 0; i < sunlit.texels().size(); ++i) {
    const glm::ivec4 a(sunlit.texels()[i]), b(by_any.texels()[i]);
    // The same sums in another order of rounding, on the edge between two bytes.
    for (int k = 0; k < 3; ++k) ASSERT_LE(std::abs(a[k] - b[k]), 1);
    differing += sunlit.texels()[i] != brighter.texels()[i];
  }
  EXPECT_GT(differing, 500);  // of some 2000 that show anything
}

}  // namespace
}  // namespace rilievo
