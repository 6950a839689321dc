#include "rilievo/frame/camera_from.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <vector>

#include "rilievo/core/random.h"

namespace rilievo {
namespace {

struct Convention {
  const char* name;
  ClipRange range;
  bool reversed, infinite;
};
constexpr Convention kConventions[] = {
    {"OpenGL", ClipRange::minus_one_to_one, false, false},
    {"[0, 1]", ClipRange::zero_to_one, false, false},
    {"reversed [0, 1]", ClipRange::zero_to_one, true, false},
    {"reversed [-1, 1]", ClipRange::minus_one_to_one, true, false},
    {"OpenGL without far plane", ClipRange::minus_one_to_one, false, true},
    {"[0, 1] without far plane", ClipRange::zero_to_one, false, true},
    {"reversed [0, 1] without far plane", ClipRange::zero_to_one, true, true},
};

// From the ends of the range: -c + e / near and -c + e / far are them.
glm::dmat4 projection(const Camera& camera, const Convention& of) {
  glm::dmat4 p(0.0);
  const ImageWindow& w = camera.window;
  p[0][0] = 2 / (w.right - w.left), p[2][0] = (w.right + w.left) / (w.right - w.left);
  p[1][1] = 2 / (w.top - w.bottom), p[2][1] = (w.top + w.bottom) / (w.top - w.bottom);
  p[2][3] = -1;
  const double low = of.range == ClipRange::minus_one_to_one ? -1 : 0;
  const double at_near = of.reversed ? 1 : low, at_far = of.reversed ? low : 1;
  const double one_over_far = of.infinite ? 0 : 1 / camera.z_far;
  const double e = (at_near - at_far) / (1 / camera.z_near - one_over_far);
  p[3][2] = e, p[2][2] = e * one_over_far - at_far;
  return p;
}

Camera random_camera(Random& random) {
  const auto coordinate = [&] { return double(random.between(-50, 50)); };
  Camera camera = look_at({coordinate(), coordinate(), coordinate()},
                          {coordinate(), coordinate(), coordinate()}, {0.1, 1, 0.2}, 0.9, 640, 360,
                          0.05 + random.unit(), 10 + 1000 * random.unit());
  camera.window.left -= 0.2 * random.unit(), camera.window.top += 0.2 * random.unit();
  return camera;
}

TEST(CameraFrom, finds_the_camera_of_every_convention_and_where_its_depths_lie) {
  Random random(7);
  for (const Convention& of : kConventions)
    for (int i = 0; i < 200; ++i) {
      SCOPED_TRACE(of.name);
      const Camera camera = random_camera(random);
      const glm::dmat4 clip = projection(camera, of);
      const Result<HostCamera> host =
          camera_from(eye_from_world(camera), clip, camera.width, camera.height, of.range);
      ASSERT_TRUE(host.ok()) << host.error().message();
      EXPECT_EQ(host->reversed, of.reversed);
      EXPECT_NEAR(host->camera.z_near / camera.z_near, 1, 1e-9);
      EXPECT_NEAR(
          host->camera.z_far / (of.infinite ? kFarOfInfinite * camera.z_near : camera.z_far), 1,
          1e-6);
      EXPECT_NEAR(host->camera.window.left, camera.window.left, 1e-9);
      EXPECT_NEAR(host->camera.window.right, camera.window.right, 1e-9);
      EXPECT_NEAR(host->camera.window.top, camera.window.top, 1e-9);
      EXPECT_NEAR(host->camera.window.bottom, camera.window.bottom, 1e-9);
      // What the host writes for a point, and what is to be written for it.
      const double d = camera.z_near * (1 + 20 * random.unit());
      const glm::dvec4 point = clip * glm::dvec4(0, 0, -d, 1);
      const double ndc = point.z / point.w;
      const double window = of.range == ClipRange::minus_one_to_one ? 0.5 * ndc + 0.5 : ndc;
      EXPECT_NEAR(host->depth_offset + host->depth_scale / d, window, 1e-9);
    }
}

TEST(CameraFrom, takes_matrices_of_single_precision) {
  const glm::mat4 view = glm::lookAt(glm::vec3(40, 3, -7), glm::vec3(1, 2, 3), glm::vec3(0, 1, 0));
  const glm::mat4 clip = glm::perspective(0.8f, 1.5f, 0.1f, 500.0f);
  const Result<HostCamera> host = camera_from(view, clip, 300, 200);
  ASSERT_TRUE(host.ok()) << host.error().message();
  EXPECT_NEAR(host->camera.z_near, 0.1, 1e-6);
  EXPECT_NEAR(host->camera.z_far, 500, 1);  // rounding: 1e-7 of 1, where 2 near / far is 4e-4
  EXPECT_NEAR(host->camera.position().x, 40, 1e-4);
}

TEST(CameraFrom, refuses_what_is_no_camera_and_says_why) {
  const Camera camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.8, 64, 64, 0.1, 100);
  const glm::dmat4 view = eye_from_world(camera), clip = clip_from_eye(camera);
  const auto flipped = [&](double x, double y) {
    return glm::scale(glm::dmat4(1), {x, y, 1.0}) * clip;
  };
  glm::dmat4 no_depth = clip;
  no_depth[3][2] = 0;
  glm::dmat4 broken = clip;
  broken[2][2] = NAN;
  struct Case {
    glm::dmat4 view, clip;
    const char *where, *reason;
  };
  for (const Case& one :
       {Case{glm::scale(view, glm::dvec3(2)), clip, "view", "scale"},
        Case{glm::scale(view, {-1.0, 1.0, 1.0}), clip, "view", "mirror"},
        Case{view, glm::ortho(-1.0, 1.0, -1.0, 1.0, 0.1, 10.0), "projection", "perspective"},
        Case{view, flipped(1, -1), "projection", "upside down"},
        Case{view, flipped(-1, 1), "projection", "mirrored"},
        Case{view, no_depth, "projection", "depth"}, Case{view, broken, "projection", ""}}) {
    const Result<HostCamera> host = camera_from(one.view, one.clip, 64, 64);
    ASSERT_FALSE(host.ok()) << one.reason;
    EXPECT_NE(host.error().where.find(one.where), std::string::npos);
    EXPECT_NE(host.error().reason.find(one.reason), std::string::npos) << host.error().reason;
  }
}

}  // namespace
}  // namespace rilievo
