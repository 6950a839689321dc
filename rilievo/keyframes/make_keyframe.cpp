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
  return table(linear.r) | table(linear.g) << 8 | table(linear.b) << 16;
}

float inverse_of(float eye_z) { return eye_z < kNoDepth && eye_z > 0 ? 1 / eye_z : 0.0f; }

// Depths that differ by less are one surface's.
constexpr float kSameSurface = 0.03f;

bool same_surface(float inverse_z, float as) {
  return std::abs(inverse_z - as) <= kSameSurface * as;
}

// Where things are finer than texels, a quarter of one sample says little: its sides that show the
// same surface count an eighth each, about as much as a pixel's own width shows of them.
constexpr std::uint32_t kOwnPart = 4, kSidePart = 1;

// A quarter's colour, smoothed if asked for, and of quarter_code() how many sides show what. Beyond
// the picture is the same.
std::uint32_t with_sides(const KeyframeBand& band, bool smooth, int x, int y) {
  static constexpr std::uint32_t kPer[] = {16384, 13107, 10923, 9362, 8192};  // 65536 / (4 to 8)
  const std::uint32_t own = band.colors(x, y);
  const float w = band.inverse_z(x, y);
  // Two bytes at a time.
  std::uint32_t even = kOwnPart * (own & 0x00ff00ffu), odd = kOwnPart * (own >> 8 & 0xffu);
  std::uint32_t same = 0, nearer = 0, added = 0;
  const auto add = [&](bool within, int at_x, int at_y) {
    const float beside = within ? band.inverse_z(at_x, at_y) : w;
    if (!same_surface(beside, w)) {
      nearer += beside > w;
      return;
    }
    ++same;
    if (!within) return;
    const std::uint32_t color = band.colors(at_x, at_y);
    even += color & 0x00ff00ffu, odd += color >> 8 & 0xffu, ++added;
  };
  add(x > 0, x - 1, y);
  add(x + 1 < band.colors.width(), x + 1, y);
  add(y > 0, x, y - 1);
  add(y + 1 < band.colors.height(), x, y + 1);
  const std::uint32_t code = quarter_code(Quarter::own, same, nearer);
  if (!smooth) return own | code;
  const auto mean = [&](std::uint32_t sum) { return (sum * kPer[added] + 32768) >> 16; };
  return mean(even & 0xffffu) | mean(odd) << 8 | mean(even >> 16) << 16 | code;
}

// Texel (x, y) of the keyframe from its quarters, which are at (from_x, from_y) of the picture and
// beside. Of their depths the second nearest counts, because where two of four show what is in
// front, it has half of the texel.
void join_quarters(const DepthImage& picture, const KeyframeBand& band, bool smooth, int from_x,
                   int from_y, int x, int y, Keyframe& keyframe) {
  float inverse_z[4];
  for (int i = 0; i < 4; ++i) inverse_z[i] = band.inverse_z(from_x + i % 2, from_y + i / 2);
  const auto nearer = std::minmax(inverse_z[0], inverse_z[1]),
             others = std::minmax(inverse_z[2], inverse_z[3]);
  const float second =
      std::max(std::min(nearer.second, others.second), std::max(nearer.first, others.first));
  float sum = 0;
  int count = 0, chosen = 0;
  for (int i = 0; i < 4; ++i) {
    const bool own = same_surface(inverse_z[i], second);
    if (inverse_z[i] == second) chosen = i;
    if (own) sum += inverse_z[i], ++count;
    const Quarter shows = own                     ? Quarter::own
                          : inverse_z[i] > second ? Quarter::nearer
                                                  : Quarter::farther;
    keyframe.color(2 * x + i % 2, 2 * y + i / 2) =
        with_sides(band, smooth, from_x + i % 2, from_y + i / 2) | quarter_code(shows, 0, 0);
  }
  keyframe.inverse_z(x, y) = sum / float(count);
  keyframe.object(x, y) =
      picture.object.empty() ? kNoObject : picture.object(from_x + chosen % 2, from_y + chosen / 2);
}

// Columns [from, to) of the keyframe; the picture begins `before` columns before them.
void take_over(const DepthImage& picture, int from, int to, int before, bool smooth,
               KeyframeBand& band, Keyframe& keyframe) {
  const int width = picture.camera.width, height = picture.camera.height;
  if (band.colors.width() != width || band.colors.height() != height) {
    band.colors = Image<std::uint32_t>(width, height);
    band.inverse_z = Image<float>(width, height);
  }
  parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      band.colors(x, y) = bytes_of(picture.color(x, y));
      band.inverse_z(x, y) = inverse_of(picture.depth(x, y));
    }
  });
  parallel_for(0, keyframe.camera.height, [&](int y) {
    for (int x = from; x < to; ++x) {
      const int column = x - from + before;
      if (keyframe.quarters()) {
        join_quarters(picture, band, smooth, 2 * column, 2 * y, x, y, keyframe);
        continue;
      }
      keyframe.color(x, y) = band.colors(column, y) | kWholeTexel;
      keyframe.object(x, y) = picture.object.empty() ? kNoObject : picture.object(column, y);
      keyframe.inverse_z(x, y) = band.inverse_z(column, y);
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
  resize(keyframe_, request.camera,
         request.samples == 16 || (request.samples == 4 && !request.whole_texels));
  keyframe_.coarse = request.coarse;
  keyframe_.left_out.assign(request.left_out.begin(), request.left_out.end());
  next_ = 0;
}

Result<> KeyframeMaker::step(CaptureSource& source, int columns, const CaptureControl* control) {
  RILIEVO_EXPECTS(busy());
  const int width = keyframe_.camera.width;
  const int whole = (std::max(columns, 1) + kBand - 1) / kBand * kBand;
  const int from = next_, to = std::min(from + whole, width);
  const bool quarters = keyframe_.quarters();
  const bool smooth = quarters && request_.samples == 4;
  // With the sides of its quarters.
  const int before = quarters && from > 0 ? 1 : 0, behind = quarters && to < width ? 1 : 0;
  CaptureRequest request;
  request.camera = band_of(keyframe_.camera, from - before, to + behind, quarters ? 2 : 1);
  request.objects = request_.objects;
  request.samples = quarters ? request_.samples / 4 : request_.samples;
  request.with_sky = !request_.sky;
  request.control = control;
  request.time = request_.time;
  Result<CapturedPicture> captured = source.capture(request);
  if (!captured) return captured.error();
  if (request_.sky) add_sky(*request_.sky, captured->picture);
  take_over(captured->picture, from, to, before, smooth, band_, keyframe_);
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
