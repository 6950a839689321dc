#include "rilievo/layered_impostor/visual_hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {
namespace {

// The jug's parts by formula, `slack` larger.
bool in_jug(const glm::dvec3& p, double slack) {
  const glm::dvec3 body(p.x, p.y / 0.9, p.z);
  if (glm::length(body) < 1.0 + slack) return true;
  const glm::dvec3 h = p - glm::dvec3(1.1, 0.1, 0);  // the handle's axis is z
  const double ring = std::hypot(h.x, h.y) - 0.5;
  if (std::hypot(ring, h.z) < 0.1 + slack) return true;
  if (glm::length(p - glm::dvec3(0, 1, 0)) < 0.2 + slack) return true;
  const glm::dvec3 box = glm::abs(p - glm::dvec3(0, -0.85, 0)) - glm::dvec3(0.7, 0.1, 0.7);
  return std::max({box.x, box.y, box.z}) < slack;
}

TEST(Inside, a_point_is_carved_exactly_if_the_picture_looks_through_it) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  std::mt19937 rng(5);
  std::uniform_real_distribution<float> u(-1, 1);
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    const std::vector<DepthImage> pictures = test_shapes::cast_views(
        scene, make_view_set({.spread = ViewSpread::faces_12}), {.projection = kind, .size = 128});
    int cases = 0, wrong = 0;
    for (const DepthImage& picture : pictures) {
      const TexelSurface surface = make_texel_surface(picture);
      for (int i = 0; i < 500; ++i) {
        const glm::vec3 p(1.5f * u(rng), 1.1f * u(rng), u(rng));
        const glm::dvec3 at = raster_from_world(picture.camera, glm::dvec3(p));
        if (!(at.x >= 0 && at.y >= 0 && at.x < 128 && at.y < 128)) continue;
        const CameraRay ray = camera_ray(picture.camera, glm::dvec2(at));
        const double t = (at.z - ray.eye_z_start) / ray.eye_z_step;
        const bool hidden = rays->occluded(ray.origin, ray.direction, 0.0f, float(t));
        ++cases;
        wrong += is_carved(surface, glm::dvec3(p)) == hidden;
      }
    }
    EXPECT_GT(cases, 4000);
    // At outlines a texel's middle does not speak for all of it: they are some 300 texels long in a
    // picture of 16000, to either side of which half a texel is in doubt, and so is as much where
    // parts stand before each other.
    EXPECT_LT(wrong, cases / 25);
  }
}

TEST(Inside, reaches_into_what_is_solid_and_not_beyond) {
  const Result<LayeredImpostor> impostor = make_layered_impostor(
      test_shapes::cast_views(test_shapes::jug(), make_view_set({}), {.size = 128}), {});
  int with = 0, texels = 0, points = 0, outside = 0;
  double depth = 0;
  for (const TexelSurface& surface : impostor->surfaces) {
    const double step = (surface.camera.z_far - surface.camera.z_near) / 64;
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x) {
        const SurfaceTexel& texel = surface.texels(x, y);
        if (texel.q == 0) continue;
        ++texels;
        if (texel.inside == 0) continue;
        ++with;
        EXPECT_LT(texel.inside * texel.q, 1);  // away from the viewers, towards the apex
        depth += 1 / double(texel.q) - double(texel.inside);
        for (int i = 0; i <= 8; ++i) {
          const double z = glm::mix(1 / double(texel.q), double(texel.inside), i / 8.0);
          ++points;
          // Lines are two texels apart here, and two steps may be taken past the surface.
          outside += !in_jug(world_from_raster(surface.camera, {x + 0.5, y + 0.5}, z), 2 * step);
        }
      }
  }
  EXPECT_GT(with, texels / 2);
  EXPECT_GT(depth / with, 0.5);  // the body is 2 across
  // Between the handle and the body lies space that only some see through.
  EXPECT_LT(outside, points / 50);
}

// What find_visual_hulls() promises, one step after the other.
float inside_by_steps(std::span<const TexelSurface> surfaces, const TexelSurface& surface, int x,
                      int y) {
  const Camera& camera = surface.camera;
  const float q = surface.texels(x, y).q;
  const int size = camera.width, stride = (size + 63) / 64;
  const int u = std::min(x / stride * stride + stride / 2, size - 1);
  const int v = std::min(y / stride * stride + stride / 2, size - 1);
  if (q == 0 || surface.texels(u, v).q == 0) return 0;
  const double step = (camera.z_far - camera.z_near) / 64;
  double z = 1 / double(surface.texels(u, v).q);
  float reach = 0;
  for (int carved = 0, k = 0; k < 64; ++k) {
    z += camera.keeps_farthest() ? -step : step;
    if (!(z > camera.z_near && z < camera.z_far)) break;
    const glm::dvec3 world = world_from_raster(camera, {u + 0.5, v + 0.5}, z);
    bool hidden = true;
    for (const TexelSurface& other : surfaces) {
      if (&other == &surface) continue;
      const glm::dvec3 at = raster_from_world(other.camera, world);
      if (!(at.z > 0 && at.x >= 0 && at.y >= 0 && at.x < size && at.y < size)) continue;
      const SurfaceTexel& texel = other.texels(int(at.x), int(at.y));
      const double patch = surface_q(texel, glm::floor(glm::dvec2(at)) + 0.5, glm::dvec2(at));
      hidden &=
          texel.q != 0 && (other.camera.keeps_farthest() ? 1 / at.z >= patch : 1 / at.z <= patch);
    }
    carved = hidden ? 0 : carved + 1;
    if (carved == 2) break;
    if (hidden) reach = float(z);
  }
  const bool behind = camera.keeps_farthest() ? reach * q < 1 : reach * q > 1;
  return reach != 0 && behind ? reach : 0;
}

TEST(Inside, is_what_one_step_after_the_other_finds) {
  std::mt19937 rng(9);
  int with = 0, without = 0;
  for (Projection kind : {Projection::perspective, Projection::back_perspective})
    for (int size : {24, 96})
      for (double holes : {0.0, 0.02}) {
        std::vector<TexelSurface> surfaces;
        for (DepthImage& picture : test_shapes::cast_views(
                 test_shapes::jug(), make_view_set({.spread = ViewSpread::faces_12}),
                 {.projection = kind, .size = size})) {
          // Holes are seen through: lines then end anywhere.
          for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
              if (double(rng()) < holes * 0x1p32) {
                picture.depth(x, y) = kNoDepth;
                picture.color(x, y) = glm::vec4(0);
              }
          surfaces.push_back(make_texel_surface(picture));
        }
        find_visual_hulls(surfaces);
        for (const TexelSurface& surface : surfaces)
          for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
              const float inside = surface.texels(x, y).inside;
              ASSERT_EQ(inside, inside_by_steps(surfaces, surface, x, y));
              if (surface.texels(x, y).q != 0) ++(inside != 0 ? with : without);
            }
      }
  EXPECT_GT(with, 10000);
  EXPECT_GT(without, 10000);
}

// A line of sight into 64 steps of one metre, and a picture from the side with a column for each
// step, which sees some of them to be empty.
float reach_past(std::span<const int> empty_steps) {
  DepthImage line, side;
  line.camera = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.01, 1, 1, 1, 65);
  // At 100 m, one metre is a column: 128 of them, the middle at z = -36.
  side.camera = look_at({100, 0, -36}, {0, 0, -36}, {0, 1, 0}, 1, 128, 1, 1, 200);
  side.camera.window = {-0.64, 0.64, -0.005, 0.005};
  for (DepthImage* picture : {&line, &side}) {
    const int w = picture->camera.width;
    picture->color = ColorImage(w, 1, glm::vec4(1));
    picture->depth = Image<float>(w, 1, picture == &line ? 4.0f : 50.0f);
  }
  for (const int z : empty_steps) {
    // To the side's right is where the line comes from, or its left.
    const glm::dvec3 at = raster_from_world(side.camera, {0, 0, -double(z)});
    side.depth(int(at.x), 0) = kNoDepth;
    side.color(int(at.x), 0) = glm::vec4(0);
  }
  std::vector<TexelSurface> surfaces{make_texel_surface(line), make_texel_surface(side)};
  find_visual_hulls(surfaces);
  return surfaces[0].texels(0, 0).inside;
}

TEST(Inside, one_step_in_carved_space_is_passed_and_two_stop) {
  // Steps lie at 5, 6, ... metres: half a column off would be another column.
  EXPECT_FLOAT_EQ(reach_past({}), 64);
  EXPECT_FLOAT_EQ(reach_past(std::array{7}), 64);
  EXPECT_FLOAT_EQ(reach_past(std::array{7, 10}), 64);
  EXPECT_FLOAT_EQ(reach_past(std::array{7, 11, 12}), 10);
  EXPECT_FLOAT_EQ(reach_past(std::array{5, 6}), 0);
}

TEST(Inside, steps_too_short_to_change_a_depth_end) {
  DepthImage picture;
  picture.camera = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.01, 1, 1, std::nextafter(4.0, 0.0),
                           std::nextafter(4.0, 5.0));
  picture.color = ColorImage(1, 1, glm::vec4(1));
  picture.depth = Image<float>(1, 1, 4.0f);
  std::vector<TexelSurface> surfaces{make_texel_surface(picture)};
  find_visual_hulls(surfaces);
  EXPECT_EQ(surfaces[0].texels(0, 0).inside, 0);
}

}  // namespace
}  // namespace rilievo
