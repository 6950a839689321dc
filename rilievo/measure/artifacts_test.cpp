// The faults that an eye finds at once, against their definitions and where they are known.

#include "rilievo/measure/artifacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "rilievo/measure/flip.h"
#include "rilievo/measure/measure_test_helpers.h"

namespace rilievo {
namespace {

const glm::u8vec4 kWall(120, 120, 120, 255), kLamp(40, 40, 40, 255);

// The definitions, pixel by pixel.
int slow_at(const Rgba8Image& frame, int x, int y, int c) {
  return frame(std::clamp(x, 0, frame.width() - 1), std::clamp(y, 0, frame.height() - 1))[c];
}

int slow_edge(const Rgba8Image& f, int x, int y) {
  int most = 0;
  for (int c = 0; c < 3; ++c) {
    int across = 0, down = 0;
    for (int k = -1; k <= 1; ++k) {
      const int weight = k == 0 ? 2 : 1;
      across += weight * (slow_at(f, x + 1, y + k, c) - slow_at(f, x - 1, y + k, c));
      down += weight * (slow_at(f, x + k, y + 1, c) - slow_at(f, x + k, y - 1, c));
    }
    most = std::max({most, std::abs(across) / 4, std::abs(down) / 4});
  }
  return most;
}

int slow_isolation(const Rgba8Image& f, int x, int y) {
  int most = 0;
  for (int c = 0; c < 3; ++c) {
    std::vector<int> around;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        if (i != 0 || j != 0) around.push_back(slow_at(f, x + i, y + j, c));
    std::sort(around.begin(), around.end());
    const int at = slow_at(f, x, y, c);
    if (at < around[3]) most = std::max(most, around[3] - at);
    if (at > around[4]) most = std::max(most, at - around[4]);
  }
  return most;
}

int slow_change(const Rgba8Image& before, const Rgba8Image& now, int x, int y) {
  int most = 0;
  for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(now(x, y)[c] - before(x, y)[c]));
  return most;
}

template <typename Of>
int most_within_reach(const Rgba8Image& size, int x, int y, const Of& of) {
  int most = 0;
  for (int j = std::max(y - 2, 0); j <= std::min(y + 2, size.height() - 1); ++j)
    for (int i = std::max(x - 2, 0); i <= std::min(x + 2, size.width() - 1); ++i)
      most = std::max(most, of(i, j));
  return most;
}

// The mean over pixels of how far `seen` exceeds what is within reach of `truth`, or counted from a
// step on.
template <typename True, typename Seen>
double slow_mean(const Rgba8Image& size, int step, const True& truth, const Seen& seen) {
  double sum = 0;
  for (int y = 0; y < size.height(); ++y)
    for (int x = 0; x < size.width(); ++x) {
      const int excess = seen(x, y) - most_within_reach(size, x, y, truth);
      sum += step > 0 ? double(excess >= step) : std::max(excess, 0);
    }
  return sum / (double(size.width()) * size.height());
}

TEST(Artifacts, are_their_definitions) {
  for (const auto& [w, h] : {std::pair(70, 67), {131, 33}, {1, 1}, {2, 40}, {40, 3}}) {
    FramePair pair = frame_pair(w, h, std::uint32_t(w));
    // Noise everywhere would leave nothing that exceeds it; and some pixels stand out.
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        if (y % 3 != 0) pair.b(x, y) = pair.a(x, y);
        if ((x * 7 + y * 5) % 53 == 0) pair.b(x, y) = glm::u8vec4(255, 0, 255, 255);
      }
    const FramePair next = frame_pair(w, h, std::uint32_t(w) + 1);
    const auto edge = [](const Rgba8Image& f) {
      return [&f](int x, int y) { return slow_edge(f, x, y); };
    };
    const auto isolated = [](const Rgba8Image& f) {
      return [&f](int x, int y) { return slow_isolation(f, x, y); };
    };
    const Image<std::uint8_t> all_edges = edges(pair.b), all_isolated = isolation(pair.b);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        ASSERT_EQ(all_edges(x, y), slow_edge(pair.b, x, y));
        ASSERT_EQ(all_isolated(x, y), slow_isolation(pair.b, x, y));
      }
    const Artifacts counted = count_artifacts(pair.a, pair.b);
    EXPECT_DOUBLE_EQ(counted.ghost, slow_mean(pair.a, kArtifactStep, edge(pair.a), edge(pair.b)));
    EXPECT_DOUBLE_EQ(counted.speckle,
                     slow_mean(pair.a, kArtifactStep, isolated(pair.a), isolated(pair.b)));
    if (w == 70) {
      EXPECT_GT(counted.ghost, 0);
      EXPECT_GT(counted.speckle, 0);
    }
    EXPECT_NEAR(flicker(pair.a, next.a, pair.b, next.b),
                slow_mean(
                    pair.a, 0, [&](int x, int y) { return slow_change(pair.a, next.a, x, y); },
                    [&](int x, int y) { return slow_change(pair.b, next.b, x, y); }) /
                    255,
                1e-12);
  }
}

Rgba8Image wall_with_lamp(int left) {
  Rgba8Image frame(64, 48, kWall);
  for (int y = 10; y < 30; ++y)
    for (int x = left; x < left + 12; ++x) frame(x, y) = kLamp;
  return frame;
}

TEST(Artifacts, an_outline_drawn_a_second_time_is_a_ghost_and_an_edge_a_pixel_off_is_none) {
  const Rgba8Image truth = wall_with_lamp(10);
  EXPECT_EQ(count_artifacts(truth, truth).ghost, 0);
  EXPECT_EQ(count_artifacts(truth, wall_with_lamp(11)).ghost, 0);
  Rgba8Image ghost = truth;
  for (int y = 10; y < 30; ++y) ghost(40, y) = glm::u8vec4(80, 80, 80, 255);
  // Its line has no edge at its middle, only on both of its sides, and around its ends.
  const double share = count_artifacts(truth, ghost).ghost * 64 * 48;
  EXPECT_GE(share, 40);
  EXPECT_LE(share, 46);
  // What the true frame has and the other lacks is no ghost.
  EXPECT_EQ(count_artifacts(ghost, truth).ghost, 0);
}

TEST(Artifacts, a_pinhole_is_a_speckle_and_a_row_of_pixels_is_none) {
  const Rgba8Image truth = wall_with_lamp(10);
  Rgba8Image holed = truth;
  holed(15, 20) = kWall, holed(18, 25) = kWall;
  EXPECT_DOUBLE_EQ(count_artifacts(truth, holed).speckle, 2.0 / (64 * 48));
  EXPECT_EQ(count_artifacts(holed, truth).speckle, 0);
  // An edge that stands a pixel off, its corners included.
  EXPECT_EQ(count_artifacts(truth, wall_with_lamp(11)).speckle, 0);
}

TEST(Artifacts, what_changes_while_the_truth_stands_flickers) {
  const Rgba8Image still = wall_with_lamp(10), moved = wall_with_lamp(11);
  EXPECT_EQ(flicker(still, still, moved, moved), 0);               // wrong, but steady
  EXPECT_EQ(flicker(still, moved, moved, wall_with_lamp(12)), 0);  // moves as the truth, beside it
  // Two columns of 20 pixels change by 80 of 255.
  EXPECT_DOUBLE_EQ(flicker(still, still, still, moved), 2 * 20 * 80 / (255.0 * 64 * 48));
}

TEST(Flip, the_value_of_99_percent_shows_what_the_mean_hides) {
  const Rgba8Image truth = wall_with_lamp(10);
  Rgba8Image spot = truth;
  for (int y = 20; y < 28; ++y)
    for (int x = 40; x < 48; ++x) spot(x, y) = glm::u8vec4(255, 255, 0, 255);
  const FlipSummary seen = summarize_flip(truth, spot);
  EXPECT_DOUBLE_EQ(seen.mean, flip(truth, spot));
  Image<float> map = flip_map(truth, spot);
  std::vector<float> values(map.texels().begin(), map.texels().end());
  std::sort(values.begin(), values.end());
  // 3072 pixels: 3042 of them are 99 % and some.
  EXPECT_EQ(seen.p99, double(values[3041]));
  EXPECT_GT(seen.p99, 5 * seen.mean);
  EXPECT_EQ(summarize_flip(truth, truth).p99, 0);
}

}  // namespace
}  // namespace rilievo
