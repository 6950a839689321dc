// Cf. [Wang et al. 2004], section III.B:
//
//               (2 ma mb + C1) (2 cov + C2)                   C1 = (0.01 * 255)^2
//   SSIM = ---------------------------------------            C2 = (0.03 * 255)^2
//          (ma^2 + mb^2 + C1) (va + vb + C2)
//
// with the window's means m, variances v and covariance. The variances are only ever added, so four
// blurred planes do: a, b, a^2 + b^2, a b. The blur is separable: along rows into a strip's
// buffer, then down its columns. Subtracting 128 from the luma first leaves the variances as they
// are and halves what floats lose in E[a^2] - E[a]^2.

#include "rilievo/measure/ssim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/measure/flip_rows.h"

namespace rilievo {
namespace {

constexpr int kSsimRows = 32;  // output rows of a strip
constexpr int kPlanes = 4;
constexpr float kMiddle = 128.0f;
constexpr float kC1 = 0.01f * 255 * 0.01f * 255, kC2 = 0.03f * 255 * 0.03f * 255;

FlipKernel gaussian() {
  std::array<double, kSsimWindow> w{};
  double sum = 0;
  for (int i = 0; i < kSsimWindow; ++i) {
    const double d = (i - kSsimWindow / 2) / 1.5;
    sum += w[i] = std::exp(-0.5 * d * d);
  }
  FlipKernel out;
  for (int i = 0; i < kSsimWindow; ++i) out.push_back(float(w[i] / sum));
  return out;
}

void luma(std::span<const glm::u8vec4> row, float* out) {
  for (std::size_t x = 0; x < row.size(); ++x)
    out[x] =
        0.299f * float(row[x].r) + 0.587f * float(row[x].g) + 0.114f * float(row[x].b) - kMiddle;
}

// out[x] = sum of window[k] * in[x + k * step], x in [0, count).
void blur(const FlipKernel& window, const float* in, int step, int count, float* out) {
  std::array<const float*, kSsimWindow> from;
  for (int k = 0; k < kSsimWindow; ++k) from[std::size_t(k)] = in + k * step;
  flip_filter(window, from.data(), count, out);
}

float ssim_of(float ma, float mb, float squares, float products) {
  // In this order equal frames yield exactly 1.
  const float variances = squares - (ma * ma + mb * mb);
  const float covariance = products - ma * mb;
  const float a = ma + kMiddle, b = mb + kMiddle;
  return (2 * a * b + kC1) * (2 * covariance + kC2) / ((a * a + b * b + kC1) * (variances + kC2));
}

// The sum of SSIM over each of `sums.size()` windows' rows from row `first` on.
void strip(const Rgba8Image& a, const Rgba8Image& b, const FlipKernel& window, int first,
           std::span<double> sums) {
  const int width = a.width(), inside = width - kSsimWindow + 1, pitch = flip_padded(inside);
  const int in_rows = int(sums.size()) + kSsimWindow - 1, in_pitch = pitch + kSsimWindow;
  std::vector<float> planes(std::size_t(kPlanes) * std::size_t(in_pitch));
  std::vector<float> blurred(std::size_t(kPlanes) * std::size_t(pitch) * std::size_t(in_rows));
  float* const pa = planes.data();
  float *const pb = pa + in_pitch, *const squares = pb + in_pitch,
               *const products = squares + in_pitch;
  for (int y = 0; y < in_rows; ++y) {
    luma(a.row(first + y), pa);
    luma(b.row(first + y), pb);
    for (int x = 0; x < width; ++x) squares[x] = pa[x] * pa[x] + pb[x] * pb[x];
    for (int x = 0; x < width; ++x) products[x] = pa[x] * pb[x];
    for (int p = 0; p < kPlanes; ++p)
      blur(window, pa + p * in_pitch, 1, pitch,
           &blurred[std::size_t(y * kPlanes + p) * std::size_t(pitch)]);
  }
  std::vector<float> means(std::size_t(kPlanes) * std::size_t(pitch));
  for (std::size_t y = 0; y < sums.size(); ++y) {
    blur(window, &blurred[y * kPlanes * std::size_t(pitch)], kPlanes * pitch, kPlanes * pitch,
         means.data());
    float* const m = means.data();
    for (int x = 0; x < inside; ++x)
      m[x] = ssim_of(m[x], m[pitch + x], m[2 * pitch + x], m[3 * pitch + x]);
    double sum = 0;
    for (int x = 0; x < inside; ++x) sum += double(m[x]);
    sums[y] = sum;
  }
}

}  // namespace

double ssim(const Rgba8Image& a, const Rgba8Image& b) {
  RILIEVO_EXPECTS(a.width() == b.width() && a.height() == b.height());
  RILIEVO_EXPECTS(a.width() >= kSsimWindow && a.height() >= kSsimWindow);
  const FlipKernel window = gaussian();
  const int rows = a.height() - kSsimWindow + 1;
  std::vector<double> sums(std::size_t(rows), 0.0);
  parallel_for(0, (rows + kSsimRows - 1) / kSsimRows, [&](int i) {
    const int first = i * kSsimRows;
    strip(a, b, window, first,
          std::span(sums).subspan(std::size_t(first),
                                  std::size_t(std::min(kSsimRows, rows - first))));
  });
  double sum = 0;
  for (double row : sums) sum += row;
  return sum / (double(rows) * (a.width() - kSsimWindow + 1));
}

}  // namespace rilievo
