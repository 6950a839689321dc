#include "rilievo/measure/gap_width.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace rilievo {
namespace {

// How much farther is behind.
constexpr float kBehind = 1.01f;

// 1 where the frame lacks what the true frame shows.
Image<std::uint8_t> lacking(const IdImage& true_ids, const Image<float>& true_eye_z,
                            const Image<float>& eye_z) {
  const int w = true_ids.width(), h = true_ids.height();
  Image<std::uint8_t> lacks(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::uint32_t object = true_ids(x, y);
      if (object == 0 || !(eye_z(x, y) > kBehind * true_eye_z(x, y))) continue;
      float farthest = 0;
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, h - 1); ++j)
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, w - 1); ++i)
          if (true_ids(i, j) == object) farthest = std::max(farthest, true_eye_z(i, j));
      lacks(x, y) = eye_z(x, y) > kBehind * farthest;
    }
  return lacks;
}

// Lowers `shortest` to the lengths of the runs along (dx, dy), dx or dy 1.
void shorten(const Image<std::uint8_t>& lacks, int dx, int dy, double step,
             Image<double>& shortest) {
  const int w = lacks.width(), h = lacks.height();
  const auto in_run = [&](int x, int y) {
    return x >= 0 && x < w && y >= 0 && y < h && lacks(x, y) != 0;
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      if (!in_run(x, y) || in_run(x - dx, y - dy)) continue;  // not where a run begins
      int length = 1;
      while (in_run(x + length * dx, y + length * dy)) ++length;
      for (int i = 0; i < length; ++i) {
        double& s = shortest(x + i * dx, y + i * dy);
        s = std::min(s, length * step);
      }
    }
}

}  // namespace

double widest_gap_px(const IdImage& true_ids, const Image<float>& true_eye_z,
                     const Image<float>& eye_z) {
  const int w = true_ids.width(), h = true_ids.height();
  RILIEVO_EXPECTS(true_eye_z.width() == w && true_eye_z.height() == h);
  RILIEVO_EXPECTS(eye_z.width() == w && eye_z.height() == h);
  const Image<std::uint8_t> lacks = lacking(true_ids, true_eye_z, eye_z);
  if (std::ranges::count(lacks.texels(), 1) == 0) return 0;
  Image<double> shortest(w, h, std::numeric_limits<double>::infinity());
  shorten(lacks, 1, 0, 1, shortest);
  shorten(lacks, 0, 1, 1, shortest);
  shorten(lacks, 1, 1, std::numbers::sqrt2, shortest);
  shorten(lacks, 1, -1, std::numbers::sqrt2, shortest);
  double widest = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (lacks(x, y) != 0) widest = std::max(widest, shortest(x, y));
  return widest;
}

}  // namespace rilievo
