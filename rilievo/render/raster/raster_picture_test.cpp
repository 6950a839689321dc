// Against a ray through every sample.
#include "rilievo/render/raster/raster_picture.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/core/color.h"
#include "rilievo/render/raster/sample_raster.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/shading/shading_test_helpers.h"

namespace rilievo {
namespace {

Mesh box_mesh(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(0.2f, 0.8f);
  const glm::vec3 half(u(rng), u(rng), u(rng));
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.emplace_back(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y,
                                i & 4 ? half.z : -half.z);
  mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                  2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
  return mesh;
}

// Boxes of all kinds: mirrored, open, single- and double-sided, unlit, blended, of one colour each.
Scene scene_to_rasterize(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(-1, 1);
  Scene scene;
  for (int m = 0; m < 5; ++m) {
    Material material;
    material.base_color = {0.5f + 0.4f * u(rng), 0.5f + 0.4f * u(rng), 0.5f + 0.4f * u(rng), 1};
    material.roughness = 0.9f;
    material.double_sided = m % 2;
    material.unlit = m == 3;
    if (m == 4) material.alpha_mode = AlphaMode::blend;
    scene.materials.push_back(material);
  }
  for (int m = -1; m < 5; ++m) {
    Mesh mesh = box_mesh(rng);
    mesh.material = m;
    if (m % 2) mesh.indices.resize(30);
    if (m == 2) mesh.colors.assign(8, {0.3f, 0.6f, 0.9f, 1});
    scene.meshes.push_back(mesh);
  }
  Model model;
  for (int m = 0; m < 6; ++m) {
    glm::mat4 place = glm::translate(glm::mat4(1), 1.5f * glm::vec3(u(rng), u(rng), u(rng)));
    if (m % 2) place = glm::scale(place, {-1, 0.7f, 1.2f});
    model.parts.push_back({m, place});
  }
  scene.models.push_back(model);
  for (int i = 0; i < 3; ++i) {
    Object object;
    object.placement =
        glm::translate(glm::mat4(1), glm::vec3(1000, 0, 0) + glm::vec3(u(rng), u(rng), u(rng)));
    object.placement = glm::rotate(object.placement, 3 * u(rng), {0.6f, 0.8f, 0});
    if (i == 1) object.placement = glm::scale(object.placement, {1, 1, -1.5f});
    scene.objects.push_back(object);
  }
  scene.lights = {default_sun()};
  finish(scene);
  return scene;
}

struct Expected {
  double depth = 1;
  int covered = 0;
  glm::dvec3 color{0.0};
};

// A ray through each sample, and the light of the face that it meets.
Expected by_rays(const RayScene& rays, const Camera& camera, int x, int y, int samples) {
  const Scene& scene = rays.scene();
  Expected e;
  for (int s = 0; s < samples; ++s) {
    const glm::dvec2 p = glm::dvec2(x, y) + glm::dvec2(sample_position(s, samples));
    const CameraRay ray = camera_ray(camera, {p.x, camera.height - p.y});
    const auto hit = rays.first_hit(ray.origin, ray.direction, 0, 1);
    if (!hit) continue;
    ++e.covered;
    const double eye_z = ray.eye_z_start + double(hit->distance) * ray.eye_z_step;
    e.depth = std::min(e.depth, depth_from_eye_z(DepthKind::window_z, eye_z, camera, {}));
    const Part& part = scene.models[0].parts[std::size_t(hit->part)];
    const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
    Material m;
    if (mesh.material >= 0) m = scene.materials[std::size_t(mesh.material)];
    if (!mesh.colors.empty()) m.base_color *= mesh.colors[0];
    glm::dvec3 n(hit->normal);
    if (glm::dot(n, ray.direction) > 0) n = -n;
    const Incident sun = incident_by_definition(scene.lights[0], {});
    const glm::dvec3 light =
        m.unlit ? glm::dvec3(m.base_color)
                : shade_by_definition(m, {&sun, 1}, scene.sky, n, -glm::normalize(ray.direction));
    for (int k = 0; k < 3; ++k)
      e.color[k] += 255.0 / samples * srgb_from_linear(float(std::min(1.0, light[k])));
  }
  return e;
}

TEST(PictureRasterizer, draws_what_rays_through_the_samples_meet) {
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> u(-1, 1);
  int compared = 0, at_edges = 0, other_coverage = 0, other_color = 0;
  for (int round = 0; round < 12; ++round) {
    const Scene scene = scene_to_rasterize(rng);
    const auto rays = RayScene::create(scene);
    ASSERT_TRUE(rays.ok());
    auto made = tight_camera(
        Projection::perspective,
        glm::dvec3(1000, 0, 0) + 8.0 * glm::normalize(glm::dvec3(u(rng), u(rng), u(rng))),
        {0.1, 1, 0.2}, world_bounds(scene));
    ASSERT_TRUE(made.ok());
    made->width = 41, made->height = 37;
    const int samples = round % 3 ? 4 : 1;
    PictureRasterizer rasterizer(scene);
    RasterPicture picture;
    const std::uint32_t all[] = {0, 1, 2};
    rasterizer.draw(*made, all, rays->poses(), samples, picture);
    ASSERT_EQ(picture.width, 41);
    ASSERT_EQ(picture.height, 37);
    for (int y = 0; y < 37; ++y)
      for (int x = 0; x < 41; ++x) {
        const std::size_t i = std::size_t(y * 41 + x);
        const Expected e = by_rays(*rays, *made, x, y, samples);
        ++compared;
        const int alpha = int(std::floor(255.0 * e.covered / samples + 0.5));
        if (picture.color[i].a != alpha) {
          ++other_coverage;
          continue;
        }
        if (e.covered == 0) {
          ASSERT_EQ(picture.color[i], glm::u8vec4(0));
          ASSERT_EQ(picture.depth[i], 1.0f);
          continue;
        }
        at_edges += e.covered < samples;
        // Where two faces meet, rounding may take a sample from one to the other.
        bool alike = std::abs(picture.depth[i] - e.depth) < 1e-4;
        for (int k = 0; k < 3; ++k)
          alike &= std::abs(double(picture.color[i][k]) - e.color[k]) <= 1.5;
        other_color += !alike;
      }
  }
  EXPECT_GT(compared, 15'000);
  EXPECT_GT(at_edges, 200);
  EXPECT_LE(other_coverage, compared / 500);
  EXPECT_LE(other_color, compared / 500);
}

TEST(PictureRasterizer, the_farthest_surface_is_the_last_that_rays_meet) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> u(-1, 1);
  int compared = 0, behind = 0, differ = 0;
  for (int round = 0; round < 8; ++round) {
    Scene scene = scene_to_rasterize(rng);
    for (Material& material : scene.materials) material.alpha_mode = AlphaMode::opaque;
    const auto rays = RayScene::create(scene);
    ASSERT_TRUE(rays.ok());
    auto made = tight_camera(
        Projection::perspective,
        glm::dvec3(1000, 0, 0) + 8.0 * glm::normalize(glm::dvec3(u(rng), u(rng), u(rng))),
        {0.1, 1, 0.2}, world_bounds(scene));
    ASSERT_TRUE(made.ok());
    made->width = 41, made->height = 37;
    PictureRasterizer rasterizer(scene);
    RasterPicture picture;
    std::vector<float> farthest;
    const std::uint32_t all[] = {0, 1, 2};
    rasterizer.draw(*made, all, rays->poses(), 1, picture);
    rasterizer.draw_farthest(*made, all, rays->poses(), farthest);
    for (int y = 0; y < 37; ++y)
      for (int x = 0; x < 41; ++x) {
        // By definition: each triangle's plane, if the ray passes through the triangle.
        const CameraRay ray = camera_ray(*made, {x + 0.5, 36.5 - y});
        double last = -1;
        for (const Part& part : scene.models[0].parts)
          for (std::size_t o = 0; o < 3; ++o) {
            const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
            const glm::dmat4 place(rays->poses()[o] * part.model_from_mesh);
            for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
              glm::dvec3 p[3];
              for (std::size_t k = 0; k < 3; ++k)
                p[k] = glm::dvec3(place *
                                  glm::dvec4(glm::dvec3(mesh.positions[mesh.indices[t + k]]), 1));
              const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
              const double towards = glm::dot(n, ray.direction);
              if (std::abs(towards) < 1e-12) continue;
              const double distance = glm::dot(n, p[0] - ray.origin) / towards;
              const glm::dvec3 at = ray.origin + distance * ray.direction;
              bool inside = distance > 0;
              for (std::size_t k = 0; k < 3 && inside; ++k)
                inside = glm::dot(glm::cross(p[(k + 1) % 3] - p[k], at - p[k]), n) >= 0;
              if (inside) last = std::max(last, distance);
            }
          }
        const std::size_t i = std::size_t(y * 41 + x);
        ++compared;
        const double expected =
            last < 0 ? 1.0
                     : depth_from_eye_z(DepthKind::window_z,
                                        ray.eye_z_start + last * ray.eye_z_step, *made, {});
        // Where two faces meet, rounding may take a ray past both.
        if (std::abs(double(farthest[i]) - expected) > 1e-4) ++differ;
        behind += farthest[i] < 1 && farthest[i] > picture.depth[i] + 1e-3f;
      }
  }
  EXPECT_GT(compared, 10'000);
  EXPECT_GT(behind, 1000);
  EXPECT_LE(differ, compared / 500);
}

TEST(PictureRasterizer, draws_the_same_bytes_with_one_thread) {
  std::mt19937 rng(3);
  const Scene scene = scene_to_rasterize(rng);
  std::vector<glm::mat4> poses;
  pose(scene, 0, poses);
  auto camera = tight_camera(Projection::perspective, {1000, 3, 9}, {0, 1, 0}, world_bounds(scene));
  ASSERT_TRUE(camera.ok());
  camera->width = camera->height = 200;
  const std::uint32_t all[] = {2, 0, 1};
  const auto draw = [&] {
    PictureRasterizer rasterizer(scene);
    RasterPicture picture;
    rasterizer.draw(*camera, all, poses, 4, picture);
    return picture;
  };
  const RasterPicture many = draw();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const RasterPicture one = draw();
  EXPECT_EQ(one.color, many.color);
  EXPECT_EQ(one.depth, many.depth);
}

}  // namespace
}  // namespace rilievo
