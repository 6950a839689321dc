// A test of when pictures that are used in the plain way are captured again.
#pragma once

#include <gtest/gtest.h>

#include "rilievo/core/camera.h"

namespace rilievo {

// `captures_for(camera)` draws a frame, and returns how many pictures were captured for it.
template <class Captures>
void expect_captures_where_the_eye_has_moved(const Camera& first, const Captures& captures_for) {
  const int pictures = captures_for(first);
  EXPECT_GT(pictures, 8);
  Camera turned = first;
  const glm::dvec3 eye = first.position();
  turned.world_from_eye =
      look_at(eye, eye + first.forward() + 0.02 * glm::dvec3(first.world_from_eye[0]), {0, 1, 0}, 1,
              1, 1, 0.1, 1)
          .world_from_eye;
  EXPECT_EQ(captures_for(turned), 0);
  Camera moved = first;
  moved.world_from_eye[3] += moved.world_from_eye[0] * 2.0;
  EXPECT_GE(captures_for(moved), pictures - 2);
}

}  // namespace rilievo
