// When do two sources capture the same picture?
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rilievo/capture/capture_source.h"

namespace rilievo::test_sources {

// How many texels show something, and in how many the pictures differ.
struct Differences {
  int texels = 0, covered = 0, objects = 0, depths = 0, farthest = 0, alphas = 0, colors = 0;
};

// By how much depths of the same surface differ: relative to eye_z.
inline bool other_depth(float a, float b) {
  return (a == kNoDepth) != (b == kNoDepth) || (a != kNoDepth && std::abs(a - b) > 2e-3f * b);
}

// Adds the differences of two captures of one camera.
inline void count(const CapturedPicture& a, const CapturedPicture& b, Differences& d) {
  ASSERT_EQ(a.picture.depth.width(), b.picture.depth.width());
  ASSERT_EQ(a.picture.depth.height(), b.picture.depth.height());
  ASSERT_EQ(a.farthest.empty(), b.farthest.empty());
  for (int y = 0; y < a.picture.depth.height(); ++y)
    for (int x = 0; x < a.picture.depth.width(); ++x) {
      ++d.texels;
      if (!a.farthest.empty()) d.farthest += other_depth(a.farthest(x, y), b.farthest(x, y));
      if (a.picture.object(x, y) != b.picture.object(x, y)) {
        ++d.objects;
        continue;
      }
      if (!b.picture.covered(x, y)) {
        EXPECT_EQ(a.picture.color(x, y), glm::vec4(0));
        continue;
      }
      ++d.covered;
      d.depths += other_depth(a.picture.depth(x, y), b.picture.depth(x, y));
      const glm::vec4 ca = a.picture.color(x, y), cb = b.picture.color(x, y);
      if (std::abs(ca.a - cb.a) > 1e-3f) {
        ++d.alphas;
        continue;
      }
      const glm::vec4 difference = glm::abs(ca - cb);
      d.colors += std::max({difference.r, difference.g, difference.b}) > 0.02f;
    }
}

}  // namespace rilievo::test_sources
