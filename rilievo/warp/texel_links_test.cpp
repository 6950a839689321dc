#include "rilievo/warp/texel_links.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace rilievo {
namespace {

// What a ray in eye space meets: eye_z and which surface, 0 for none.
struct Met {
  double eye_z = 1e300;
  int surface = 0;
};
using Shape = std::function<Met(const glm::dvec3& origin, const glm::dvec3& direction)>;

DepthImage picture_of(const Camera& camera, const Shape& shape, Image<int>& surfaces) {
  DepthImage picture;
  picture.camera = camera;
  picture.color = ColorImage(camera.width, camera.height);
  picture.depth = Image<float>(camera.width, camera.height, kNoDepth);
  surfaces = Image<int>(camera.width, camera.height, 0);
  const bool parallel = camera.projection == Projection::parallel;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      glm::dvec3 at = world_from_raster(camera, {x + 0.5, y + 0.5}, 1.0);
      const glm::dvec3 origin = parallel ? glm::dvec3(at.x, at.y, 0) : glm::dvec3(0);
      const Met met = shape(origin, parallel ? glm::dvec3(0, 0, -1) : at);
      if (!met.surface) continue;
      picture.depth(x, y) = float(met.eye_z);
      surfaces(x, y) = met.surface;
    }
  return picture;
}

Met sphere(const glm::dvec3& origin, const glm::dvec3& direction, const glm::dvec3& center,
           double radius) {
  const glm::dvec3 o = origin - center;
  const double a = glm::dot(direction, direction), b = glm::dot(o, direction);
  const double disc = b * b - a * (glm::dot(o, o) - radius * radius);
  if (disc < 0) return {};
  const double t = (-b - std::sqrt(disc)) / a;
  return {-(origin.z + t * direction.z), 1};
}

Camera camera_of(Projection projection, int size) {
  Camera camera;
  camera.projection = projection;
  camera.width = camera.height = size;
  camera.z_near = 0.5, camera.z_far = 50;
  if (projection == Projection::parallel) camera.window = {-3, 3, -3, 3};
  return camera;
}

TEST(TexelLinks, a_plane_is_one_surface_however_it_tilts) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const Camera camera = camera_of(i % 2 ? Projection::perspective : Projection::parallel, 24);
    const glm::dvec3 normal = glm::normalize(glm::dvec3(u(rng), u(rng), u(rng)));
    const double offset = glm::dot(normal, glm::dvec3(0, 0, -5));
    Image<int> surfaces;
    const DepthImage picture = picture_of(
        camera,
        [&](const glm::dvec3& o, const glm::dvec3& d) -> Met {
          const double t = (offset - glm::dot(normal, o)) / glm::dot(normal, d);
          const double eye_z = -(o.z + t * d.z);
          return eye_z > 1 && eye_z < 40 ? Met{eye_z, 1} : Met{};
        },
        surfaces);
    LinkOptions options;
    options.steepest = 1e9f;
    const Image<std::uint8_t> links = texel_links(picture, options);
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x)
        for (int k = 0; k < 8; ++k) {
          const glm::ivec2 b = glm::ivec2(x, y) + kLinkSteps[k];
          const bool inside = b.x >= 0 && b.y >= 0 && b.x < 24 && b.y < 24;
          if (!picture.covered(x, y) || !inside || !picture.covered(b.x, b.y)) {
            EXPECT_FALSE(links(x, y) >> k & 1);
            continue;
          }
          // A pair without a third texel on its line cannot be told from two surfaces.
          const glm::ivec2 before = glm::ivec2(x, y) - kLinkSteps[k], after = b + kLinkSteps[k];
          const auto there = [&](glm::ivec2 p) {
            return p.x >= 0 && p.y >= 0 && p.x < 24 && p.y < 24 && picture.covered(p.x, p.y);
          };
          if (there(before) || there(after)) {
            EXPECT_TRUE(links(x, y) >> k & 1) << i << " at " << x << " " << y << " link " << k;
          }
        }
  }
}

TEST(TexelLinks, spheres_in_front_of_each_other_are_told_apart) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> u(-1, 1);
  int same = 0, same_missed = 0, apart = 0, apart_missed = 0;
  for (int i = 0; i < 60; ++i) {
    const Camera camera = camera_of(i % 3 ? Projection::perspective : Projection::parallel, 64);
    std::vector<glm::dvec4> balls;
    for (int k = 0; k < 5; ++k)
      balls.emplace_back(2.5 * u(rng), 2.5 * u(rng), -7 - 3 * u(rng), 1.2 + u(rng));
    Image<int> surfaces;
    const DepthImage picture = picture_of(
        camera,
        [&](const glm::dvec3& o, const glm::dvec3& d) {
          Met best;
          for (int k = 0; k < int(balls.size()); ++k) {
            Met met = sphere(o, d, glm::dvec3(balls[k]), balls[k].w);
            if (met.surface && met.eye_z > 0 && met.eye_z < best.eye_z)
              best = met, best.surface = k + 1;
          }
          return best;
        },
        surfaces);
    const Image<std::uint8_t> links = texel_links(picture);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        for (int k = 0; k < 8; ++k) {
          const glm::ivec2 b = glm::ivec2(x, y) + kLinkSteps[k];
          if (b.x < 0 || b.y < 0 || b.x > 63 || b.y > 63) continue;
          if (!picture.covered(x, y) || !picture.covered(b.x, b.y)) continue;
          const bool linked = links(x, y) >> k & 1;
          EXPECT_EQ(linked, bool(links(b.x, b.y) >> ((k + 4) % 8) & 1));
          if (surfaces(x, y) == surfaces(b.x, b.y))
            ++same, same_missed += !linked;
          else if (std::abs(picture.depth(x, y) - picture.depth(b.x, b.y)) > 2.5)
            // Eight texels' widths of depth at the farthest ball: steeper than is believed at once.
            ++apart, apart_missed += linked;
        }
  }
  EXPECT_GT(same, 100000);
  EXPECT_GT(apart, 1500);
  // At its outline a ball falls off steeper than any rule allows: one pair in a hundred may be
  // given up, and as few jumps may look like the steps beside them.
  EXPECT_LT(same_missed, same / 100);
  EXPECT_LT(apart_missed, apart / 100);
}

}  // namespace
}  // namespace rilievo
