// Does the bound of gaps hold for what is warped? Scenes that hide things from both keyframes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <vector>

#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/keyframes/keyframe_bound.h"
#include "rilievo/keyframes/make_keyframe.h"
#include "rilievo/measure/gap_width.h"

namespace rilievo {
namespace {

constexpr int kAcross = 120, kDown = 80;

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  double between(double a, double b) { return a + (b - a) * double(engine_()) / 4294967296.0; }
  int below(int n) { return int(engine_() % std::uint32_t(n)); }

 private:
  std::mt19937 engine_;
};

void add_box(Scene& scene, const glm::dvec3& center, const glm::dvec3& half, double turn = 0) {
  const glm::mat4 place =
      glm::rotate(glm::translate(glm::mat4(1), glm::vec3(center)), float(turn), glm::vec3(0, 0, 1));
  test_shapes::add(scene, test_shapes::box(glm::vec3(half)), {0.6f, 0.6f, 0.6f}, place);
}

// A scene that is looked at along -z, and where both keyframes see it from.
struct HidingScene {
  Scene scene;
  glm::dvec3 behind, ahead;
};

// In front of a wall: a bar behind the slit between two posts; a comb before bars; a fence before a
// fence; leaves.
//
//   bar                 -        at distance Z, half as wide as h
//   posts           ---   ---    at distance n, the slit 2 s and each of them 2 p wide
//   keyframes     x     o     x  b to either side of the frame's eye
//
// A post hides the bar from a keyframe if b (1 - n/Z) = s + p and h n/Z < p; and the keyframe sees
// the wall behind the bar, at distance W, past the post if b (1 - n/W) > s + 2 p + h n/Z.
HidingScene hiding_scene(int kind, Random& random) {
  HidingScene made;
  Scene& scene = made.scene;
  const double near = random.between(1.5, 3), far = near * random.between(6, 10);
  add_box(scene, {0, 0, -far - 1}, {60, 60, 1});
  const double turn = random.between(-1.6, 1.6);
  const glm::dmat3 axes(glm::rotate(glm::dmat4(1), turn, glm::dvec3(0, 0, 1)));
  const auto bar = [&](double across, double z, double half) {
    add_box(scene, axes * glm::dvec3(across, 0, 0) + glm::dvec3(0, 0, z), {half, 40, 0.05}, turn);
  };
  // Between both keyframes, or not quite.
  const double x = random.between(-1, 1), y = random.between(-1, 1), z = random.between(-0.6, 0.6);
  const glm::dvec3 way = glm::normalize(glm::dvec3(x, y, z));
  made.ahead = random.between(0.01, 0.5) * way, made.behind = -random.between(0.01, 0.5) * way;
  if (kind == 0) {
    const double there = near * random.between(1.6, 2.5), slit = random.between(0.05, 0.3);
    const double post = slit * random.between(0.6, 1.2), half = slit * random.between(0.4, 1);
    bar(-slit - post, -near, post), bar(slit + post, -near, post);
    bar(random.between(-0.1, 0.1) * slit, -there, half);
    const double aside = (slit + post) / (1 - near / there);
    made.ahead = axes * glm::dvec3(aside, 0, 0), made.behind = -made.ahead;
  } else if (kind == 1) {
    const double step = random.between(0.1, 0.6), width = random.between(0.1, 0.45) * step;
    for (int i = -12; i <= 12; ++i) bar(i * step, -near, width);
    for (int i = 0; i < 12; ++i) {
      const double z = -random.between(near + 0.3, far), across = random.between(-4, 4);
      bar(across, z, random.between(0.05, 0.6));
    }
  } else if (kind == 2) {
    for (const double z : {near, random.between(near + 0.5, far)}) {
      const double step = random.between(0.15, 0.8), width = random.between(0.05, 0.3) * step;
      for (int i = -15; i <= 15; ++i) bar(i * step, -z, width);
    }
  } else {
    for (int i = 0; i < 80; ++i) {
      const double x = random.between(-3, 3), y = random.between(-2, 2);
      const double z = -random.between(near, far), half = random.between(0.05, 0.6);
      const double leaf = random.between(-1.6, 1.6);
      add_box(scene, {x, y, z}, {half, 0.4 * half, 0.01}, leaf);
    }
  }
  finish(scene);
  return made;
}

struct GapCase {
  double measured_px = 0, bound_px = 0;
};

// `turns`: each keyframe looks to another side, so that edges of the frame are in one of them only.
GapCase measure_gap(int kind, bool turns, std::uint32_t seed) {
  Random random(seed);
  const HidingScene made = hiding_scene(kind, random);
  const Result<RayScene> rays = RayScene::create(made.scene);
  EXPECT_TRUE(rays.ok());
  RaySource source(*rays);
  const auto eye_at = [&](const glm::dvec3& eye, double turn = 0) {
    const glm::dvec3 forward(std::sin(turn), 0, -std::cos(turn));
    return look_at(eye, eye + forward, {0, 1, 0}, 0.9, kAcross, kDown, 0.2, 100);
  };
  const double aside = random.between(-0.02, 0.02);
  const Camera frame = eye_at({aside, 0, 0});
  std::vector<Keyframe> keys;
  for (const glm::dvec3& at : {made.behind, made.ahead}) {
    KeyframeRequest request;
    const double turn = turns ? random.between(0.1, 0.5) * (keys.empty() ? 1 : -1) : 0;
    request.camera = keyframe_camera(eye_at(at, turn), 1.3);
    Result<Keyframe> key = make_keyframe(source, request);
    EXPECT_TRUE(key.ok());
    keys.push_back(std::move(*key));
  }
  KeyframeRequest exact;
  exact.camera = frame, exact.samples = 1;
  const Result<Keyframe> truth = make_keyframe(source, exact);
  EXPECT_TRUE(truth.ok());
  const WarpedKeyframe warped[] = {{&keys[0], 1}, {&keys[1], 1}};
  WarpedFrame shown;
  warp_keyframes(warped, frame, shown);
  Image<float> true_z(kAcross, kDown), shown_z(kAcross, kDown);
  for (int py = 0; py < kDown; ++py)
    for (int px = 0; px < kAcross; ++px) {
      true_z(px, py) = 1 / truth->inverse_z(px, py);
      // Holes are filled.
      shown_z(px, py) = shown.hole(px, py) ? true_z(px, py) : 1 / shown.inverse_z(px, py);
    }
  return {widest_gap_px(truth->object, true_z, shown_z), bound_keyframes(warped, frame).gap_px};
}

TEST(KeyframeGaps, what_both_keyframes_hide_is_missing_no_wider_than_the_bound) {
  // RILIEVO_GAP_CASES: more of them.
  const char* asked = std::getenv("RILIEVO_GAP_CASES");
  const int cases = asked ? std::atoi(asked) : 60;
  // A silhouette is a texel off on either side, and a pixel is the least that is measured.
  constexpr double kSlack = 2;
  int gaps = 0, violations = 0;
  std::vector<double> tightness;
  for (int i = 0; i < cases; ++i) {
    const GapCase one = measure_gap(i % 4, i % 3 == 2, std::uint32_t(i) + 1);
    violations += one.measured_px > one.bound_px + kSlack;
    if (one.measured_px <= kSlack) continue;
    ++gaps;
    tightness.push_back(one.bound_px / one.measured_px);
  }
  EXPECT_EQ(violations, 0);
  EXPECT_GT(gaps, cases / 10);  // something was hidden
  ASSERT_GT(gaps, 0);
  std::nth_element(tightness.begin(), tightness.begin() + gaps / 2, tightness.end());
  RecordProperty("gaps", gaps);
  RecordProperty("median_tightness", std::to_string(tightness[std::size_t(gaps / 2)]));
  if (asked)
    std::printf("%d gaps, median tightness %.2f\n", gaps, tightness[std::size_t(gaps / 2)]);
}

}  // namespace
}  // namespace rilievo
