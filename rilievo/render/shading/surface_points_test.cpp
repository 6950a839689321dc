#include "rilievo/render/shading/surface_points.h"

#include <gtest/gtest.h>

#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <random>

#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

struct Case {
  SurfaceMaterial material;
  SurfacePlacement placement;
  PictureRays picture;
  TriangleRays rays;
};

// Rays through triangles; `beside`: past their corners.
std::unique_ptr<Case> random_case(unsigned seed, bool beside) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> u(-1, 1);
  auto c = std::make_unique<Case>();
  SurfacePlacement& p = c->placement;
  p.relative_from_mesh = glm::translate(glm::mat4(1), {u(rng), u(rng), -6.0f});
  p.relative_from_mesh = glm::rotate(p.relative_from_mesh, 3.0f * u(rng), {0.6f, 0, 0.8f});
  p.relative_from_mesh = glm::scale(p.relative_from_mesh, {seed % 2 ? -1.0f : 1.0f, 1.3f, 0.8f});
  p.normal_from_mesh = glm::transpose(glm::inverse(glm::mat3(p.relative_from_mesh)));
  p.has_normals = seed % 3 != 0, p.has_colors = seed % 5 != 0;
  SurfaceMaterial& m = c->material;
  m.base_color = {0.5f, 0.7f, 0.9f, 1};
  m.emissive = {0.1f, 0.2f, 0.3f};
  m.roughness = 0.4f, m.metallic = 0.6f, m.unlit = seed % 4 == 0;
  p.material = &m, p.unlit = m.unlit;
  c->rays.count = 1 + seed % TriangleRays::kMaxCount;
  for (std::size_t i = 0; i < c->rays.count; ++i) {
    glm::vec3 meets(0.0f), weights(1.01f + u(rng), 1.01f + u(rng), 1.01f + u(rng));
    weights /= weights.x + weights.y + weights.z;
    if (beside) {
      weights = glm::vec3(-0.1f);
      weights[int(i % 3)] = 1.2f;  // past a corner
    }
    const glm::vec3 center(u(rng), u(rng), u(rng));
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 corner = center + 0.3f * glm::vec3(u(rng), u(rng), u(rng));
      meets += weights[k] * glm::vec3(p.relative_from_mesh * glm::vec4(corner, 1));
      const glm::vec3 normal = glm::normalize(glm::vec3(u(rng), u(rng), 2.0f));
      for (int axis = 0; axis < 3; ++axis) {
        c->rays.position[k][axis][i] = corner[axis];
        c->rays.normal[k][axis][i] = normal[axis];
        c->rays.color[k][axis][i] = 0.5f + 0.5f * u(rng);
      }
    }
    meets *= 2 + u(rng);
    for (int axis = 0; axis < 3; ++axis) c->rays.ray[axis][i] = meets[axis];
  }
  return c;
}

glm::dvec3 get(const float (&v)[3][TriangleRays::kCapacity], std::size_t i) {
  return {v[0][i], v[1][i], v[2][i]};
}

glm::dvec3 get(const Surfaces& s, Surfaces::Field first, std::size_t i) {
  return {s.field[first][i], s.field[first + 1][i], s.field[first + 2][i]};
}

TEST(SurfacePoints, are_where_the_rays_meet_the_triangles) {
  for_each_instruction_set([](const char* name) {
    auto surfaces = std::make_unique<Surfaces>();
    for (unsigned seed = 1; seed < 130; ++seed) {
      const auto c = random_case(seed, false);
      const SurfacePlacement& p = c->placement;
      const std::size_t before = surfaces->count = seed % 100;
      append_surfaces(c->rays, c->picture, p, *surfaces);
      ASSERT_EQ(surfaces->count, before + c->rays.count);
      for (std::size_t i = 0; i < c->rays.count; ++i) {
        const glm::dvec3 ray = get(c->rays.ray, i);
        glm::dvec3 corner[3];
        for (int k = 0; k < 3; ++k)
          corner[k] = glm::dvec3(glm::dmat4(p.relative_from_mesh) *
                                 glm::dvec4(get(c->rays.position[k], i), 1));
        const glm::dvec3 facing = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
        const double flat =
            std::abs(glm::dot(facing, ray)) / glm::length(facing) / glm::length(ray);
        if (flat < 0.02) continue;  // seen edge on, a float does not say where
        // A ray divided into the corners.
        glm::dvec3 weights = glm::inverse(glm::dmat3(corner[0], corner[1], corner[2])) * ray;
        weights /= weights.x + weights.y + weights.z;
        const auto mixed = [&](const float(&v)[3][3][TriangleRays::kCapacity]) {
          return weights.x * get(v[0], i) + weights.y * get(v[1], i) + weights.z * get(v[2], i);
        };
        const glm::dvec3 relative =
            weights.x * corner[0] + weights.y * corner[1] + weights.z * corner[2];
        glm::dvec3 n =
            p.has_normals ? glm::dmat3(p.normal_from_mesh) * mixed(c->rays.normal) : facing;
        const bool edge_on = std::abs(glm::dot(glm::normalize(facing), glm::normalize(n))) < 1e-3;
        if (glm::dot(facing, ray) * glm::dot(facing, n) > 0) n = -n;
        const glm::dvec3 base = glm::dvec3(c->material.base_color) *
                                (p.has_colors ? mixed(c->rays.color) : glm::dvec3(1));
        const std::size_t at = before + i;
        // Floats of some metres, times how flatly the ray meets the triangle.
        const double near = 1e-5 / flat;
        const auto expect_near = [&](Surfaces::Field field, const glm::dvec3& expected,
                                     double tolerance, const char* what) {
          ASSERT_LE(glm::length(get(*surfaces, field, at) - expected), tolerance)
              << name << ", case " << seed << ": " << what << " " << i;
        };
        expect_near(Surfaces::relative_x, relative, near, "position");
        if (!edge_on) {
          const glm::dvec3 found = glm::normalize(get(*surfaces, Surfaces::normal_x, at));
          ASSERT_LE(glm::length(found - glm::normalize(n)), 20 * near) << name << ", case " << seed;
        }
        expect_near(Surfaces::base_r, base, 20 * near, "colour");
        expect_near(Surfaces::view_x, -glm::normalize(ray), 20 * near, "view");
        expect_near(Surfaces::emissive_r, glm::dvec3(c->material.emissive), 0, "emission");
        expect_near(Surfaces::roughness, {0.4f, 0.6f, 1}, 0, "material");
        ASSERT_EQ(surfaces->field[Surfaces::lit][at], c->material.unlit ? 0.0f : 1.0f);
      }
    }
  });
}

// A texel's middle may lie beside a triangle that covers one of its samples.
TEST(SurfacePoints, stay_on_the_triangle_where_the_ray_passes_by) {
  auto surfaces = std::make_unique<Surfaces>();
  for (unsigned seed = 1; seed < 60; ++seed) {
    const auto c = random_case(seed, true);
    surfaces->count = 0;
    append_surfaces(c->rays, c->picture, c->placement, *surfaces);
    for (std::size_t i = 0; i < c->rays.count; ++i) {
      const glm::dvec3 corner = glm::dvec3(glm::dmat4(c->placement.relative_from_mesh) *
                                           glm::dvec4(get(c->rays.position[i % 3], i), 1));
      ASSERT_LE(glm::length(get(*surfaces, Surfaces::relative_x, i) - corner), 1e-4)
          << seed << " " << i;
    }
  }
}

TEST(SurfacePoints, are_the_same_bytes_on_every_instruction_set) {
  const auto c = random_case(62, true);
  const auto expected = std::make_unique<Surfaces>(), surfaces = std::make_unique<Surfaces>();
  append_surfaces(c->rays, c->picture, c->placement, *expected);
  for_each_instruction_set([&](const char* name) {
    surfaces->count = 0;
    append_surfaces(c->rays, c->picture, c->placement, *surfaces);
    for (int field = 0; field < Surfaces::kFields; ++field)
      EXPECT_EQ(std::memcmp(surfaces->field[field], expected->field[field],
                            expected->count * sizeof(float)),
                0)
          << name << ", field " << field;
  });
}

}  // namespace
}  // namespace rilievo
