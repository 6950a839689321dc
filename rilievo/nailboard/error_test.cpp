#include "rilievo/nailboard/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>
#include <vector>

#include "rilievo/core/depth.h"
#include "rilievo/core/sanitized_test_helpers.h"

namespace rilievo {
namespace {

// One picture, one frame, one motion: random, from nearly nothing to wild.
struct Case {
  PictureGeometry picture;
  Camera frame;
  RigidMotion motion;
};

glm::dvec3 random_direction(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(-1, 1);
  for (;;) {
    const glm::dvec3 p(u(rng), u(rng), u(rng));
    const double length = glm::length(p);
    if (length > 1e-3 && length <= 1) return p / length;
  }
}

Case random_case(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(0, 1);
  const auto power = [&](double low, double high) { return low * std::pow(high / low, u(rng)); };
  Case c;
  const glm::dvec3 object = 100.0 * random_direction(rng);
  const double distance = power(1, 1000);
  const glm::dvec3 eye = object + distance * random_direction(rng);
  Camera& capture = c.picture.capture;
  capture = look_at(eye, object, random_direction(rng), 1, 1, 1, 1, 2);
  // An off-axis window around the object, texels that need not be square.
  const double width = power(0.01, 0.8), height = power(0.01, 0.8);
  const double x = 0.3 * width * (u(rng) - 0.5), y = 0.3 * height * (u(rng) - 0.5);
  capture.window = {x - width / 2, x + width / 2, y - height / 2, y + height / 2};
  const double depth = std::min(0.8, power(0.01, 1));
  capture.z_near = distance * (1 - depth / 2), capture.z_far = distance * (1 + depth / 2);
  capture.width = int(power(4, 600)), capture.height = int(power(4, 600));
  c.picture = picture_geometry(capture);
  if (u(rng) < 0.3) c.picture.plane_z = glm::mix(capture.z_near, capture.z_far, u(rng));
  const int bits[] = {0, 2, 4, 6, 8, 16};
  c.picture.delta_bits = bits[rng() % 6];
  c.picture.depth_mode = DepthMode(rng() % 3);

  const glm::dvec3 moved = eye + distance * power(1e-4, 0.5) * random_direction(rng);
  const glm::dvec3 target = object + distance * 0.3 * u(rng) * random_direction(rng);
  c.frame = look_at(moved, target, random_direction(rng), 0.4 + u(rng), int(power(100, 2000)),
                    int(power(100, 2000)), distance * 0.01, distance * 10);
  if (u(rng) < 0.5) {
    glm::dmat4 turn = glm::translate(glm::dmat4(1), object);
    turn = glm::translate(turn, distance * power(1e-4, 0.1) * random_direction(rng));
    turn = glm::rotate(turn, power(1e-3, 0.3), random_direction(rng));
    c.motion.now_from_then = glm::translate(turn, -object);
  }
  return c;
}

glm::dvec3 moved(const Case& c, const glm::dvec3& then) {
  return glm::dvec3(c.motion.now_from_then * glm::dvec4(then, 1));
}

bool inside(const Camera& frame, const glm::dvec3& raster) {
  return raster.x >= 0 && raster.x <= frame.width && raster.y >= 0 && raster.y <= frame.height &&
         raster.z >= frame.z_near;
}

// A sample that the picture holds, drawn and where it belongs.
struct Shown {
  glm::dvec3 drawn, truth;  // frame's raster
};

Shown show(const Case& c, const glm::dvec2& texel, double d) {
  return {raster_from_world(
              c.frame, moved(c, world_from_raster(c.picture.capture, texel, c.picture.plane_z))),
          raster_from_world(c.frame, moved(c, world_from_raster(c.picture.capture, texel, d)))};
}

std::vector<glm::dvec2> spread(const Camera& capture, int n) {
  std::vector<glm::dvec2> texels;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      texels.emplace_back(double(x) / n * capture.width, double(y) / n * capture.height);
  return texels;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

TEST(PictureError, no_sample_slides_further_and_half_the_bound_is_too_small) {
  std::mt19937 rng(1);
  std::vector<double> tightness;
  int violations_of_half = 0, drawn_cases = 0, lost = 0;
  for (int i = 0; i < 5000; ++i) {
    const Case c = random_case(rng);
    const PictureError bound = bound_error(c.picture, c.frame, c.motion);
    ASSERT_EQ(bound.total_px, bound_total_px(c.picture, c.frame, c.motion));
    double worst = 0;
    for (const glm::dvec2& texel : spread(c.picture.capture, 8))
      for (double share : {0.0, 0.4, 1.0}) {
        const double d = glm::mix(c.picture.slab.front, c.picture.slab.back, share);
        const Shown s = show(c, texel, d);
        // What is drawn elsewhere is missing where it belongs.
        if (!inside(c.frame, s.drawn) && !inside(c.frame, s.truth)) continue;
        ASSERT_TRUE(bound.in_frame) << i;
        lost += !inside(c.frame, s.drawn);
        if (s.truth.z <= 0 || s.drawn.z < c.frame.z_near) {
          ASSERT_TRUE(std::isinf(bound.parallax_px)) << i;
          continue;
        }
        worst = std::max(worst, glm::length(glm::dvec2(s.drawn) - glm::dvec2(s.truth)));
      }
    // 1e-6 px: rounding of positions of 1000 m in doubles, magnified to pixels.
    ASSERT_LE(worst, bound.parallax_px + 1e-6) << i;
    drawn_cases += worst > 0;
    violations_of_half += worst > 0.5 * bound.parallax_px + 1e-6;
    if (worst > 0.25) tightness.push_back(bound.parallax_px / worst);
  }
  EXPECT_GT(drawn_cases, 3000);
  EXPECT_GT(lost, 2000);
  EXPECT_GT(violations_of_half, 2000);
  ASSERT_GT(tightness.size(), 1000u);
  RecordProperty("tightness_median", std::to_string(median(tightness)));
  // Samples fill the slab here, so that the bound is nearly met: only its separated maxima differ.
  EXPECT_LT(median(tightness), 1.3);
}

TEST(PictureError, every_pixel_shows_a_sample_that_belongs_nearby) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> u(0, 1);
  int pixels = 0, violations_of_half = 0;
  for (int i = 0; i < 3000; ++i) {
    const Case c = random_case(rng);
    const Camera& capture = c.picture.capture;
    const PictureError bound = bound_error(c.picture, c.frame, c.motion);
    if (!bound.in_frame || !std::isfinite(bound.total_px)) continue;
    // Points of the rectangle, drawn somewhere in the frame: as if a pixel's centre lay there.
    bool half_violated = false;
    for (int k = 0; k < 60; ++k) {
      const glm::dvec2 at(u(rng) * capture.width, u(rng) * capture.height);
      const glm::dvec2 centre = glm::floor(at) + 0.5;
      const double d = k % 2 ? c.picture.slab.front : c.picture.slab.back;
      const glm::dvec3 pixel = show(c, at, d).drawn;
      if (!inside(c.frame, pixel)) continue;
      ++pixels;
      const Shown sample = show(c, centre, d);
      const double off = glm::length(glm::dvec2(pixel) - glm::dvec2(sample.truth));
      ASSERT_LE(off, bound.total_px + std::sqrt(0.5) + 1e-6) << i;
      ASSERT_LE(glm::length(glm::dvec2(pixel) - glm::dvec2(sample.drawn)),
                bound.magnification_px + std::sqrt(0.5) + 1e-6)
          << i;
      half_violated |= off > 0.5 * bound.total_px + std::sqrt(0.5) + 1e-6;
    }
    violations_of_half += half_violated;
  }
  EXPECT_GT(pixels, 30000);
  EXPECT_GT(violations_of_half, 300);
}

// The depth that a frame writes for a texel at `texel` with true distance d, from first principles:
// lines of sight, planes, and screen depth; no formula of the implementation.
double drawn_depth(const Case& c, const glm::dvec2& texel, double d) {
  const Camera& capture = c.picture.capture;
  if (c.picture.depth_mode == DepthMode::flat) return show(c, texel, d).drawn.z;
  double delta = depth_from_eye_z(DepthKind::window_z, d, capture, texel);
  if (c.picture.delta_bits > 0)
    delta = decode_delta(encode_delta(float(delta), c.picture.delta_bits), c.picture.delta_bits);
  if (c.picture.depth_mode == DepthMode::exact) {
    const double stored = eye_z_from(DepthKind::window_z, delta, capture, texel);
    return raster_from_world(c.frame, moved(c, world_from_raster(capture, texel, stored))).z;
  }
  // The line of sight from the eye through the drawn place, in the object's space at capture.
  const glm::dvec3 eye =
      glm::dvec3(glm::inverse(c.motion.now_from_then) * glm::dvec4(c.frame.position(), 1));
  const glm::dvec3 q = world_from_raster(capture, texel, c.picture.plane_z);
  const auto hit = [&](double z) {  // where it meets the capture's plane eye_z = z
    const double at_eye = glm::dot(eye - capture.position(), capture.forward());
    const double at_q = glm::dot(q - capture.position(), capture.forward());
    return eye + (q - eye) * ((z - at_eye) / (at_q - at_eye));
  };
  const double n = raster_from_world(c.frame, moved(c, hit(capture.z_near))).z;
  const double f = raster_from_world(c.frame, moved(c, hit(capture.z_far))).z;
  const double z_n = depth_from_eye_z(DepthKind::window_z, n, c.frame, {});
  const double z_f = depth_from_eye_z(DepthKind::window_z, f, c.frame, {});
  return eye_z_from(DepthKind::window_z, z_n + (z_f - z_n) * delta, c.frame, {});
}

TEST(PictureError, no_depth_is_further_off_and_half_the_bound_is_too_small) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(0, 1);
  int violations_of_half[3] = {}, cases[3] = {};
  std::vector<double> tightness[3];
  for (int i = 0; i < sanitized_cases(6000); ++i) {
    const Case c = random_case(rng);
    const auto mode = std::size_t(c.picture.depth_mode);
    const PictureError bound = bound_error(c.picture, c.frame, c.motion);
    if (!bound.in_frame || !std::isfinite(bound.depth_relative)) continue;
    double worst = 0;
    for (const glm::dvec2& texel : spread(c.picture.capture, 4))
      for (int k = 0; k <= 30; ++k) {
        const double d = glm::mix(c.picture.slab.front, c.picture.slab.back, k / 30.0);
        const Shown s = show(c, texel, d);
        if (!inside(c.frame, s.drawn)) continue;
        worst = std::max(worst, std::abs(drawn_depth(c, texel, d) - s.truth.z) / s.truth.z);
      }
    // Delta's codes pass through a float: 2^-24 of the code's range, more than 1e-7 of the depth
    // only where the bound itself is wide.
    ASSERT_LE(worst, bound.depth_relative * (1 + 1e-3) + 2e-6) << i;
    ++cases[mode];
    violations_of_half[mode] += worst > 0.5 * bound.depth_relative + 2e-6;
    if (worst > 1e-4) tightness[mode].push_back(bound.depth_relative / worst);
  }
  for (std::size_t mode : {0, 1, 2}) {
    EXPECT_GT(cases[mode], sanitized_cases(1500));
    EXPECT_GT(violations_of_half[mode], sanitized_cases(700));
    EXPECT_LT(median(tightness[mode]), 1.5);
  }
}

TEST(PictureError, linear_depth_is_exact_under_rotation_about_the_eye) {
  std::mt19937 rng(4);
  for (int i = 0; i < 500; ++i) {
    Case c = random_case(rng);
    c.motion = {};
    c.picture.delta_bits = 0;
    c.picture.depth_mode = DepthMode::linear;
    const glm::dmat4 pose = c.frame.world_from_eye;
    c.frame.world_from_eye = pose;
    c.frame.world_from_eye[3] = c.picture.capture.world_from_eye[3];
    const PictureError bound = bound_error(c.picture, c.frame);
    EXPECT_LT(bound.depth_relative, 1e-9);  // rounding of positions of 1000 m in doubles
    EXPECT_LT(bound.parallax_px, 1e-6);
  }
}

TEST(PictureError, a_hidden_point_lies_near_the_one_that_hid_it) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(0, 1);
  int seen = 0, violations_of_half = 0;
  for (int i = 0; i < 4000; ++i) {
    const Case c = random_case(rng);
    const PictureError bound = bound_error(c.picture, c.frame, c.motion);
    double worst = 0;
    for (int k = 0; k < 60; ++k) {
      const glm::dvec2 texel(u(rng) * c.picture.capture.width, u(rng) * c.picture.capture.height);
      const double a = k % 2 ? u(rng) : 0, b = k % 2 ? a + (1 - a) * u(rng) : 1;
      const DepthSlab& slab = c.picture.slab;
      const glm::dvec3 hider = show(c, texel, glm::mix(slab.front, slab.back, a)).truth;
      const glm::dvec3 hidden = show(c, texel, glm::mix(slab.front, slab.back, b)).truth;
      if (!inside(c.frame, hidden)) continue;
      if (hider.z <= 0) {
        ASSERT_TRUE(std::isinf(bound.disocclusion_px));
        continue;
      }
      ++seen;
      worst = std::max(worst, glm::length(glm::dvec2(hider) - glm::dvec2(hidden)));
    }
    ASSERT_LE(worst, bound.disocclusion_px + 1e-6) << i;
    violations_of_half += worst > 0.5 * bound.disocclusion_px + 1e-6;
  }
  EXPECT_GT(seen, 50000);
  EXPECT_GT(violations_of_half, 1000);
}

TEST(PictureError, what_has_no_bound_is_infinite_and_what_is_not_seen_is_nothing) {
  std::mt19937 rng(6);
  Case c = random_case(rng);
  c.motion.now_from_then = glm::scale(glm::dmat4(1), glm::dvec3(1.01));
  EXPECT_TRUE(std::isinf(bound_error(c.picture, c.frame, c.motion).total_px));
  c.motion.now_from_then = glm::scale(glm::dmat4(1), glm::dvec3(-1, 1, 1));  // mirrored
  EXPECT_TRUE(std::isinf(bound_error(c.picture, c.frame, c.motion).total_px));
  c.motion.now_from_then[0][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isinf(bound_error(c.picture, c.frame, c.motion).total_px));

  c.motion = {};
  c.frame = c.picture.capture;
  c.frame.z_near *= 0.1;
  const PictureError same = bound_error(c.picture, c.frame);
  EXPECT_TRUE(same.in_frame);
  EXPECT_EQ(same.parallax_px, 0);
  EXPECT_NEAR(same.magnification_px, 0, 1e-9);             // texels are pixels
  c.frame.world_from_eye[0] = -c.frame.world_from_eye[0];  // turned away, half about up
  c.frame.world_from_eye[2] = -c.frame.world_from_eye[2];
  const PictureError away = bound_error(c.picture, c.frame);
  EXPECT_FALSE(away.in_frame);
  EXPECT_EQ(away.total_px, 0);
  // Inside the slab, looking on: some samples are behind the eye.
  c.frame = c.picture.capture;
  c.frame.z_near *= 1e-3;
  c.frame.world_from_eye[3] +=
      glm::dvec4(c.frame.forward() * (0.5 * (c.picture.plane_z + c.picture.slab.front)), 0);
  EXPECT_TRUE(std::isinf(bound_error(c.picture, c.frame).parallax_px));
}

TEST(PictureError, a_rectangle_that_slid_out_of_the_frame_is_wrong_while_its_objects_belong_there) {
  // 10 m wide at 10 to 20 m; its plane stands at 13.3 m. The eye steps to the side.
  PictureGeometry picture;
  picture.capture =
      look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 2 * std::atan(0.25), 128, 128, 10, 20);
  picture = picture_geometry(picture.capture);
  const auto step = [&](double x, double target_x) {
    Camera frame = look_at({x, 0, 0}, {target_x, 0, -20}, {0, 1, 0}, 0.2, 640, 640, 0.1, 100);
    return bound_error(picture, frame);
  };
  // The far side's right end, at x = 5, is in the middle; its ray meets the plane at x = 3.3.
  ASSERT_TRUE(step(50, 5).in_frame);
  EXPECT_GT(step(50, 5).parallax_px, 320);
  EXPECT_EQ(step(50, 5).magnification_px, 0);  // nothing of it is drawn
  EXPECT_EQ(step(50, 5).depth_relative, 0);
  // Narrowed to its front the plane is further away still: what lies behind comes into view first.
  narrow_slab(picture, {0, 0.1});
  ASSERT_TRUE(step(50, 5).in_frame);
  EXPECT_GT(step(50, 5).parallax_px, 10);
  EXPECT_LT(step(50, 5).parallax_px, 320);  // of what it shows, not of its whole frustum
  // Nothing of the frustum is in view.
  EXPECT_FALSE(step(50, 20).in_frame);
  EXPECT_EQ(step(50, 20).total_px, 0);
  // The near plane cuts the rectangle, but not what stands behind it.
  Camera near = picture.capture;
  near.z_near = 12;
  EXPECT_TRUE(std::isinf(bound_error(picture, near).total_px));
}

}  // namespace
}  // namespace rilievo
