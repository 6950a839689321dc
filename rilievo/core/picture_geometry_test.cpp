#include "rilievo/core/picture_geometry.h"

#include <gtest/gtest.h>

#include <random>

#include "rilievo/core/depth.h"

namespace rilievo {
namespace {

// A sample between its capture's planes may be anywhere within half a step of its code.
TEST(NarrowSlab, holds_every_sample_whose_code_it_was_told) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 20'000; ++i) {
    Camera capture = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.7, 16, 16, 1, 2);
    capture.z_near = 0.1 + u(rng);
    capture.z_far = capture.z_near * (1.1 + 20 * u(rng));
    PictureGeometry picture = picture_geometry(capture);
    const int bits[] = {2, 4, 6, 8, 16};
    picture.delta_bits = bits[rng() % 5];
    double ends[2], codes[2];
    for (int k = 0; k < 2; ++k) {
      const double delta = u(rng);
      ends[k] = 1 / (1 / capture.z_near + delta * (1 / capture.z_far - 1 / capture.z_near));
      codes[k] =
          double(decode_delta(encode_delta(float(delta), picture.delta_bits), picture.delta_bits));
    }
    narrow_slab(picture, {std::min(codes[0], codes[1]), std::max(codes[0], codes[1])});
    for (const double eye_z : ends) {
      // Deltas are floats.
      EXPECT_LE(picture.slab.front, eye_z * (1 + 1e-5));
      EXPECT_GE(picture.slab.back, eye_z * (1 - 1e-5));
    }
    EXPECT_LE(picture.slab.front, picture.plane_z);
    EXPECT_GE(picture.slab.back, picture.plane_z);
  }
}

}  // namespace
}  // namespace rilievo
