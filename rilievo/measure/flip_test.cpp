#include "rilievo/measure/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "rilievo/measure/measure_test_helpers.h"

namespace rilievo {
namespace {

double most(const Image<float>& map) {
  return *std::max_element(map.texels().begin(), map.texels().end());
}

// Taken once from the authors' NumPy code (github.com/NVlabs/flip, python/flip_api.py, with
// scipy.ndimage.correlate in place of OpenCV's filter2D) on the frames that
// tests/reference/image_quality.py makes.
TEST(Flip, agrees_with_its_authors_code) {
  struct {
    int width, height;
    std::uint32_t seed;
    double pixels_per_degree, mean, most;
  } constexpr kReferences[] = {
      {64, 48, 1, 67, 0.152363256, 0.775627673},    {131, 77, 2, 67, 0.230813339, 0.796233058},
      {11, 11, 3, 67, 0.063908808, 0.195726275},    {96, 60, 4, 30, 0.188364297, 0.789345384},
      {80, 50, 5, 140.5, 0.297864437, 0.759888589},
  };
  for (const auto& r : kReferences) {
    const FramePair pair = frame_pair(r.width, r.height, r.seed);
    // Floats on both sides; powers of 0.5 and 0.7 magnify rounding where differences are small.
    EXPECT_NEAR(flip(pair.a, pair.b, {r.pixels_per_degree}), r.mean, 1e-6);
    EXPECT_NEAR(most(flip_map(pair.a, pair.b, {r.pixels_per_degree})), r.most, 1e-5);
  }
}

// The paper's definition in doubles, filters in two dimensions, pixel by pixel.
struct SlowFlip {
  double ppd;
  const Rgba8Image& frame;

  static glm::dvec3 white() { return xyz({1, 1, 1}, glm::dvec3(1)); }
  static glm::dvec3 xyz(const glm::dvec3& rgb, const glm::dvec3& over) {
    return glm::dvec3((10135552 * rgb.r + 8788810 * rgb.g + 4435075 * rgb.b) / 24577794,
                      (2613072 * rgb.r + 8788810 * rgb.g + 887015 * rgb.b) / 12288897,
                      (1425312 * rgb.r + 8788810 * rgb.g + 70074185 * rgb.b) / 73733382) /
           over;
  }
  [[nodiscard]] glm::dvec3 y_cx_cz(int x, int y) const {
    const glm::u8vec4 c =
        frame(std::clamp(x, 0, frame.width() - 1), std::clamp(y, 0, frame.height() - 1));
    const auto linear = [](double v) {
      return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    };
    const glm::dvec3 p =
        xyz({linear(c.r / 255.0), linear(c.g / 255.0), linear(c.b / 255.0)}, white());
    return {116 * p.y - 16, 500 * (p.x - p.y), 200 * (p.y - p.z)};
  }
  static glm::dvec3 hunt(const glm::dvec3& rgb) {
    const glm::dvec3 p = xyz(rgb, white());
    const auto f = [](double t) {
      const double d = 6.0 / 29;
      return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0 / 29;
    };
    const double l = 116 * f(p.y) - 16;
    return {l, 0.01 * l * 500 * (f(p.x) - f(p.y)), 0.01 * l * 200 * (f(p.y) - f(p.z))};
  }
  static double hyab(const glm::dvec3& p, const glm::dvec3& q) {
    return std::abs(p.x - q.x) + std::hypot(p.y - q.y, p.z - q.z);
  }
  [[nodiscard]] glm::dvec3 color(int x, int y) const {
    const int radius =
        int(std::ceil(3 * std::sqrt(0.04 / (2 * std::pow(std::numbers::pi, 2))) * ppd));
    glm::dvec3 sum(0), weights(0);
    for (int j = -radius; j <= radius; ++j)
      for (int i = -radius; i <= radius; ++i) {
        const double z = (i * i + j * j) / (ppd * ppd);
        const auto term = [&](double a, double b) {
          return a * std::sqrt(std::numbers::pi / b) *
                 std::exp(-std::numbers::pi * std::numbers::pi * z / b);
        };
        const glm::dvec3 w(term(1, 0.0047), term(1, 0.0053), term(34.1, 0.04) + term(13.5, 0.025));
        sum += w * y_cx_cz(x + i, y + j);
        weights += w;
      }
    const glm::dvec3 o = sum / weights;
    const double yy = (o.x + 16) / 116;
    const glm::dvec3 p = glm::dvec3(yy + o.y / 500, yy, yy - o.z / 200) * white();
    const glm::dmat3 to_xyz(xyz({1, 0, 0}, glm::dvec3(1)), xyz({0, 1, 0}, glm::dvec3(1)),
                            xyz({0, 0, 1}, glm::dvec3(1)));
    return hunt(glm::clamp(glm::inverse(to_xyz) * p, 0.0, 1.0));
  }
  // The length of the gradient (edges) or of the second derivatives (points).
  [[nodiscard]] double feature(int x, int y, bool edge) const {
    const double sd = 0.5 * 0.082 * ppd;
    const int radius = int(std::ceil(3 * sd));
    double positive = 0, negative = 0;
    const auto weight = [&](int i, int j) {
      const double g = std::exp(-(i * i + j * j) / (2 * sd * sd));
      return edge ? -i * g : (i * i / (sd * sd) - 1) * g;
    };
    for (int j = -radius; j <= radius; ++j)
      for (int i = -radius; i <= radius; ++i)
        (weight(i, j) > 0 ? positive : negative) += weight(i, j);
    glm::dvec2 sum(0);
    for (int j = -radius; j <= radius; ++j)
      for (int i = -radius; i <= radius; ++i) {
        const double luminance = (y_cx_cz(x + i, y + j).x + 16) / 116;
        const double wx = weight(i, j), wy = weight(j, i);
        sum.x += wx / (wx > 0 ? positive : -negative) * luminance;
        sum.y += wy / (wy > 0 ? positive : -negative) * luminance;
      }
    return glm::length(sum);
  }
};

double slow_flip(const SlowFlip& a, const SlowFlip& b, int x, int y) {
  const double largest =
      std::pow(SlowFlip::hyab(SlowFlip::hunt({0, 1, 0}), SlowFlip::hunt({0, 0, 1})), 0.7);
  const double e = std::pow(SlowFlip::hyab(a.color(x, y), b.color(x, y)), 0.7);
  const double color = e < 0.4 * largest ? 0.95 * e / (0.4 * largest)
                                         : 0.95 + 0.05 * (e - 0.4 * largest) / (0.6 * largest);
  const double feature = std::max(std::abs(a.feature(x, y, true) - b.feature(x, y, true)),
                                  std::abs(a.feature(x, y, false) - b.feature(x, y, false)));
  return std::pow(color, 1 - std::sqrt(feature / std::sqrt(2)));
}

TEST(Flip, is_its_definition_at_every_kind_of_place) {
  for (const double ppd : {67.0, 20.0}) {
    // Higher than a strip of rows.
    const FramePair pair = frame_pair(37, 110, 7);
    const Image<float> map = flip_map(pair.a, pair.b, {ppd});
    const SlowFlip a{ppd, pair.a}, b{ppd, pair.b};
    for (const int y : {0, 1, 30, 47, 48, 49, 95, 96, 109})
      for (const int x : {0, 5, 18, 36})
        // Floats, in powers of 0.5 and 0.7.
        EXPECT_NEAR(map(x, y), slow_flip(a, b, x, y), 1e-4) << x << " " << y;
  }
}

TEST(Flip, is_zero_for_equal_frames_and_symmetric) {
  const FramePair pair = frame_pair(50, 40, 8);
  EXPECT_EQ(flip(pair.a, pair.a), 0);
  EXPECT_EQ(most(flip_map(pair.a, pair.a)), 0);
  EXPECT_EQ(flip(pair.a, pair.b), flip(pair.b, pair.a));
}

TEST(Flip, black_against_white_follows_from_lab_alone) {
  // L* differs by 100 and nothing else does. The largest distance is that of pure green, L*a*b* =
  // (87.735, -86.183, 83.181), and pure blue, (32.303, 79.196, -107.865), a and b times L / 100:
  // 55.43 + |(-101.19, 107.82)| = 203.3.
  const double largest = std::pow(203.3, 0.7), e = std::pow(100.0, 0.7);
  const double expected = 0.95 + 0.05 * (e - 0.4 * largest) / (0.6 * largest);
  const Rgba8Image black(30, 30, glm::u8vec4(0, 0, 0, 255)), white(30, 30, glm::u8vec4(255));
  // Lab values with three digits after the point.
  EXPECT_NEAR(flip(black, white), expected, 1e-4);
}

TEST(Flip, a_point_that_vanishes_is_worse_than_its_colour_alone) {
  // One white pixel on grey.
  Rgba8Image grey(61, 61, glm::u8vec4(100, 100, 100, 255)), firefly = grey;
  firefly(30, 30) = glm::u8vec4(255);
  const Image<float> map = flip_map(grey, firefly);
  EXPECT_EQ(most(map), map(30, 30));
  // Its colour alone: a plain frame of what the eye's blur leaves of the pixel. The achromatic
  // filter is a Gaussian of sd = sqrt(0.0047 / 2) / pi * 67 = 1.034 pixels: 1 / (2 pi sd^2) = 0.149
  // at its centre.
  const float background = linear_from_srgb(100 / 255.0f);
  const float light = 0.149f + (1 - 0.149f) * background;
  const auto level = std::uint8_t(std::lround(255 * srgb_from_linear(light)));
  const Rgba8Image patch(61, 61, glm::u8vec4(level, level, level, 255));
  const double color = flip_map(grey, patch)(30, 30);
  // The point's: sd = 0.041 * 67 = 2.747 pixels. Along x the negative weights, x^2 < sd^2, sum to
  // 1 + 2 * 0.8675 * 0.9359 + 2 * 0.4699 * 0.7673 = 3.345, the Gaussian to sd sqrt(2 pi) = 6.886:
  // the centre weighs 1 / 3.345 / 6.886 = 0.0434 in both directions.
  const double feature = std::sqrt(0.0434 * (1 - background));
  // The level of the plain frame is rounded to 8 bits.
  EXPECT_NEAR(map(30, 30), std::pow(color, 1 - feature), 0.005);
  EXPECT_GT(map(30, 30), color);
  // Nothing happens beyond the reach of the filters, 10 pixels.
  EXPECT_EQ(map(19, 30), 0);
  EXPECT_EQ(map(30, 41), 0);
}

TEST(Flip, of_frames_that_differ_in_a_part_is_that_of_whole_frames) {
  // Columns that are equal in both frames are left out; in noise beside them, which both have,
  // a difference of one level in the corners prevents that.
  FramePair pair = frame_pair(150, 130, 12);
  Rgba8Image part = pair.a;
  for (int y = 60; y < 70; ++y)
    for (int x = 70; x < 75; ++x) part(x, y) = pair.b(x, y);
  Rgba8Image whole = part;
  for (const int y : {0, 47, 48, 95, 96, 129})
    for (const int x : {0, 149}) whole(x, y).g = std::uint8_t(whole(x, y).g ^ 1);
  const Image<float> a = flip_map(pair.a, part), b = flip_map(pair.a, whole);
  int inside = 0;
  for (int y = 25; y < 105; ++y)
    for (int x = 20; x < 130; ++x) {
      ASSERT_EQ(a(x, y), b(x, y)) << x << " " << y;
      inside += a(x, y) > 0;
    }
  EXPECT_GT(inside, 300);
}

TEST(Flip, a_kept_truth_yields_the_same) {
  for (const auto& [width, height] : {std::pair(131, 77), {16, 48}, {1, 1}, {50, 97}}) {
    const FramePair pair = frame_pair(width, height, 13);
    const FlipTruth truth(pair.a);
    EXPECT_EQ(truth.flip(pair.b), flip(pair.a, pair.b));
    EXPECT_EQ(truth.flip(pair.a), 0);
    Rgba8Image part = pair.a;
    part(width / 2, height / 3).r ^= 16;
    EXPECT_EQ(truth.flip(part), flip(pair.a, part));
  }
}

TEST(Flip, moves_with_its_frames) {
  const FramePair pair = frame_pair(80, 120, 9);
  const auto part = [](const Rgba8Image& from, int y0) {
    Rgba8Image out(80, 100);
    for (int y = 0; y < 100; ++y) std::ranges::copy(from.row(y + y0), out.row(y).begin());
    return out;
  };
  const Image<float> first = flip_map(part(pair.a, 0), part(pair.b, 0));
  const Image<float> second = flip_map(part(pair.a, 13), part(pair.b, 13));
  // Away from the borders, whatever strips the rows fall into.
  for (int y = 25; y < 85; ++y)
    for (int x = 0; x < 80; ++x) ASSERT_EQ(first(x, y), second(x, y - 13));
}

}  // namespace
}  // namespace rilievo
