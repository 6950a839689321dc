// How far do points and lines in a picture reach from those of the frame? Against random ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rilievo/core/random.h"
#include "rilievo/nailboard/error.h"

namespace rilievo {
namespace {

// Turned by the least rotation that takes one unit to another.
glm::dvec3 turned_by(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& u) {
  const glm::dvec3 axis = glm::cross(from, to), once = glm::cross(axis, u);
  return u + once + glm::cross(axis, once) / (1 + glm::dot(from, to));
}

TEST(StrokesError, discs_that_turn_to_another_eye_stay_within_the_bound) {
  Random random(11);
  const auto number = [&](double low, double high) {
    return low + (high - low) * double(random.unit());
  };
  int tested = 0;
  double tightest = 0;
  for (int i = 0; i < 300; ++i) {
    Camera capture = look_at({0, 0, 0}, {number(-1, 1), number(-1, 1), -5}, {0, 1, 0},
                             number(0.3, 1.2), 200, 200, 3, 12);
    PictureGeometry picture = picture_geometry(capture);
    picture.strokes.disc_radius = number(0.01, 0.3);
    const glm::dvec3 eye(number(-1, 1), number(-1, 1), number(-1, 1.5));
    const Camera frame = look_at(number(0, 1) * eye, {number(-1, 1), number(-1, 1), -6},
                                 {0.1, 1, 0}, number(0.5, 1.3), 320, 200, 0.1, 100);
    const double bound_px = bound_error(picture, frame).stroke_px;
    ASSERT_NEAR(bound_error(picture, frame).total_px, bound_total_px(picture, frame), 1e-12);
    for (int k = 0; k < 60; ++k) {
      const glm::dvec3 c =
          world_from_raster(capture, {number(0, 200), number(0, 200)}, number(3, 12));
      const glm::dvec3 to_new = c - frame.position();
      const glm::dvec3 from = glm::normalize(c), to = glm::normalize(to_new);
      glm::dvec3 u = glm::cross(from, glm::dvec3(number(-1, 1), number(-1, 1), number(-1, 1)));
      if (glm::length(u) < 0.1) continue;
      u *= picture.strokes.disc_radius / glm::length(u);
      const glm::dvec3 turned = turned_by(from, to, u);
      ASSERT_NEAR(glm::dot(turned, to), 0, 1e-9);
      const glm::dvec3 drawn = raster_from_world(frame, c + u),
                       real = raster_from_world(frame, c + turned);
      if (!(drawn.z > frame.z_near && real.z > frame.z_near)) continue;
      const auto within = [&](const glm::dvec3& at) {
        return at.x >= 0 && at.y >= 0 && at.x <= frame.width && at.y <= frame.height;
      };
      if (!within(drawn)) continue;
      ++tested;
      const double off = glm::length(glm::dvec2(drawn) - glm::dvec2(real));
      ASSERT_LE(off, bound_px) << i;
      if (bound_px > 0) tightest = std::max(tightest, off / bound_px);
    }
  }
  EXPECT_GT(tested, 3000);
  EXPECT_GT(tightest, 0.05);  // no bound of nothing
}

TEST(StrokesError, from_the_capture_eye_discs_are_the_same_whatever_the_frame_looks_at) {
  const Camera capture = look_at({1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 0.8, 256, 256, 1, 10);
  PictureGeometry picture = picture_geometry(capture);
  picture.strokes.disc_radius = 0.5;
  const Camera frame = look_at({1, 2, 3}, {0.5, 0.3, 0}, {0, 1, 0.2}, 0.9, 256, 256, 0.1, 10);
  EXPECT_NEAR(bound_error(picture, frame).stroke_px, 0, 1e-4);
}

TEST(StrokesError, lines_that_are_captured_a_texel_wide_count_by_how_large_texels_are) {
  const Camera capture = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.8, 100, 100, 4, 6);
  PictureGeometry picture = picture_geometry(capture);
  const Camera frame = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.8, 800, 800, 0.1, 10);
  const double without = bound_total_px(picture, frame);
  picture.strokes.texels = 1;
  // A texel is 8 pixels wide: half a strip reaches 4 pixels, and its corner more, instead of half.
  EXPECT_GE(bound_total_px(picture, frame) - without, 3.5);
  EXPECT_LE(bound_total_px(picture, frame) - without, 4 * std::sqrt(2.0) + 0.5);
}

}  // namespace
}  // namespace rilievo
