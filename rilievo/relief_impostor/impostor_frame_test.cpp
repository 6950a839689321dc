// The frame's call into the workers: what it allocates, and where it expects the eye.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "rilievo/capture/callable_source.h"
#include "rilievo/core/count_allocations_test_helpers.h"
#include "rilievo/core/random.h"
#include "rilievo/relief_impostor/impostor_workers.h"

namespace rilievo {
namespace {

// A wall of two depths that fills the picture.
Result<CapturedPicture> wall_picture(const CaptureRequest& request) {
  CapturedPicture made;
  DepthImage& picture = made.picture;
  const Camera& camera = request.camera;
  picture.camera = camera;
  picture.depth_kind = DepthKind::eye_z;
  picture.color = ColorImage(camera.width, camera.height, glm::vec4(1));
  picture.depth = Image<float>(camera.width, camera.height, float(camera.z_near * 1.1));
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width / 2; ++x) picture.depth(x, y) = float(camera.z_far * 0.95);
  return made;
}

#ifndef RILIEVO_OPERATORS_ARE_TAKEN
TEST(ImpostorWorkers, a_frame_allocates_nothing) {
  CallableSource wall("wall", Box{glm::vec3(-1), glm::vec3(1)}, wall_picture);
  ImpostorWorkers workers({&wall}, {{}, {}}, {.size = 48});
  const void* volatile probe = new int;
  EXPECT_GT(allocations_here, 0u);  // they are counted
  delete static_cast<const int*>(probe);
  std::size_t allocated = 0, boards = 0;
  for (int frame = 0; frame < 400; ++frame) {
    const double angle = 0.01 * frame;
    const ImpostorEye eye{.position = {4 * std::sin(angle), 0.5, 4 * std::cos(angle)}};
    const std::size_t before = allocations_here;
    for (std::size_t object = 0; object < 2; ++object)
      boards += workers.frame(object, eye).board != nullptr;
    allocated += allocations_here - before;
    // With work on its way, and with none.
    if (frame % 3 == 0) workers.wait_until_idle();
  }
  EXPECT_EQ(allocated, 0u);
  EXPECT_GT(boards, 100u);
  EXPECT_GT(workers.stats().pictures, 4u);
}
#endif

// A frame that shows the picture from its own eye finds a texel's centre in each pixel's centre.
TEST(ImpostorCamera, texels_lie_on_the_frames_pixels_and_all_of_the_bounds_is_in_the_picture) {
  Random random(5);
  int aligned = 0;
  for (int round = 0; round < 400; ++round) {
    const auto any = [&](float reach) { return random.between(-reach, reach); };
    Box bounds;
    const glm::vec3 center{any(5), any(5), any(5)};
    bounds.add(center - random.between(0.1f, 1)), bounds.add(center + random.between(0.1f, 1));
    const glm::dvec3 eye{any(9), any(9), any(9)};
    const glm::dvec3 aside{any(1), any(1), any(1)};
    const Camera frame =
        look_at(eye, glm::dvec3(center) + aside, {0, 1, 0}, 0.9, 641, 360, 0.1, 99);
    const WorkerOptions options{.size = 512};
    const Result<Camera> camera = impostor_camera(bounds, impostor_eye(frame), options);
    if (!camera) continue;  // the eye is too near
    ASSERT_TRUE(validate(*camera));
    EXPECT_LE(std::max(camera->width, camera->height), options.size);
    for (const glm::vec3& corner : bounds.corners()) {
      const glm::dvec3 at = raster_from_world(*camera, corner);
      EXPECT_TRUE(at.x > -1e-6 && at.x < camera->width + 1e-6);
      EXPECT_TRUE(at.y > -1e-6 && at.y < camera->height + 1e-6);
    }
    if (!(glm::dmat3(camera->world_from_eye) == glm::dmat3(frame.world_from_eye))) continue;
    ++aligned;
    const glm::dvec2 texel{random.below(camera->width) + 0.5, random.below(camera->height) + 0.5};
    const glm::dvec3 seen = raster_from_world(frame, world_from_raster(*camera, texel, 2.0));
    EXPECT_NEAR(seen.x - std::floor(seen.x), 0.5, 1e-6);
    EXPECT_NEAR(seen.y - std::floor(seen.y), 0.5, 1e-6);
  }
  EXPECT_GT(aligned, 200);
}

TEST(ImpostorEye, one_that_goes_straight_is_expected_straight_on) {
  const ImpostorEye eye{.position = {1, 2, 3}, .velocity = {0, 0, 2}};
  EXPECT_EQ(predicted_eye(eye, 0.5), glm::dvec3(1, 2, 4));
}

TEST(ImpostorEye, one_on_an_orbit_is_expected_on_it) {
  // Around y, by half a radian a second, rising.
  const auto at = [](double t) {
    return glm::dvec3(3 * std::sin(0.5 * t), 0.2 * t, 3 * std::cos(0.5 * t));
  };
  const double now = 0.7;
  const ImpostorEye eye{.position = at(now),
                        .velocity = {1.5 * std::cos(0.5 * now), 0.2, -1.5 * std::sin(0.5 * now)},
                        .turn = {0, 0.5, 0}};
  for (const double ahead : {0.0, 0.01, 0.5, 2.0, 10.0})
    EXPECT_LT(glm::length(predicted_eye(eye, ahead) - at(now + ahead)), 1e-9) << ahead;
}

TEST(ImpostorWorkers, pictures_are_as_fine_as_the_frame_and_no_finer) {
  std::atomic<int> width{0};
  CallableSource wall("wall", Box{glm::vec3(-1), glm::vec3(1)}, [&](const CaptureRequest& request) {
    width = request.camera.width;
    return wall_picture(request);
  });
  ImpostorWorkers workers({&wall}, {{}}, {.size = 200});
  const auto seen_from = [&](double distance) {
    for (int i = 0; i < 6; ++i) {
      (void)workers.frame(0, {.position = {0, 0, distance}, .focal_px = 300});
      workers.wait_until_idle();
    }
    return width.load();
  };
  // The nearest corner of the box is as wide as its pixels.
  EXPECT_EQ(seen_from(7), 100);  // 2 metres, 6 away, 300 pixels a tangent
  EXPECT_EQ(seen_from(61), 10);
  EXPECT_EQ(seen_from(3), 200);  // 300 would be as fine as the frame
  // Half as far again changes nothing that is seen.
  EXPECT_EQ(seen_from(3.2), 200);
}

}  // namespace
}  // namespace rilievo
