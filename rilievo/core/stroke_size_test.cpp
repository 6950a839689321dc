#include "rilievo/core/stroke_size.h"

#include <gtest/gtest.h>

#include <glm/glm.hpp>

#include "rilievo/core/random.h"

namespace rilievo {
namespace {

glm::dvec3 unit(Random& random) {
  for (;;) {
    const double x = double(random.between(-1, 1)), y = double(random.between(-1, 1)),
                 z = double(random.between(-1, 1));
    const glm::dvec3 v(x, y, z);
    if (glm::length(v) > 0.1 && glm::length(v) < 1) return glm::normalize(v);
  }
}

// Turned by the least rotation that takes one unit to another.
glm::dvec3 turned(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& u) {
  const glm::dvec3 axis = glm::cross(from, to), once = glm::cross(axis, u);
  return u + once + glm::cross(axis, once) / (1 + glm::dot(from, to));
}

// Of a disc at the origin that faced an eye and now faces another one.
TEST(StrokeSize, places_of_a_disc_stay_within_its_shift_of_the_same_colour) {
  Random random(4);
  double tightest = 0;
  for (int i = 0; i < 20000; ++i) {
    const double radius = double(random.between(0.01f, 2)), nearest = double(random.between(1, 5));
    const glm::dvec3 eye = unit(random) * (nearest * double(random.between(1, 2)));
    const double moved = double(random.between(0, 8));
    const glm::dvec3 now = eye + unit(random) * moved;
    if (glm::length(now) < 1e-3) continue;
    const glm::dvec3 from = glm::normalize(eye), to = glm::normalize(now);
    if (glm::dot(from, to) < -0.999) continue;
    const glm::dvec3 across = glm::cross(from, unit(random));
    if (glm::length(across) < 0.1) continue;
    const glm::dvec3 u = radius * glm::normalize(across);
    // The same place of the disc, or its centre: both have the disc's colour.
    const double off = std::min(glm::length(u - turned(from, to, u)), glm::length(u));
    const double shift = disc_shift(radius, moved, nearest);
    ASSERT_LE(off, shift * (1 + 1e-9)) << i;
    tightest = std::max(tightest, off / shift);
  }
  EXPECT_GT(tightest, 0.99);
}

TEST(StrokeSize, strips_of_texels_end_where_half_of_them_end) {
  // Three texels of four pixels each: six pixels from the middle, instead of one and a half.
  EXPECT_DOUBLE_EQ(strip_shift_px(3, 2), 4.5);
  EXPECT_DOUBLE_EQ(strip_difference_px(3, 2), 6);      // beyond the end of the line
  EXPECT_DOUBLE_EQ(strip_shift_px(3, 0.1), 0);         // they reach less far ...
  EXPECT_DOUBLE_EQ(strip_difference_px(3, 0.1), 1.5);  // ... by as much as all of it
}

}  // namespace
}  // namespace rilievo
