// Few texels lie along silhouettes: what is covered around each of a row is found many at a time,
// and eight that are all inside, or all outside, are passed over.
#include "rilievo/layered_relief/soften_silhouettes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "rilievo/core/depth.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr std::uint16_t kUncovered = delta_transparent(16);
constexpr int kSoftenedTexels = 1 << 16;  // of a strip: fewer take less time than to share them
constexpr unsigned kAllCovered = 16;
constexpr std::size_t kAtOnce = 8;

// Of each texel of a row: 1 2 1 of what is covered there and beside it.
void covered_across(const Prewarped& picture, int y, std::vector<std::uint8_t>& covered,
                    std::vector<std::uint8_t>& sums) {
  const auto width = std::size_t(picture.width());
  const int row = std::clamp(y, 0, picture.height() - 1);
  const std::uint16_t* const delta = &picture.delta[std::size_t(row) * width];
  covered.resize(width + 2), sums.resize(width);
  std::uint8_t* const to = covered.data() + 1;
  for (std::size_t x = 0; x < width; ++x) to[x] = std::uint8_t(delta[x] != kUncovered);
  covered[0] = to[0], to[width] = to[width - 1];
  const std::uint8_t* const from = covered.data();
  std::uint8_t* const out = sums.data();  // the compiler need not look where it is for each texel
  for (std::size_t x = 0; x < width; ++x)
    out[x] = std::uint8_t(from[x] + 2 * from[x + 1] + from[x + 2]);
}

// A colour's `sum` of 16 shares, two channels at once: 16 bits hold 16 times a byte.
std::uint32_t share_of(std::uint32_t color, unsigned sum) {
  constexpr std::uint32_t kEven = 0x00ff00ff, kHalf = 0x00080008;
  const std::uint32_t even = ((color & kEven) * sum + kHalf) >> 4 & kEven;
  const std::uint32_t odd = ((color >> 8 & kEven) * sum + kHalf) >> 4 & kEven;
  return even | odd << 8;
}

}  // namespace

void soften_silhouettes(Prewarped& picture) {
  const int height = picture.height();
  const auto width = std::size_t(picture.width());
  struct Rows {
    std::vector<std::uint8_t> covered, sums;
    std::array<std::vector<std::uint8_t>, 3> across;
  };
  const int rows_each = std::max(1, kSoftenedTexels / std::max(1, picture.width()));
  parallel_for(0, (height + rows_each - 1) / rows_each, [&](int strip) {
    static thread_local Rows rows;  // kept: a steady frame allocates nothing
    rows.sums.resize(width);
    std::uint8_t* const sums = rows.sums.data();
    const int first = strip * rows_each, end = std::min(first + rows_each, height);
    const auto across = [&](int y) -> std::vector<std::uint8_t>& {
      return rows.across[std::size_t(y - first + 3) % 3];
    };
    for (int y = first - 1; y <= first; ++y) covered_across(picture, y, rows.covered, across(y));
    for (int y = first; y < end; ++y) {
      covered_across(picture, y + 1, rows.covered, across(y + 1));
      const std::uint8_t* const above = across(y - 1).data();
      const std::uint8_t* const own = across(y).data();
      const std::uint8_t* const below = across(y + 1).data();
      for (std::size_t x = 0; x < width; ++x)
        sums[x] = std::uint8_t(above[x] + 2 * own[x] + below[x]);
      glm::u8vec4* const colors = &picture.color[std::size_t(y) * width];
      const auto all_are = [](const std::uint8_t* values, unsigned value) {
        std::uint64_t eight = 0;
        std::memcpy(&eight, values, kAtOnce);
        return eight == value * std::uint64_t(0x0101010101010101);
      };
      for (std::size_t x = 0; x < width; x += kAtOnce) {
        if (x + kAtOnce <= width && (all_are(own + x, 0) || all_are(sums + x, kAllCovered)))
          continue;
        const std::size_t count = std::min(kAtOnce, width - x);
        std::uint32_t some[kAtOnce];
        std::memcpy(some, colors + x, count * sizeof(std::uint32_t));
        for (std::size_t u = 0; u < count; ++u) some[u] = share_of(some[u], sums[x + u]);
        std::memcpy(colors + x, some, count * sizeof(std::uint32_t));
      }
    }
  });
}

}  // namespace rilievo
