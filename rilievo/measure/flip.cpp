// Cf. [Andersson et al. 2020]. Per frame, from linear X Y Z over those of white:
//
//   opponent planes  y = Y, cx = X - Y, cz = Y - Z           (the paper's Y Cx Cz up to constants,
//                                                             which filters that sum to 1 carry)
//   colour           blurred by contrast sensitivity, back to RGB, clamped, L*a*b* with a and b
//                    scaled by L / 100 (Hunt)
//   features         slope and curvature of y in both directions, as two lengths: edge and point
//
// and per pixel of two frames:
//
//   dC = HyAB distance ^ 0.7, mapped piecewise linearly so that 0.4 of the largest goes to 0.95
//   dF = (max(|edge - edge'|, |point - point'|) / sqrt 2) ^ 0.5
//   FLIP = dC ^ (1 - dF)
//
// Every filter is a product of one along rows and one along columns (flip_kernels.h). Frames
// continue beyond their borders with their outermost pixels. Where no pixel differs within a
// filter's reach FLIP is exactly 0 and is not computed: columns are left out, for a strip of rows.

#include "rilievo/measure/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/measure/flip_kernels.h"
#include "rilievo/measure/flip_rows.h"

namespace rilievo {
namespace {

constexpr int kFlipRows = 48;  // output rows of a strip

// Linear sRGB to X Y Z (D65), over the white's: rows sum to 1.
struct Colorimetry {
  FlipColors matrices;
  // y, cx, cz of an 8-bit sRGB value of each channel.
  std::array<std::array<glm::vec3, 256>, 3> opponents;
  // (HyAB distance of green and blue) ^ 0.7: the largest there is.
  float most;

  Colorimetry() {
    // IEC 61966-2-1 in whole numbers; columns are R, G, B.
    glm::dmat3 m(10135552.0 / 24577794, 2613072.0 / 12288897, 1425312.0 / 73733382,
                 8788810.0 / 24577794, 8788810.0 / 12288897, 8788810.0 / 73733382,
                 4435075.0 / 24577794, 887015.0 / 12288897, 70074185.0 / 73733382);
    const glm::dvec3 white = m * glm::dvec3(1.0);
    for (int c = 0; c < 3; ++c) m[c] /= white;
    matrices = {glm::mat3(m), glm::mat3(glm::inverse(m))};
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 256; ++i) {
        const glm::vec3 xyz = linear_from_srgb(float(i) / 255.0f) * matrices.xyz_from_rgb[c];
        opponents[std::size_t(c)][std::size_t(i)] = {xyz.y, xyz.x - xyz.y, xyz.y - xyz.z};
      }
    most = flip_distance(hunt_lab(glm::vec3(m[1])), hunt_lab(glm::vec3(m[2])));
  }

 private:
  static float lab_curve(float t) {
    constexpr float kDelta = 6.0f / 29;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29;
  }
  // L*, and a* b* under Hunt's adjustment.
  static glm::vec3 hunt_lab(const glm::vec3& xyz) {
    const float x = lab_curve(xyz.x), y = lab_curve(xyz.y), z = lab_curve(xyz.z);
    const float l = 116 * y - 16;
    return {l, 0.01f * l * 500 * (x - y), 0.01f * l * 200 * (y - z)};
  }
};

const Colorimetry& colorimetry() {
  static const Colorimetry colors;
  return colors;
}

// Planes of a strip, filtered along rows.
enum AlongRows { kY, kCx, kCz0, kCz1, kSmooth, kSlope, kCurve, kAlongRows };

// Columns [first, last) of a frame.
struct Columns {
  int first = 0, last = 0;
  [[nodiscard]] int count() const { return std::max(0, last - first); }
};

// What is compared of a strip of one frame.
class Strip {
 public:
  Strip(const Rgba8Image& frame, const FlipKernels& kernels, int first, int rows,
        const Columns& columns)
      : kernels_(kernels),
        width_(flip_padded(columns.count())),
        first_(first - kernels.radius),
        first_column_(columns.first - kernels.radius),
        planes_(std::size_t(rows + 2 * kernels.radius) * kAlongRows * std::size_t(width_)),
        filtered_(std::size_t(kFlipFiltered) * std::size_t(width_)) {
    std::vector<float> padded(std::size_t(3) * std::size_t(padded_width()));
    for (int i = 0; i < rows + 2 * kernels.radius; ++i) {
      const int y = std::clamp(first_ + i, 0, frame.height() - 1);
      // Rows beyond the border repeat it.
      if (i > 0 && y == std::clamp(first_ + i - 1, 0, frame.height() - 1)) {
        std::copy_n(plane_row(i - 1, 0), std::size_t(kAlongRows) * std::size_t(width_),
                    plane_row(i, 0));
        continue;
      }
      opponents(frame.row(y), padded.data());
      filter_row(padded.data(), i);
    }
  }

  [[nodiscard]] int width() const { return width_; }

  // Row `y` of the frame: kFlipSeen planes, `pitch` apart, of width() floats.
  void see_row(int y, float* seen, int pitch) {
    const auto down = [&](const FlipKernel& kernel, AlongRows from, FlipFiltered to) {
      std::array<const float*, kMaxTaps> rows;
      const int radius = int(kernel.size() / 2);
      for (int k = 0; k < int(kernel.size()); ++k)
        rows[std::size_t(k)] = plane_row(y - first_ - radius + k, from);
      float* const out = &filtered_[std::size_t(to) * std::size_t(width_)];
      flip_filter(kernel, rows.data(), width_, out);
      return out;
    };
    down(kernels_.achromatic, kY, kYOut);
    down(kernels_.red_green, kCx, kCxOut);
    // Two terms; the row that is not needed yet has room for one.
    const float* const first = down(kernels_.blue_yellow_down[0], kCz0, kEdgeX);
    float* const both = down(kernels_.blue_yellow_down[1], kCz1, kCzOut);
    for (int x = 0; x < width_; ++x) both[x] += first[x];
    down(kernels_.smooth, kSlope, kEdgeX);
    down(kernels_.slope, kSmooth, kEdgeY);
    down(kernels_.smooth, kCurve, kPointX);
    down(kernels_.curve, kSmooth, kPointY);
    flip_see(colorimetry().matrices, filtered_.data(), width_, seen, pitch);
  }

  static constexpr int kMaxTaps = 256;  // at 500 pixels a degree the radius is 68

 private:
  [[nodiscard]] int padded_width() const { return width_ + 2 * kernels_.radius; }
  [[nodiscard]] float* plane_row(int row, int plane) {
    return &planes_[std::size_t(row * kAlongRows + plane) * std::size_t(width_)];
  }

  void opponents(std::span<const glm::u8vec4> row, float* out) const {
    const auto& of = colorimetry().opponents;
    const int n = padded_width();
    for (int i = 0; i < n; ++i) {
      const glm::u8vec4 c = row[std::size_t(std::clamp(first_column_ + i, 0, int(row.size()) - 1))];
      const glm::vec3 sum = of[0][c.r] + of[1][c.g] + of[2][c.b];
      out[i] = sum.x, out[n + i] = sum.y, out[2 * n + i] = sum.z;
    }
  }

  void filter_row(const float* padded, int row) {
    const auto along = [&](const FlipKernel& kernel, int from, AlongRows to) {
      std::array<const float*, kMaxTaps> shifted;
      const int radius = int(kernel.size() / 2);
      for (int k = 0; k < int(kernel.size()); ++k)
        shifted[std::size_t(k)] = padded + from * padded_width() + kernels_.radius - radius + k;
      flip_filter(kernel, shifted.data(), width_, plane_row(row, to));
    };
    along(kernels_.achromatic, 0, kY);
    along(kernels_.red_green, 1, kCx);
    along(kernels_.blue_yellow[0], 2, kCz0);
    along(kernels_.blue_yellow[1], 2, kCz1);
    along(kernels_.smooth, 0, kSmooth);
    along(kernels_.slope, 0, kSlope);
    along(kernels_.curve, 0, kCurve);
  }

  const FlipKernels& kernels_;
  int width_, first_, first_column_;
  std::vector<float> planes_;  // row by row, kAlongRows planes each
  std::vector<float> filtered_;
};

// The columns of rows [first, first + rows) that a pixel which differs is within reach of.
Columns differing(const Rgba8Image& truth, const Rgba8Image& frame, int first, int rows,
                  int radius) {
  const int w = truth.width();
  int low = w, high = 0;
  const auto differ = [](const glm::u8vec4& a, const glm::u8vec4& b) {
    return a.r != b.r || a.g != b.g || a.b != b.b;
  };
  for (int y = std::max(first - radius, 0); y < std::min(first + rows + radius, truth.height());
       ++y) {
    const auto a = truth.row(y), b = frame.row(y);
    int x = 0;
    while (x < low && !differ(a[std::size_t(x)], b[std::size_t(x)])) ++x;
    low = std::min(low, x);
    x = w;
    while (x > high && !differ(a[std::size_t(x - 1)], b[std::size_t(x - 1)])) --x;
    high = std::max(high, x);
  }
  if (low >= high) return {};
  return {std::max(low - radius, 0), std::min(high + radius, w)};
}

double mean_of(const Image<float>& map) {
  double sum = 0;
  for (float v : map.texels()) sum += double(v);
  return sum / double(map.texels().size());
}

}  // namespace

struct FlipTruth::State {
  const Rgba8Image& truth;
  FlipKernels kernels;
  int pitch = 0;            // of a plane; what is compared may reach beyond a row's end
  std::vector<float> seen;  // row by row, kFlipSeen planes each; empty: not kept

  State(const Rgba8Image& of, const FlipOptions& options)
      : truth(of), kernels(make_flip_kernels(options.pixels_per_degree)) {
    RILIEVO_EXPECTS(!truth.empty());
    RILIEVO_EXPECTS(5 <= options.pixels_per_degree && options.pixels_per_degree <= 500);
  }
  [[nodiscard]] float* seen_row(int y) {
    return &seen[std::size_t(y) * kFlipSeen * std::size_t(pitch)];
  }
  [[nodiscard]] int strips() const { return (truth.height() + kFlipRows - 1) / kFlipRows; }
  [[nodiscard]] int rows_of(int strip) const {
    return std::min(kFlipRows, truth.height() - strip * kFlipRows);
  }
  void keep();
  [[nodiscard]] Image<float> map(const Rgba8Image& frame);
};

void FlipTruth::State::keep() {
  pitch = flip_padded(truth.width()) + kFlipLanes;
  seen.resize(std::size_t(truth.height()) * kFlipSeen * std::size_t(pitch));
  parallel_for(0, strips(), [&](int i) {
    const int first = i * kFlipRows, rows = rows_of(i);
    Strip strip(truth, kernels, first, rows, {0, truth.width()});
    for (int y = first; y < first + rows; ++y) strip.see_row(y, seen_row(y), pitch);
  });
}

Image<float> FlipTruth::State::map(const Rgba8Image& frame) {
  RILIEVO_EXPECTS(truth.width() == frame.width() && truth.height() == frame.height());
  Image<float> out(truth.width(), truth.height());
  parallel_for(0, strips(), [&](int i) {
    const int first = i * kFlipRows, rows = rows_of(i);
    const Columns columns = differing(truth, frame, first, rows, kernels.radius);
    if (columns.count() == 0) return;
    Strip frame_strip(frame, kernels, first, rows, columns);
    const int width = frame_strip.width();
    std::optional<Strip> truth_strip;
    if (seen.empty()) truth_strip.emplace(truth, kernels, first, rows, columns);
    std::vector<float> a(std::size_t(kFlipSeen) * std::size_t(width)), b(a.size()),
        row(static_cast<std::size_t>(width));
    for (int y = first; y < first + rows; ++y) {
      frame_strip.see_row(y, b.data(), width);
      if (truth_strip) truth_strip->see_row(y, a.data(), width);
      const float* const of_truth = truth_strip ? a.data() : seen_row(y) + columns.first;
      flip_compare(of_truth, truth_strip ? width : pitch, b.data(), width, colorimetry().most,
                   width, row.data());
      std::copy_n(row.begin(), columns.count(), &out(columns.first, y));
    }
  });
  return out;
}

FlipTruth::FlipTruth(const Rgba8Image& truth, const FlipOptions& options)
    : state_(std::make_unique<State>(truth, options)) {
  state_->keep();
}
FlipTruth::~FlipTruth() = default;

double FlipTruth::flip(const Rgba8Image& frame) const { return mean_of(state_->map(frame)); }

Image<float> flip_map(const Rgba8Image& truth, const Rgba8Image& frame,
                      const FlipOptions& options) {
  return FlipTruth::State(truth, options).map(frame);
}

double flip(const Rgba8Image& truth, const Rgba8Image& frame, const FlipOptions& options) {
  return mean_of(flip_map(truth, frame, options));
}

FlipSummary summarize_flip(const Rgba8Image& truth, const Rgba8Image& frame,
                           const FlipOptions& options) {
  Image<float> map = flip_map(truth, frame, options);
  const double mean = mean_of(map);
  const std::span<float> values = map.texels();
  const std::size_t rank = (values.size() * 99 + 99) / 100 - 1;  // rounded up
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(rank), values.end());
  return {mean, double(values[rank])};
}

}  // namespace rilievo
