#include "rilievo/measure/artifacts.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

using ByteMap = Image<std::uint8_t>;

constexpr int kArtifactRows = 32;

// Three rows of one channel, each with a pixel more on both sides.
class Neighborhood {
 public:
  Neighborhood(const Rgba8Image& frame, int channel)
      : frame_(frame),
        channel_(channel),
        stride_(std::size_t(frame.width()) + 2),
        rows_(3 * stride_) {}

  // Of row `y` of the frame: above, at, below it. [0] is the pixel left of the frame.
  std::array<const std::uint8_t*, 3> around(int y) {
    for (int j = 0; j < 3; ++j) {
      const auto from = frame_.row(std::clamp(y + j - 1, 0, frame_.height() - 1));
      std::uint8_t* const to = &rows_[std::size_t(j) * stride_];
      for (std::size_t x = 0; x < from.size(); ++x) to[x + 1] = from[x][channel_];
      to[0] = to[1];
      to[stride_ - 1] = to[stride_ - 2];
    }
    return {rows_.data(), rows_.data() + stride_, rows_.data() + 2 * stride_};
  }

 private:
  const Rgba8Image& frame_;
  int channel_;
  std::size_t stride_;
  std::vector<std::uint8_t> rows_;
};

// of_row(rows around, out row) raises the values of each row, channel by channel.
template <typename OfRow>
ByteMap most_of_channels(const Rgba8Image& frame, const OfRow& of_row) {
  ByteMap out(frame.width(), frame.height(), std::uint8_t(0));
  parallel_for(0, (frame.height() + kArtifactRows - 1) / kArtifactRows, [&](int strip) {
    for (int c = 0; c < 3; ++c) {
      Neighborhood neighborhood(frame, c);
      for (int y = strip * kArtifactRows; y < std::min((strip + 1) * kArtifactRows, frame.height());
           ++y)
        of_row(neighborhood.around(y), frame.width(), out.row(y).data());
    }
  });
  return out;
}

void raise_by_edges(const std::array<const std::uint8_t*, 3>& r, int width, std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    const int left = r[0][x] + 2 * r[1][x] + r[2][x];
    const int right = r[0][x + 2] + 2 * r[1][x + 2] + r[2][x + 2];
    const int above = r[0][x] + 2 * r[0][x + 1] + r[0][x + 2];
    const int below = r[2][x] + 2 * r[2][x + 1] + r[2][x + 2];
    const int most = std::max(std::abs(right - left), std::abs(below - above)) / 4;
    out[x] = std::uint8_t(std::max(int(out[x]), most));
  }
}

// Batcher's network for eight values, without what only the outer ones need: afterwards v[3] and
// v[4] are the values in the middle.
void raise_by_isolation(const std::array<const std::uint8_t*, 3>& r, int width, std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    std::uint8_t v[8] = {r[0][x],     r[0][x + 1], r[0][x + 2], r[1][x],
                         r[1][x + 2], r[2][x],     r[2][x + 1], r[2][x + 2]};
    const auto order = [&](int a, int b) {
      const std::uint8_t low = std::min(v[a], v[b]), high = std::max(v[a], v[b]);
      v[a] = low, v[b] = high;
    };
    order(0, 1), order(2, 3), order(4, 5), order(6, 7);
    order(0, 2), order(1, 3), order(4, 6), order(5, 7);
    order(1, 2), order(5, 6);
    order(0, 4), order(1, 5), order(2, 6), order(3, 7);
    order(2, 4), order(3, 5);
    order(3, 4);
    const std::uint8_t at = r[1][x + 1];
    const int off = std::max({int(v[3]) - at, at - int(v[4]), 0});
    out[x] = std::uint8_t(std::max(int(out[x]), off));
  }
}

// The largest value within kArtifactReach.
ByteMap within_reach(const ByteMap& of) {
  const int w = of.width(), h = of.height();
  ByteMap along(w, h), out(w, h);
  parallel_for(0, (h + kArtifactRows - 1) / kArtifactRows, [&](int strip) {
    for (int y = strip * kArtifactRows; y < std::min((strip + 1) * kArtifactRows, h); ++y)
      for (int x = 0; x < w; ++x) {
        std::uint8_t most = 0;
        for (int i = std::max(x - kArtifactReach, 0); i <= std::min(x + kArtifactReach, w - 1); ++i)
          most = std::max(most, of(i, y));
        along(x, y) = most;
      }
  });
  parallel_for(0, (h + kArtifactRows - 1) / kArtifactRows, [&](int strip) {
    for (int y = strip * kArtifactRows; y < std::min((strip + 1) * kArtifactRows, h); ++y) {
      const auto to = out.row(y);
      std::fill(to.begin(), to.end(), std::uint8_t(0));
      for (int j = std::max(y - kArtifactReach, 0); j <= std::min(y + kArtifactReach, h - 1); ++j) {
        const auto from = along.row(j);
        for (std::size_t x = 0; x < to.size(); ++x) to[x] = std::max(to[x], from[x]);
      }
    }
  });
  return out;
}

double excess_share(const ByteMap& truth, const ByteMap& frame) {
  const ByteMap allowed = within_reach(truth);
  std::size_t count = 0;
  for (std::size_t i = 0; i < frame.texels().size(); ++i)
    count += int(frame.texels()[i]) - int(allowed.texels()[i]) >= kArtifactStep;
  return double(count) / double(frame.texels().size());
}

// The change of the channel that changes most.
ByteMap largest_change(const Rgba8Image& before, const Rgba8Image& now) {
  ByteMap out(now.width(), now.height());
  for (std::size_t i = 0; i < out.texels().size(); ++i) {
    const glm::u8vec4 &a = before.texels()[i], &b = now.texels()[i];
    out.texels()[i] =
        std::uint8_t(std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)}));
  }
  return out;
}

void expect_same_size([[maybe_unused]] const Rgba8Image& a, [[maybe_unused]] const Rgba8Image& b) {
  RILIEVO_EXPECTS(!a.empty());
  RILIEVO_EXPECTS(a.width() == b.width() && a.height() == b.height());
}

}  // namespace

Image<std::uint8_t> edges(const Rgba8Image& frame) {
  return most_of_channels(frame, raise_by_edges);
}

Image<std::uint8_t> isolation(const Rgba8Image& frame) {
  return most_of_channels(frame, raise_by_isolation);
}

Artifacts count_artifacts(const Rgba8Image& truth, const Rgba8Image& frame) {
  expect_same_size(truth, frame);
  return {excess_share(edges(truth), edges(frame)),
          excess_share(isolation(truth), isolation(frame))};
}

double flicker(const Rgba8Image& true_before, const Rgba8Image& truth, const Rgba8Image& before,
               const Rgba8Image& frame) {
  expect_same_size(truth, true_before);
  expect_same_size(truth, frame);
  expect_same_size(truth, before);
  const ByteMap allowed = within_reach(largest_change(true_before, truth)),
                seen = largest_change(before, frame);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < seen.texels().size(); ++i)
    sum += std::uint64_t(std::max(int(seen.texels()[i]) - int(allowed.texels()[i]), 0));
  return double(sum) / (255.0 * double(seen.texels().size()));
}

}  // namespace rilievo
