// PSNR and SSIM against scikit-image, against their definitions, and where they are known.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "rilievo/measure/measure_test_helpers.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/ssim.h"

namespace rilievo {
namespace {

// scikit-image 0.19.3, taken once by tests/reference/image_quality.py.
struct Reference {
  int width, height;
  std::uint32_t seed;
  double psnr_db, ssim;
};
constexpr Reference kReferences[] = {
    {64, 48, 1, 22.464590154238, 0.826775988927},
    {131, 77, 2, 19.247901155014, 0.836191423485},
    {11, 11, 3, 29.286142496557, 0.804433134780},
    {320, 180, 4, 20.542633266221, 0.863041575576},
};

TEST(Psnr, agrees_with_scikit_image) {
  for (const Reference& r : kReferences) {
    const FramePair pair = frame_pair(r.width, r.height, r.seed);
    // Both sum integers exactly: only the printed digits are missing.
    EXPECT_NEAR(psnr_db(pair.a, pair.b), r.psnr_db, 1e-11);
    EXPECT_NEAR(psnr_db(pair.b, pair.a), r.psnr_db, 1e-11);
  }
}

TEST(Psnr, is_infinite_for_equal_frames_and_known_for_one_wrong_channel) {
  FramePair pair = frame_pair(40, 30, 5);
  EXPECT_EQ(psnr_db(pair.a, pair.a), std::numeric_limits<double>::infinity());
  Rgba8Image one = pair.a;
  one(3, 4).g = std::uint8_t(one(3, 4).g ^ 1);
  one(7, 7).a = 0;  // alpha does not count
  EXPECT_NEAR(psnr_db(pair.a, one), 10 * std::log10(255.0 * 255.0 * 3 * 40 * 30), 1e-9);
}

TEST(Ssim, agrees_with_scikit_image) {
  for (const Reference& r : kReferences) {
    const FramePair pair = frame_pair(r.width, r.height, r.seed);
    // Variances in floats, see the twin below; the third frame is a single window.
    EXPECT_NEAR(ssim(pair.a, pair.b), r.ssim, 1e-5);
  }
}

// The definition, in doubles, window by window.
double slow_ssim(const Rgba8Image& a, const Rgba8Image& b) {
  const auto luma = [](const glm::u8vec4& c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b; };
  const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;
  double sum = 0;
  int count = 0;
  for (int y = 5; y < a.height() - 5; ++y)
    for (int x = 5; x < a.width() - 5; ++x) {
      double w = 0, ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
      const auto each = [&](const auto& visit) {
        for (int j = -5; j <= 5; ++j)
          for (int i = -5; i <= 5; ++i)
            visit(std::exp(-(i * i + j * j) / 4.5), luma(a(x + i, y + j)), luma(b(x + i, y + j)));
      };
      each([&](double g, double p, double q) { w += g, ma += g * p, mb += g * q; });
      ma /= w, mb /= w;
      each([&](double g, double p, double q) {
        va += g / w * (p - ma) * (p - ma);
        vb += g / w * (q - mb) * (q - mb);
        cov += g / w * (p - ma) * (q - mb);
      });
      sum += (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
      ++count;
    }
  return sum / count;
}

TEST(Ssim, is_its_definition) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    // From the smallest frame on, over strips that are cut short.
    const FramePair pair = frame_pair(11 + int(seed) * 3, 11 + int(seed * seed), seed);
    // E[a^2] - E[a]^2 of floats below 128^2 = 2^14 is wrong by some 2^-9 at worst, against
    // C2 = 58 in the denominator: 3e-5 for a window, less for their mean.
    EXPECT_NEAR(ssim(pair.a, pair.b), slow_ssim(pair.a, pair.b), 1e-5) << seed;
  }
}

TEST(Ssim, is_one_for_equal_frames_and_negative_for_an_inverted_one) {
  const FramePair pair = frame_pair(60, 50, 9);
  EXPECT_EQ(ssim(pair.a, pair.a), 1.0);
  // Equal means, opposite structure: a checkerboard around the middle and its inverse.
  Rgba8Image board(40, 40), inverse(40, 40);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      const bool white = (x + y) % 2;
      board(x, y) = glm::u8vec4(glm::u8vec3(white ? 255 : 0), 255);
      inverse(x, y) = glm::u8vec4(glm::u8vec3(white ? 0 : 255), 255);
    }
  EXPECT_LT(ssim(board, inverse), -0.9);
}

TEST(Ssim, constant_frames_follow_the_luminance_term_alone) {
  const Rgba8Image dark(20, 20, glm::u8vec4(50, 50, 50, 255));
  const Rgba8Image light(20, 20, glm::u8vec4(100, 100, 100, 255));
  const double c1 = 2.55 * 2.55;
  // Rounding of floats near 128^2 against C2 = 58.
  EXPECT_NEAR(ssim(dark, light), (2 * 50 * 100 + c1) / (50 * 50 + 100 * 100 + c1), 1e-4);
}

}  // namespace
}  // namespace rilievo
