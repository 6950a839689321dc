#include "rilievo/capture/shaders/field_shader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/core/random.h"
#include "rilievo/render/rays/cast_picture.h"

namespace rilievo {
namespace {

glm::dvec3 random_place(Random& random, float reach) {
  return {random.between(-reach, reach), random.between(-reach, reach),
          random.between(-reach, reach)};
}

// By definition: in tiny steps until the distance changes its sign, then by halves.
double first_inside(const DistanceField& field, const glm::dvec3& origin,
                    const glm::dvec3& direction, double length) {
  const double step = 5e-4;
  for (double t = 0; t < length; t += step) {
    if (field.distance(origin + t * direction) > 0) continue;
    double out = std::max(0.0, t - step), in = t;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (out + in);
      (field.distance(origin + middle * direction) > 0 ? out : in) = middle;
    }
    return in;
  }
  return -1;
}

TEST(FieldShader, distances_never_claim_more_room_than_there_is) {
  Random random(5);
  for (const DistanceField& field : distance_fields())
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 a = random_place(random, 1.3f);
      const glm::dvec3 b = a + random_place(random, i % 2 ? 1.0f : 0.01f);
      // Of doubles about 1.
      EXPECT_LE(std::abs(field.distance(a) - field.distance(b)), glm::length(a - b) + 1e-13)
          << field.name;
      if (field.distance(a) < 0)
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_GE(a[axis], double(field.bounds.min[axis]) - 1e-6) << field.name;  // a float
          EXPECT_LE(a[axis], double(field.bounds.max[axis]) + 1e-6) << field.name;
        }
    }
}

TEST(FieldShader, rays_end_where_tiny_steps_end) {
  Random random(6);
  for (const DistanceField& field : distance_fields()) {
    int hits = 0, misses = 0;
    for (int i = 0; i < 150; ++i) {
      const glm::dvec3 origin = 2.0 * glm::normalize(random_place(random, 1));
      const glm::dvec3 way = glm::normalize(random_place(random, 1.1f) - origin);
      const double slow = first_inside(field, origin, way, 4);
      const double fast = trace_field(field, origin, way, 4, 1e-6);
      (slow < 0 ? misses : hits)++;
      if (fast < 0) {
        EXPECT_LT(slow, 0) << field.name;
        continue;
      }
      EXPECT_LE(field.distance(origin + fast * way), 1e-6);
      // Rays may end before a surface that they graze; never behind one.
      if (slow >= 0) {
        EXPECT_LE(fast, slow + 1e-6) << field.name;
      }
    }
    EXPECT_GT(hits, 30) << field.name;
    EXPECT_GT(misses, 5) << field.name;
  }
}

TEST(FieldShader, normals_are_the_gradient) {
  Random random(7);
  const DistanceField& torus = *find_distance_field("torus");
  const DistanceField& gyroid = *find_distance_field("gyroid");
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 p = random_place(random, 0.9f);
    const double ring = std::hypot(p.x, p.z);
    if (ring < 0.05 || std::hypot(ring - 0.7, p.y) < 0.05) continue;
    const glm::dvec3 core = 0.7 / ring * glm::dvec3(p.x, 0, p.z);
    // Differences over 1e-5 leave its square, times the third derivative.
    EXPECT_LT(glm::length(distance_normal(torus, p, 1e-5) - glm::normalize(p - core)), 1e-6);

    const glm::dvec3 s = glm::sin(7.0 * p), c = glm::cos(7.0 * p);
    const glm::dvec3 slope(c.x * c.y - s.z * s.x, c.y * c.z - s.x * s.y, c.z * c.x - s.y * s.z);
    const double value = s.x * c.y + s.y * c.z + s.z * c.x;
    if (std::abs(value) < 0.01 || glm::length(slope) < 0.1 || glm::length(p) > 0.8) continue;
    EXPECT_LT(glm::length(distance_normal(gyroid, p, 1e-5) -
                          (value < 0 ? -1.0 : 1.0) * glm::normalize(slope)),
              1e-6);
  }
}

// Placed and scaled, by every kind of camera, the picture's points lie on the surface.
TEST(FieldShader, pictures_have_their_depths_on_the_surface) {
  const FieldLook look{.center = {5, -3, 2}, .scale = 2.5};
  for (const DistanceField& field : distance_fields())
    for (int kind = 0; kind < 3; ++kind) {
      FieldShader shader(field, look);
      Camera camera = look_at({9, 1, 8}, look.center, {0, 1, 0}, 0.8, 40, 32, 3, 15);
      camera.projection = Projection(kind);
      if (camera.projection == Projection::parallel) camera.window = {-3, 3, -2.4, 2.4};
      const Result<CapturedPicture> captured =
          shader.capture({.camera = camera, .samples = 4, .farthest = true});
      ASSERT_TRUE(captured.ok());
      const Result<CapturedPicture> centers = shader.capture({.camera = camera, .samples = 1});
      ASSERT_TRUE(centers.ok());
      const CapturedPicture& plain = *centers;
      const DepthImage& picture = captured->picture;
      ASSERT_TRUE(validate(picture).ok());
      int covered = 0;
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 40; ++x) {
          if (!picture.covered(x, y)) continue;
          EXPECT_GT(picture.color(x, y).a, 0);
          // Beside a silhouette, the depth is that of a sample off the centre.
          if (!plain.picture.covered(x, y)) continue;
          ++covered;
          const glm::dvec3 world =
              world_from_raster(camera, {x + 0.5, y + 0.5}, double(picture.depth(x, y)));
          // A float at 15 m holds 1e-6 m; along rays that graze it is a distance all the same.
          EXPECT_NEAR(field.distance((world - look.center) / look.scale), 0, 3e-6) << field.name;
          if (!camera.keeps_farthest()) {
            EXPECT_LE(picture.depth(x, y), captured->farthest(x, y));
          }
        }
      EXPECT_GT(covered, 200) << field.name;
      const Box bounds = shader.bounds({});
      EXPECT_NEAR(double(bounds.center().x), 5, 1e-6);
    }
}

TEST(FieldShader, unknown_fields_are_nobody) {
  EXPECT_EQ(find_distance_field("mandelbulb"), nullptr);
  EXPECT_EQ(find_distance_field(""), nullptr);
}

}  // namespace
}  // namespace rilievo
