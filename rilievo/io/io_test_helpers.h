// Pictures that halfs can hold, for the tests of this stage.
#pragma once

#include <gtest/gtest.h>
#include <half.h>

#include <random>
#include <string>

#include "rilievo/core/depth_image.h"

namespace rilievo {

inline Camera random_camera(std::mt19937& rng, int width, int height) {
  std::uniform_real_distribution<double> u(-1, 1);
  const auto point = [&](double reach) { return glm::dvec3(u(rng), u(rng), u(rng)) * reach; };
  Camera c = look_at(point(20), point(2), {0, 1, 0}, 0.9, width, height, 0.25, 60.0);
  // Off the axis, and of every kind.
  c.window.left *= 1 + 0.5 * u(rng);
  c.window.top *= 1 + 0.5 * u(rng);
  c.projection = Projection(rng() % 3);
  return c;
}

// Colours that are halfs already, a third of the texels empty, objects for even seeds.
inline DepthImage random_picture(unsigned seed, int width, int height) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> u(0, 1);
  DepthImage p;
  p.name = "picture " + std::to_string(seed);
  p.camera = random_camera(rng, width, height);
  p.depth_kind = DepthKind(seed % 3);
  p.color = ColorImage(width, height);
  p.depth = Image<float>(width, height, kNoDepth);
  if (seed % 2 == 0) p.object = Image<std::uint32_t>(width, height);
  for (std::size_t i = 0; i < p.color.texels().size(); ++i) {
    if (rng() % 3 == 0) continue;
    for (int c = 0; c < 4; ++c) p.color.texels()[i][c] = float(half(u(rng) * 4));
    p.depth.texels()[i] = 0.3f + 50.0f * u(rng);
    if (!p.object.empty()) p.object.texels()[i] = rng();
  }
  return p;
}

inline void expect_same(const DepthImage& a, const DepthImage& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.depth_kind, b.depth_kind);
  EXPECT_TRUE(a.color == b.color);
  EXPECT_TRUE(a.depth == b.depth);
  EXPECT_TRUE(a.object == b.object);
}

}  // namespace rilievo
