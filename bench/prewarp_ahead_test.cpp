#include "bench/prewarp_ahead.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_relief/relief_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {
namespace {

// What is drawn of a picture, by several threads.
std::vector<glm::u8vec4> drawn(const Prewarped& picture) {
  std::vector<glm::u8vec4> out(picture.color.size());
  const int w = picture.color.empty() ? 0 : picture.width();
  parallel_for(0, w ? picture.height() : 0, [&](int y) {
    for (int x = 0; x < w; ++x) {
      const auto i = std::size_t(y) * std::size_t(w) + std::size_t(x);
      out[i] = picture.color[i];
      out[i].r ^= std::uint8_t(picture.delta[i]);
    }
  });
  return out;
}

TEST(PrewarpAhead, pictures_are_those_without_it_whatever_was_predicted) {
  const Result<BuiltinScene> built = make_builtin("builtin:fish?triangles=10000");
  ASSERT_TRUE(built);
  const Result<RayScene> rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  const Result<std::vector<glm::dvec3>> six = relief_directions(6);
  const Result<ReliefSet> set = bake_reliefs(*rays, *six, {.size = 64});
  ASSERT_TRUE(set) << set.error().message();
  const Box box = world_bounds(built->scene);
  const glm::dvec3 center(box.center());
  std::vector<Camera> cameras;
  for (int i = 0; i < 60; ++i) {
    // Now and then within the object, or looking past it.
    const double angle = 0.11 * i, away = (i % 17 == 16 ? 0.05 : 3.0) * double(box.radius());
    const glm::dvec3 eye = center + away * glm::dvec3(std::sin(angle), 0.4, std::cos(angle));
    const glm::dvec3 target = i % 17 == 8 ? 2.0 * eye - center : center + glm::dvec3(0, 0.01, 0);
    cameras.push_back(
        look_at(eye, target, {0, 1, 0}, 0.8, 90, 70, 0.01 * away, 10 * double(box.radius())));
  }
  for (const Overlap overlap : {Overlap::never, Overlap::automatic, Overlap::always}) {
    PrewarpAhead ahead(*set, {.splat_size = 1.5}, overlap);
    int current = -1, switches = 0, empty = 0;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      // The slow twin: a fresh pre-warp a frame.
      const int picked = pick_relief(*set, cameras[i].position(), current);
      switches += picked != current;
      current = picked;
      Prewarped expected;
      if (picked >= 0) {
        Prewarp prewarp(set->reliefs[std::size_t(picked)], {.splat_size = 1.5});
        (void)prewarp.warp(cameras[i].position(), &cameras[i], expected);
      }
      empty += expected.color.empty();
      // Every fifth frame another camera is predicted; every seventh none.
      const std::size_t guess = std::min(i + (i % 5 == 4 ? 3 : 1), cameras.size() - 1);
      std::atomic<int> calls = 0;
      ahead.frame(cameras[i], i % 7 == 6 ? nullptr : &cameras[guess], [&](const Prewarped& shown) {
        ++calls;
        EXPECT_EQ(drawn(shown), drawn(expected)) << i;
        if (shown.color.empty()) return;
        EXPECT_EQ(shown.geometry.capture, expected.geometry.capture) << i;
      });
      EXPECT_EQ(calls, 1);
      EXPECT_EQ(ahead.picked(), picked);
    }
    EXPECT_GT(switches, 4);
    EXPECT_GT(empty, 0);
  }
}

}  // namespace
}  // namespace rilievo::bench
