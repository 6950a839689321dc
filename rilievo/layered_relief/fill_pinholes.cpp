#include "rilievo/layered_relief/fill_pinholes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rilievo/core/depth.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr int kPinholeRows = 32;

struct Filled {
  std::size_t texel = 0;
  glm::u8vec4 color{0};
  std::uint16_t delta = 0;
};

// Of row `y`, which has rows above and below it: how many neighbours of each texel are in front.
void count_in_front(const std::uint16_t* delta, std::size_t width, int step, std::uint8_t* counts) {
  std::fill_n(counts, width, std::uint8_t(0));
  const std::uint16_t* const rows[] = {delta - width, delta, delta + width};
  for (int k = 0; k < 9; ++k) {
    if (k == 4) continue;
    const std::uint16_t* const beside = rows[k / 3] + k % 3 - 1;
    for (std::size_t x = 1; x + 1 < width; ++x)
      counts[x] = std::uint8_t(counts[x] + (int(delta[x]) > int(beside[x]) + step));
  }
}

}  // namespace

int pinhole_step(const PictureGeometry& geometry) {
  const Camera& camera = geometry.capture;
  // Deltas are steps far (z - near) / (z (far - near)).
  const double z = geometry.plane_z;
  const double texel = z * (camera.window.right - camera.window.left) / camera.width;
  const double per_metre = double(delta_steps(16)) * camera.z_far * camera.z_near /
                           ((camera.z_far - camera.z_near) * z * z);
  return int(std::clamp(std::ceil(kPinholeDepth * texel * per_metre), 1.0, 65535.0));
}

void fill_pinholes(Prewarped& picture, std::vector<std::uint16_t>& before) {
  const int w = picture.width(), h = picture.height();
  if (w < 3 || h < 3) return;
  before = picture.delta;
  const int step = pinhole_step(picture.geometry);
  const auto width = std::size_t(w);
  const std::array<std::ptrdiff_t, 8> around{-w - 1, -w, -w + 1, -1, 1, w - 1, w, w + 1};
  std::vector<std::vector<Filled>> filled(std::size_t((h + kPinholeRows - 1) / kPinholeRows));
  parallel_for(std::size_t(0), filled.size(), [&](std::size_t strip) {
    std::vector<std::uint8_t> counts(width);
    const int end = std::min((int(strip) + 1) * kPinholeRows, h - 1);
    for (int y = std::max(int(strip) * kPinholeRows, 1); y < end; ++y) {
      const std::uint16_t* const row = &before[std::size_t(y) * width];
      count_in_front(row, width, step, counts.data());
      for (std::size_t x = 1; x + 1 < width; ++x) {
        if (counts[x] < kPinholeNeighbors) continue;
        const std::size_t texel = std::size_t(y) * width + x;
        std::size_t from = texel;
        int farthest = -1;
        for (const std::ptrdiff_t offset : around) {
          const std::size_t beside = std::size_t(std::ptrdiff_t(texel) + offset);
          const int delta = before[beside];
          if (int(before[texel]) > delta + step && delta > farthest)
            farthest = delta, from = beside;
        }
        filled[strip].push_back({texel, picture.color[from], before[from]});
      }
    }
  });
  for (const std::vector<Filled>& of_strip : filled)
    for (const Filled& f : of_strip)
      picture.color[f.texel] = f.color, picture.delta[f.texel] = f.delta;
}

}  // namespace rilievo
