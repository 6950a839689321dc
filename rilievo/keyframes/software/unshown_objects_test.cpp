#include "rilievo/keyframes/software/unshown_objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <set>

#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/keyframes/make_keyframe.h"

namespace rilievo {
namespace {

constexpr int kViewWidth = 96, kViewHeight = 64;

void add_box(Scene& scene, const glm::vec3& center, const glm::vec3& half) {
  test_shapes::add(scene, test_shapes::box(half), {0.6f, 0.6f, 0.6f},
                   glm::translate(glm::mat4(1), center));
}

Camera view_from(const glm::dvec3& eye) {
  return look_at(eye, eye + glm::dvec3(0, 0, -1), {0, 1, 0}, 0.9, kViewWidth, kViewHeight, 0.1,
                 100);
}

// Posts before many boxes before a wall.
Scene posts_and_boxes(Random& random) {
  Scene scene;
  add_box(scene, {0, 0, -13}, {60, 60, 1});
  for (int i = -4; i <= 4; ++i)
    add_box(scene, {0.9f * float(i), 0, -2}, {random.between(0.15f, 0.35f), 5, 0.05f});
  for (int i = 0; i < 60; ++i) {
    const float x = random.between(-4, 4), y = random.between(-3, 3), z = random.between(-8, -3);
    const float half = random.between(0.03f, 0.25f), high = random.between(0.1f, 0.6f);
    add_box(scene, {x, y, z}, {half, high, half});
  }
  finish(scene);
  return scene;
}

std::set<std::uint32_t> objects_in(const Image<std::uint32_t>& identifiers) {
  std::set<std::uint32_t> objects;
  for (const std::uint32_t one : identifiers.texels())
    if (one != kNoObject) objects.insert(one - 1);
  return objects;
}

Keyframe keyframe_from(CaptureSource& source, const glm::dvec3& eye) {
  KeyframeRequest request;
  request.camera = keyframe_camera(view_from(eye), 1.2);
  request.samples = 1;
  return std::move(*make_keyframe(source, request));
}

// Those that are found are seen by the frame's eye and in no keyframe; and of those of which some
// pixels are seen none is left after some looks. Objects of pictures say so.
TEST(UnshownObjects, AreThoseThatTheFrameSeesAndNoKeyframe) {
  int hidden = 0, found_at_once = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    const Scene scene = posts_and_boxes(random);
    const PlacedScene placed(scene);
    const Result<RayScene> rays = RayScene::create(scene);
    ASSERT_TRUE(rays.ok());
    RaySource source(*rays);
    const double way = random.between(0.2f, 1);
    const Keyframe keys[] = {keyframe_from(source, {-way, 0, 0}),
                             keyframe_from(source, {way, 0, 0})};
    const WarpedKeyframe warped_keys[] = {{&keys[0]}, {&keys[1]}};
    const Camera frame = view_from({way * double(random.between(-0.5f, 0.5f)), 0, 0});
    WarpedFrame warped;
    warp_keyframes(warped_keys, frame, warped);
    std::vector<std::uint32_t> in_view;
    placed.cull(frame, in_view);

    CaptureRequest request;
    request.camera = frame;
    const Result<CapturedPicture> truth = source.capture(request);
    ASSERT_TRUE(truth.ok());
    std::set<std::uint32_t> shown = objects_in(keys[0].object);
    shown.merge(objects_in(keys[1].object));
    for (const Keyframe& key : keys) {
      const std::set<std::uint32_t> objects = objects_in(key.object);
      EXPECT_TRUE(std::ranges::equal(key.shown, objects));
    }

    UnshownObjects unshown(placed, *rays, 1e6);
    EXPECT_TRUE(unshown.begin(frame, warped_keys, in_view).empty());
    std::vector<std::uint32_t> found;
    for (int i = 0; i < 100; ++i) {
      const auto now = unshown.look(warped);
      if (!now.empty()) found.assign(now.begin(), now.end());
      EXPECT_TRUE(unshown.grown().empty());
      if (i == 0) found_at_once += int(found.size());
    }
    const std::set<std::uint32_t> seen = objects_in(truth->picture.object);
    for (const std::uint32_t object : found)
      EXPECT_TRUE(seen.contains(object) && !shown.contains(object)) << seed << " " << object;
    for (const std::uint32_t object : seen) {
      if (shown.contains(object)) continue;
      int pixels = 0;
      for (int y = 0; y < kViewHeight; ++y)
        for (int x = 0; x < kViewWidth; ++x)
          pixels += truth->picture.object(x, y) == object + 1 && !warped.hole(x, y) &&
                    warped.inverse_z(x, y) < 0.99f / truth->picture.depth(x, y);
      if (pixels < 24) continue;
      ++hidden;
      EXPECT_TRUE(std::ranges::binary_search(found, object)) << seed << " " << object;
    }
    // They are known to the next frame.
    const auto known = unshown.begin(frame, warped_keys, in_view);
    EXPECT_TRUE(std::ranges::equal(known, found));
  }
  EXPECT_GT(hidden, 30);
  EXPECT_GT(found_at_once, hidden / 2);
}

// Rays do not see what moves, which has gone elsewhere.
TEST(UnshownObjects, AreFoundBehindWhereSomethingThatMovesBegan) {
  Scene scene;
  add_box(scene, {0, 0, -13}, {60, 60, 1});
  add_box(scene, {0, 0, -6}, {0.5f, 0.5f, 0.1f});
  add_box(scene, {0, 0, -3}, {1, 1, 0.1f});
  finish(scene);
  scene.objects.back().moving = true;
  const PlacedScene placed(scene);
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  RaySource source(*rays);
  const std::uint32_t wall = 0;
  KeyframeRequest request;
  request.camera = keyframe_camera(view_from({0, 0, 0}), 1.2);
  request.samples = 1, request.objects = {&wall, 1};
  const Result<Keyframe> key = make_keyframe(source, request);
  ASSERT_TRUE(key.ok());
  const WarpedKeyframe warped_key{&*key};
  WarpedFrame warped;
  warp_keyframes({&warped_key, 1}, view_from({0, 0, 0}), warped);
  UnshownObjects unshown(placed, *rays, 1e6);
  const std::uint32_t in_view[] = {0, 1};
  (void)unshown.begin(view_from({0, 0, 0}), {&warped_key, 1}, in_view);
  const auto found = unshown.look(warped);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0], 1u);
}

// What has come so much nearer that its texels would be far apart, by the definition.
TEST(UnshownObjects, AreThoseThatHaveGrown) {
  Random random(5);
  const Scene scene = posts_and_boxes(random);
  const PlacedScene placed(scene);
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  RaySource source(*rays);
  const Keyframe key = keyframe_from(source, {0, 0, 3});
  const WarpedKeyframe warped_key{&key};
  UnshownObjects unshown(placed, *rays, 1e6), few(placed, *rays, 12);
  std::size_t most = 0;
  for (int i = 0; i < 40; ++i) {
    const Camera frame = view_from({0.02 * i, 0, 3 - 0.12 * i});
    std::vector<std::uint32_t> in_view, grown;
    placed.cull(frame, in_view);
    const auto distance = [&](std::uint32_t object, const glm::dvec3& eye) {
      const Box& box = placed.bounds()[object];
      glm::dvec3 to(0);
      for (int c = 0; c < 3; ++c)
        to[c] = std::max({double(box.min[c]) - eye[c], eye[c] - double(box.max[c]), 0.0});
      return glm::length(to);
    };
    const std::set<std::uint32_t> shown = objects_in(key.object);
    for (const std::uint32_t object : in_view)
      if (shown.contains(object) &&
          distance(object, {0, 0, 3}) >
              UnshownObjects::kMostGrown * distance(object, frame.position()))
        grown.push_back(object);
    EXPECT_TRUE(std::ranges::equal(unshown.begin(frame, {&warped_key, 1}, in_view), grown)) << i;
    EXPECT_TRUE(std::ranges::equal(unshown.grown(), grown));
    most = std::max(most, grown.size());
    // A box has twelve triangles.
    const auto nearest = few.begin(frame, {&warped_key, 1}, in_view);
    ASSERT_EQ(nearest.size(), std::min<std::size_t>(grown.size(), 1));
    for (const std::uint32_t object : grown)
      EXPECT_LE(distance(nearest[0], frame.position()), distance(object, frame.position()));
  }
  EXPECT_GE(most, 5u);
}

}  // namespace
}  // namespace rilievo
