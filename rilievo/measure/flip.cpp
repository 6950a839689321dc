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
// continue beyond their borders with their outermost pixels.

#include "rilievo/measure/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/measure/flip_kernels.h"

namespace rilievo {
namespace {

constexpr int kFlipRows = 48;  // output rows of a strip
constexpr double kColorExponent = 0.7, kBend = 0.4, kBent = 0.95;

// Linear sRGB to X Y Z (D65), over the white's: rows sum to 1.
struct Colorimetry {
  glm::mat3 xyz_from_rgb, rgb_from_xyz;
  std::array<float, 256> linear;  // from an 8-bit sRGB value

  Colorimetry() {
    // IEC 61966-2-1 in whole numbers; columns are R, G, B.
    glm::dmat3 m(10135552.0 / 24577794, 2613072.0 / 12288897, 1425312.0 / 73733382,
                 8788810.0 / 24577794, 8788810.0 / 12288897, 8788810.0 / 73733382,
                 4435075.0 / 24577794, 887015.0 / 12288897, 70074185.0 / 73733382);
    const glm::dvec3 white = m * glm::dvec3(1.0);
    for (int c = 0; c < 3; ++c) m[c] /= white;
    xyz_from_rgb = glm::mat3(m);
    rgb_from_xyz = glm::mat3(glm::inverse(m));
    for (int i = 0; i < 256; ++i) linear[i] = linear_from_srgb(float(i) / 255.0f);
  }
};

float lab_curve(float t) {
  constexpr float kDelta = 6.0f / 29;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29;
}

// L*, and a* b* under Hunt's adjustment.
glm::vec3 hunt_lab(const glm::vec3& xyz) {
  const float x = lab_curve(xyz.x), y = lab_curve(xyz.y), z = lab_curve(xyz.z);
  const float l = 116 * y - 16;
  return {l, 0.01f * l * 500 * (x - y), 0.01f * l * 200 * (y - z)};
}

float hyab(const glm::vec3& p, const glm::vec3& q) {
  const glm::vec3 d = p - q;
  return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

// Planes of a strip, filtered along rows ...
enum AlongRows { kY, kCx, kCz0, kCz1, kSmooth, kSlope, kCurve, kAlongRows };
// ... and a row of them, filtered along columns too.
enum Filtered { kYOut, kCxOut, kCzOut, kEdgeX, kEdgeY, kPointX, kPointY, kFiltered };

// out[x] += sum of kernel[k] * in[k][x].
void accumulate(const FlipKernel& kernel, const float* const* in, int count, float* out) {
  const std::size_t taps = kernel.size();
  std::size_t k = 0;
  for (; k + 3 < taps; k += 4) {
    const float w0 = kernel[k], w1 = kernel[k + 1], w2 = kernel[k + 2], w3 = kernel[k + 3];
    const float *a = in[k], *b = in[k + 1], *c = in[k + 2], *d = in[k + 3];
    for (int x = 0; x < count; ++x) out[x] += (w0 * a[x] + w1 * b[x]) + (w2 * c[x] + w3 * d[x]);
  }
  for (; k < taps; ++k)
    for (int x = 0; x < count; ++x) out[x] += kernel[k] * in[k][x];
}

// A strip of one frame.
class Strip {
 public:
  Strip(const Rgba8Image& frame, const Colorimetry& colors, const FlipKernels& kernels, int first,
        int rows)
      : kernels_(kernels),
        width_(frame.width()),
        first_(first - kernels.radius),
        planes_(std::size_t(rows + 2 * kernels.radius) * kAlongRows * width_) {
    std::vector<float> padded(std::size_t(3) * padded_width());
    for (int i = 0; i < rows + 2 * kernels.radius; ++i) {
      const int y = std::clamp(first_ + i, 0, frame.height() - 1);
      // Rows beyond the border repeat it.
      if (i > 0 && y == std::clamp(first_ + i - 1, 0, frame.height() - 1)) {
        std::copy_n(plane_row(i - 1, 0), std::size_t(kAlongRows) * width_, plane_row(i, 0));
        continue;
      }
      opponents(frame.row(y), colors, padded.data());
      filter_row(padded.data(), i);
    }
  }

  // Row `y` of the frame, filtered both ways: kFiltered planes of width() floats.
  void filter_columns(int y, float* out) const {
    std::fill_n(out, std::size_t(kFiltered) * width_, 0.0f);
    const auto down = [&](const FlipKernel& kernel, AlongRows from, Filtered to) {
      std::array<const float*, kMaxTaps> rows;
      const int radius = int(kernel.size() / 2);
      for (int k = 0; k < int(kernel.size()); ++k)
        rows[k] = plane_row(y - first_ - radius + k, from);
      accumulate(kernel, rows.data(), width_, out + std::size_t(to) * width_);
    };
    down(kernels_.achromatic, kY, kYOut);
    down(kernels_.red_green, kCx, kCxOut);
    down(kernels_.blue_yellow_down[0], kCz0, kCzOut);
    down(kernels_.blue_yellow_down[1], kCz1, kCzOut);
    down(kernels_.smooth, kSlope, kEdgeX);
    down(kernels_.slope, kSmooth, kEdgeY);
    down(kernels_.smooth, kCurve, kPointX);
    down(kernels_.curve, kSmooth, kPointY);
  }

  static constexpr int kMaxTaps = 256;  // at 500 pixels a degree the radius is 68

 private:
  [[nodiscard]] int padded_width() const { return width_ + 2 * kernels_.radius; }
  [[nodiscard]] float* plane_row(int row, int plane) {
    return &planes_[std::size_t(row * kAlongRows + plane) * width_];
  }
  [[nodiscard]] const float* plane_row(int row, int plane) const {
    return &planes_[std::size_t(row * kAlongRows + plane) * width_];
  }

  void opponents(std::span<const glm::u8vec4> row, const Colorimetry& colors, float* out) const {
    const int n = padded_width();
    for (int i = 0; i < n; ++i) {
      const glm::u8vec4 c = row[std::size_t(std::clamp(i - kernels_.radius, 0, width_ - 1))];
      const glm::vec3 xyz = colors.xyz_from_rgb *
                            glm::vec3(colors.linear[c.r], colors.linear[c.g], colors.linear[c.b]);
      out[i] = xyz.y;
      out[n + i] = xyz.x - xyz.y;
      out[2 * n + i] = xyz.y - xyz.z;
    }
  }

  void filter_row(const float* padded, int row) {
    const auto along = [&](const FlipKernel& kernel, int from, AlongRows to) {
      std::array<const float*, kMaxTaps> shifted;
      const int radius = int(kernel.size() / 2);
      for (int k = 0; k < int(kernel.size()); ++k)
        shifted[k] = padded + from * padded_width() + kernels_.radius - radius + k;
      accumulate(kernel, shifted.data(), width_, plane_row(row, to));
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
  int width_, first_;
  std::vector<float> planes_;  // row by row, kAlongRows planes each
};

struct Compare {
  const Colorimetry& colors;
  float most;  // (HyAB distance of green and blue) ^ 0.7: the largest there is

  explicit Compare(const Colorimetry& c) : colors(c) {
    const float distance = hyab(hunt_lab(c.xyz_from_rgb[1]), hunt_lab(c.xyz_from_rgb[2]));
    most = std::pow(distance, float(kColorExponent));
  }

  [[nodiscard]] glm::vec3 lab(const float* f, int width, int x) const {
    const float y = f[kYOut * width + x];
    const glm::vec3 xyz(f[kCxOut * width + x] + y, y, y - f[kCzOut * width + x]);
    const glm::vec3 rgb = glm::clamp(colors.rgb_from_xyz * xyz, 0.0f, 1.0f);
    return hunt_lab(colors.xyz_from_rgb * rgb);
  }

  static float length(const float* f, int width, Filtered plane, int x) {
    const float a = f[plane * width + x], b = f[(plane + 1) * width + x];
    return std::sqrt(a * a + b * b);
  }

  [[nodiscard]] float operator()(const float* truth, const float* frame, int width, int x) const {
    const float color =
        std::pow(hyab(lab(truth, width, x), lab(frame, width, x)), float(kColorExponent));
    const float bend = float(kBend) * most;
    const float d_color = color < bend
                              ? float(kBent) / bend * color
                              : float(kBent) + (color - bend) / (most - bend) * float(1 - kBent);
    const float edge = std::abs(length(truth, width, kEdgeX, x) - length(frame, width, kEdgeX, x));
    const float point =
        std::abs(length(truth, width, kPointX, x) - length(frame, width, kPointX, x));
    const float d_feature = std::sqrt(std::max(edge, point) * float(std::sqrt(0.5)));
    return std::pow(d_color, 1 - d_feature);
  }
};

}  // namespace

Image<float> flip_map(const Rgba8Image& truth, const Rgba8Image& frame,
                      const FlipOptions& options) {
  RILIEVO_EXPECTS(!truth.empty());
  RILIEVO_EXPECTS(truth.width() == frame.width() && truth.height() == frame.height());
  RILIEVO_EXPECTS(5 <= options.pixels_per_degree && options.pixels_per_degree <= 500);
  static const Colorimetry colors;
  const Compare compare(colors);
  const FlipKernels kernels = make_flip_kernels(options.pixels_per_degree);
  const int w = truth.width(), h = truth.height();
  Image<float> out(w, h);
  parallel_for(0, (h + kFlipRows - 1) / kFlipRows, [&](int i) {
    const int first = i * kFlipRows, rows = std::min(kFlipRows, h - first);
    const Strip truth_strip(truth, colors, kernels, first, rows);
    const Strip frame_strip(frame, colors, kernels, first, rows);
    std::vector<float> a(std::size_t(kFiltered) * w), b(a.size());
    for (int y = first; y < first + rows; ++y) {
      truth_strip.filter_columns(y, a.data());
      frame_strip.filter_columns(y, b.data());
      for (int x = 0; x < w; ++x) out(x, y) = compare(a.data(), b.data(), w, x);
    }
  });
  return out;
}

double flip(const Rgba8Image& truth, const Rgba8Image& frame, const FlipOptions& options) {
  const Image<float> map = flip_map(truth, frame, options);
  double sum = 0;
  for (float v : map.texels()) sum += double(v);
  return sum / double(map.texels().size());
}

}  // namespace rilievo
