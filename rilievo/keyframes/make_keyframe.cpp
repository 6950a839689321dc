#include "rilievo/keyframes/make_keyframe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "rilievo/core/color.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// sRGB bytes of linear light, by a table that is exact to a quarter of a byte where the curve is
// steepest and better elsewhere.
class SrgbBytes {
 public:
  SrgbBytes() {
    for (int i = 0; i < kEntries; ++i) {
      const float root = float(i) / (kEntries - 1);
      byte_[std::size_t(i)] = std::uint8_t(srgb_from_linear(root * root) * 255 + 0.5f);
    }
  }
  // Scaled by the square root: the curve of sRGB is close to it.
  [[nodiscard]] std::uint32_t operator()(float linear) const {
    const float clamped = linear > 0 ? std::min(linear, 1.0f) : 0.0f;
    return byte_[std::size_t(std::sqrt(clamped) * (kEntries - 1) + 0.5f)];
  }

 private:
  static constexpr int kEntries = 4096;
  std::array<std::uint8_t, kEntries> byte_{};
};

std::uint32_t bytes_of(const glm::vec4& linear) {
  static const SrgbBytes table;
  return table(linear.r) | table(linear.g) << 8 | table(linear.b) << 16 | 0xff000000u;
}

float inverse_of(float eye_z) { return eye_z < kNoDepth && eye_z > 0 ? 1 / eye_z : 0.0f; }

// Depths that differ by less are one surface's.
constexpr float kSameSurface = 0.03f;

// Of four texels that make up one.
struct Quarters {
  float inverse_z[4];
  std::uint32_t object[4];
};

// The second nearest: where two of four show what is in front, it has half of the texel.
std::pair<float, std::uint32_t> of_four(const Quarters& in) {
  int order[4] = {0, 1, 2, 3};
  std::stable_sort(order, order + 4,
                   [&](int a, int b) { return in.inverse_z[a] > in.inverse_z[b]; });
  const float chosen = in.inverse_z[order[1]];
  float sum = 0;
  int count = 0;
  for (const int i : order)
    if (std::abs(in.inverse_z[i] - chosen) <= kSameSurface * chosen)
      sum += in.inverse_z[i], ++count;
  return {sum / float(count), in.object[order[1]]};
}

// Columns [first, first + width of the picture / scale) of the keyframe.
void take_over(const DepthImage& picture, int scale, int first, Keyframe& keyframe) {
  const int columns = picture.camera.width / scale;
  const bool objects = !picture.object.empty();
  parallel_for(0, keyframe.camera.height, [&](int y) {
    for (int column = 0; column < columns; ++column) {
      const int x = first + column;
      if (scale == 1) {
        keyframe.color(x, y) = bytes_of(picture.color(column, y));
        keyframe.inverse_z(x, y) = inverse_of(picture.depth(column, y));
        keyframe.object(x, y) = objects ? picture.object(column, y) : kNoObject;
        continue;
      }
      Quarters quarters;
      std::uint32_t even = 0x00020002u, odd = 0x00020002u;  // sums of bytes 0 and 2, 1 and 3
      for (int i = 0; i < 4; ++i) {
        const int from_x = 2 * column + i % 2, from_y = 2 * y + i / 2;
        const std::uint32_t bytes = bytes_of(picture.color(from_x, from_y));
        even += bytes & 0x00ff00ffu, odd += bytes >> 8 & 0x00ff00ffu;
        quarters.inverse_z[i] = inverse_of(picture.depth(from_x, from_y));
        quarters.object[i] = objects ? picture.object(from_x, from_y) : kNoObject;
      }
      keyframe.color(x, y) = (even >> 2 & 0x00ff00ffu) | (odd >> 2 & 0x00ff00ffu) << 8;
      std::tie(keyframe.inverse_z(x, y), keyframe.object(x, y)) = of_four(quarters);
    }
  });
}

// Columns [from, to) of a camera, at `scale` times its size.
Camera band_of(const Camera& camera, int from, int to, int scale) {
  Camera band = camera;
  const ImageWindow& w = camera.window;
  const double per_column = (w.right - w.left) / camera.width;
  band.window.left = w.left + from * per_column;
  band.window.right = w.left + to * per_column;
  band.width = (to - from) * scale, band.height = camera.height * scale;
  return band;
}

}  // namespace

void KeyframeMaker::begin(const KeyframeRequest& request, Keyframe reuse) {
  RILIEVO_EXPECTS(request.samples == 1 || request.samples == 4 || request.samples == 16);
  objects_.assign(request.objects.begin(), request.objects.end());
  request_ = request;
  request_.objects = objects_;
  keyframe_ = std::move(reuse);
  resize(keyframe_, request.camera);
  keyframe_.coarse = request.coarse;
  next_ = 0;
}

Result<> KeyframeMaker::step(CaptureSource& source, int columns, const CaptureControl* control) {
  RILIEVO_EXPECTS(busy());
  const int width = keyframe_.camera.width;
  const int whole = (std::max(columns, 1) + kBand - 1) / kBand * kBand;
  const int from = next_, to = std::min(from + whole, width);
  const int scale = request_.samples == 16 ? 2 : 1;
  CaptureRequest request;
  request.camera = band_of(keyframe_.camera, from, to, scale);
  request.objects = request_.objects;
  request.samples = std::min(request_.samples, 4);
  request.with_sky = true;
  request.control = control;
  request.time = request_.time;
  Result<CapturedPicture> captured = source.capture(request);
  if (!captured) return captured.error();
  take_over(captured->picture, scale, from, keyframe_);
  // Of the segments that are complete now.
  const auto complete = [&](int column) {
    return column == width ? width : column / Keyframe::kColumns * Keyframe::kColumns;
  };
  find_ranges(keyframe_, complete(from), complete(to));
  next_ = to;
  return Done{};
}

Keyframe KeyframeMaker::take() {
  RILIEVO_EXPECTS(!busy() && !keyframe_.color.empty());
  return std::exchange(keyframe_, {});
}

Keyframe KeyframeMaker::give_up() {
  next_ = 1 << 30;
  return std::exchange(keyframe_, {});
}

Result<Keyframe> make_keyframe(CaptureSource& source, const KeyframeRequest& request,
                               const CaptureControl* control) {
  KeyframeMaker maker;
  maker.begin(request);
  if (Result<> done = maker.step(source, request.camera.width, control); !done) return done.error();
  return {maker.take()};
}

}  // namespace rilievo
