// How alike are a frame of OpenGL's and one drawn without?
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "rilievo/cache/gl/scene_test_helpers.h"
#include "rilievo/cache/prices/machine_costs.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/measure/psnr.h"

namespace rilievo {

// The share of pixels that are no edges: their 3 x 3 neighbourhood in `a` shows one object, without
// creases or silhouettes of it (all colours alike within 10); of those, the share in which no
// channel differs by more than 2.
struct Alike {
  double inner = 0, alike = 0;
};

inline Alike compare_frames(const Rgba8Image& a, const Rgba8Image& b,
                            const Image<std::uint32_t>& objects) {
  int inner = 0, alike = 0;
  for (int y = 1; y + 1 < a.height(); ++y)
    for (int x = 1; x + 1 < a.width(); ++x) {
      bool edge = false;
      for (int k = 0; k < 9; ++k) {
        const int u = x + k % 3 - 1, v = y + k / 3 - 1;
        edge = edge || objects(u, v) != objects(x, y);
        for (int c = 0; c < 3; ++c) edge = edge || std::abs(a(u, v)[c] - a(x, y)[c]) > 10;
      }
      if (edge) continue;
      ++inner;
      int most = 0;
      for (int c = 0; c < 4; ++c) most = std::max(most, std::abs(a(x, y)[c] - b(x, y)[c]));
      alike += most <= 2;
    }
  return {double(inner) / (a.width() * a.height()), double(alike) / std::max(inner, 1)};
}

// The limits of all that both draw: of the pixels that are no edges, this share is equal within
// 2 / 255.
inline constexpr double kLeastAlike = 0.999, kLeastDb = 45;

class AlikeTest : public SceneTest {
 protected:
  // Draws a frame by both. At least the share `least_inner` of its pixels is no edge.
  void expect_same(FrameSource& opengl, FrameSource& software, const Camera& camera,
                   double least_inner = 0.3, double time = 0) {
    const Rgba8Image truth = frame_of(opengl, camera, time);
    const auto objects = objects_of(opengl);
    ASSERT_TRUE(software.draw(camera, time).ok());
    const Rgba8Image drawn = software.software_target()->color();
    const Alike same = compare_frames(truth, drawn, objects);
    EXPECT_GT(same.inner, least_inner);
    EXPECT_GE(same.alike, least_alike_);
    EXPECT_GT(psnr_db(truth, drawn), least_db_);
    ASSERT_TRUE(software.draw_objects().ok());
    EXPECT_LE(wrong_inside(objects, software.software_target()->objects()),
              kWidth * kHeight / 1000);
    RecordProperty("psnr", std::to_string(psnr_db(truth, drawn)));
  }

  double least_alike_ = kLeastAlike, least_db_ = kLeastDb;
};

// The same costs for OpenGL and software, so that both choose the same; triangles are dear.
inline MachineCosts costs_of_both() {
  MachineCosts costs = builtin_software_costs();
  costs.draw_software.triangle_ns = 280;
  costs.draw_opengl = costs.draw_software;
  return costs;
}

inline Rgba8Image software_frame_of(FrameSource& source, const BuiltinScene& builtin, int frame) {
  const double time = frame_time(builtin.path, frame);
  EXPECT_TRUE(source.draw(camera_at(builtin.path, time, kWidth, kHeight), time).ok());
  return source.software_target()->color();
}

}  // namespace rilievo
