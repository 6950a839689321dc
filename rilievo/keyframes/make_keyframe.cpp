#include "rilievo/keyframes/make_keyframe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "rilievo/core/color.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/shading/sky_rays.h"

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

// A texel of a keyframe.
struct KeyframeTexel {
  std::uint32_t color, object;
  float inverse_z;
};

// Of four: the second nearest, because where two of four show what is in front, it has half of the
// texel.
KeyframeTexel of_four(const KeyframeTexel (&in)[4]) {
  int order[4] = {0, 1, 2, 3};
  std::stable_sort(order, order + 4,
                   [&](int a, int b) { return in[a].inverse_z > in[b].inverse_z; });
  const KeyframeTexel& chosen = in[order[1]];
  float sum = 0;
  std::uint32_t count = 0, channels[3] = {};
  for (const KeyframeTexel& one : in) {
    if (!(std::abs(one.inverse_z - chosen.inverse_z) <= kSameSurface * chosen.inverse_z)) continue;
    sum += one.inverse_z, ++count;
    for (int c = 0; c < 3; ++c) channels[c] += one.color >> (8 * c) & 255;
  }
  std::uint32_t color = 0xff000000u;
  for (int c = 0; c < 3; ++c) color |= (channels[c] + count / 2) / count << (8 * c);
  return {color, chosen.object, sum / float(count)};
}

// Columns [first, first + width of the picture / scale) of the keyframe.
void take_over(const DepthImage& picture, int scale, int first, Keyframe& keyframe) {
  const int columns = picture.camera.width / scale;
  const bool objects = !picture.object.empty();
  parallel_for(0, keyframe.camera.height, [&](int y) {
    for (int column = 0; column < columns; ++column) {
      const auto texel = [&](int i) {
        const int from_x = column * scale + i % 2, from_y = y * scale + i / 2;
        return KeyframeTexel{bytes_of(picture.color(from_x, from_y)),
                             objects ? picture.object(from_x, from_y) : kNoObject,
                             inverse_of(picture.depth(from_x, from_y))};
      };
      const KeyframeTexel made =
          scale == 1 ? texel(0) : of_four({texel(0), texel(1), texel(2), texel(3)});
      const int x = first + column;
      keyframe.color(x, y) = made.color;
      keyframe.object(x, y) = made.object;
      keyframe.inverse_z(x, y) = made.inverse_z;
    }
  });
}

// The sky behind texels that are covered in part, or not at all.
void add_sky(const Sky& sky, DepthImage& picture) {
  const SkyRays rays(picture.camera);
  parallel_for(0, picture.camera.height, [&](int y) {
    for (int x = 0; x < picture.camera.width; ++x) {
      glm::vec4& color = picture.color(x, y);
      if (picture.covered(x, y)) {
        // A texel shows one surface: all of it, whatever else its samples saw.
        if (color.a > 0) color = glm::vec4(glm::vec3(color) / color.a, 1);
      } else {
        color = glm::vec4(rays.radiance(sky, x, picture.camera.height - 1 - y), 1);
      }
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
  request.with_sky = !request_.sky;
  request.control = control;
  request.time = request_.time;
  Result<CapturedPicture> captured = source.capture(request);
  if (!captured) return captured.error();
  if (request_.sky) add_sky(*request_.sky, captured->picture);
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
