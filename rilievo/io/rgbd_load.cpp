#include <algorithm>
#include <cmath>
#include <cstdint>

#include "rilievo/core/file.h"
#include "rilievo/io/picture_decode.h"
#include "rilievo/io/rgbd.h"

namespace rilievo {
namespace {

// Decodes one file; a fault becomes an error that names it.
template <class Decode>
auto decoded(const std::filesystem::path& path, MemoryBudget& budget, Decode decode)
    -> Result<decltype(decode(Bytes{}, std::declval<MemoryBudget&>()))> {
  const Result<std::string> bytes = read_file(path, budget.left());
  if (!bytes) return bytes.error();
  try {
    budget.earn(bytes->size());
    return decode(bytes_of(*bytes), budget);
  } catch (const LoadError& fault) {
    return Error{path.string(), fault.reason};
  }
}

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

Camera camera_of(const RgbdFrame& frame, int width, int height) {
  const RgbdIntrinsics& lens = frame.intrinsics;
  // NaN where neither is known: then that of the other axis.
  const auto focal = [](double length, double angle, int texels) {
    return std::isnan(length) && angle > 0 ? 0.5 * texels / std::tan(0.5 * angle) : length;
  };
  const double own_x = focal(lens.fl_x, lens.angle_x, width);
  const double own_y = focal(lens.fl_y, lens.angle_y, height);
  const double fl_x = std::isnan(own_x) ? own_y : own_x;
  const double fl_y = std::isnan(own_y) ? own_x : own_y;
  const double cx = std::isnan(lens.cx) ? 0.5 * width : lens.cx;
  const double cy = std::isnan(lens.cy) ? 0.5 * height : lens.cy;
  Camera camera;
  camera.world_from_eye = frame.world_from_eye;
  camera.window = {-cx / fl_x, (width - cx) / fl_x, -(height - cy) / fl_y, cy / fl_y};
  camera.width = width;
  camera.height = height;
  return camera;
}

// Which texels of a mask are masked out: as alpha of 0 or 255, into `color`.
Result<> apply_mask(const RgbdFrame& frame, MemoryBudget& budget, Rgba8Image& color) {
  if (frame.mask.empty()) return Done{};
  const Result<Rgba8Image> mask = decoded(frame.mask, budget, decode_picture);
  if (!mask) return mask.error();
  if (mask->width() != color.width() || mask->height() != color.height())
    return Error{frame.mask.string(), "is " + size_text(mask->width(), mask->height()) +
                                          " texels, but its colours are " +
                                          size_text(color.width(), color.height())};
  for (std::size_t i = 0; i < color.texels().size(); ++i) {
    const glm::u8vec4& m = mask->texels()[i];
    const bool dark = m.a < 128 || std::max({m.r, m.g, m.b}) < 128;
    if (dark == frame.mask_is_dark) color.texels()[i].a = 0;
  }
  return Done{};
}

// The picture of a pinhole from that of a lens. Texels that no texel of the lens shows, or that
// are masked out there, show nothing.
void undistort(const LensDistortion& lens, const Camera& camera, ColorImage& color,
               Image<std::uint16_t>& units) {
  const int w = camera.width, h = camera.height;
  const ImageWindow& window = camera.window;
  const glm::dvec2 tangent((window.right - window.left) / w, (window.top - window.bottom) / h);
  const double farthest =
      std::hypot(std::max(-window.left, window.right), std::max(-window.bottom, window.top));
  const double limit = largest_radius(lens, farthest);
  ColorImage straight(w, h, glm::vec4(0.0f));
  Image<std::uint16_t> straight_units(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const glm::dvec2 point(window.left + (x + 0.5) * tangent.x,
                             (y + 0.5) * tangent.y - window.top);
      if (glm::length(point) > limit) continue;
      const glm::dvec2 bent = distorted(lens, point);
      const glm::dvec2 at((bent.x - window.left) / tangent.x, (bent.y + window.top) / tangent.y);
      if (!(at.x >= 0 && at.y >= 0 && at.x < w && at.y < h)) continue;
      // Colours between the four texels around; beyond the edge, its own.
      const glm::dvec2 base = glm::floor(at - 0.5), part = at - 0.5 - base;
      glm::vec4 sum(0.0f);
      for (int k = 0; k < 4; ++k) {
        const int u = std::clamp(int(base.x) + k % 2, 0, w - 1);
        const int v = std::clamp(int(base.y) + k / 2, 0, h - 1);
        const double weight = (k % 2 ? part.x : 1 - part.x) * (k / 2 ? part.y : 1 - part.y);
        const glm::vec4 texel = color(u, v);
        if (texel.a >= 0.5f) sum += float(weight) * glm::vec4(glm::vec3(texel), 1.0f);
      }
      if (sum.a < 0.5f) continue;
      straight(x, y) = glm::vec4(glm::vec3(sum) / sum.a, 1.0f);
      // Never a mean of depths: between a surface and what lies behind it there is nothing.
      straight_units(x, y) = units(int(at.x), int(at.y));
    }
  color = std::move(straight);
  units = std::move(straight_units);
}

}  // namespace

Result<DepthImage> load_rgbd_frame(const RgbdFrame& frame, std::uint64_t max_bytes) {
  MemoryBudget budget(max_bytes);
  // What is decoded becomes floats: four of colour and one of depth.
  Result<Rgba8Image> color = decoded(frame.color, budget, [](Bytes encoded, MemoryBudget& left) {
    Rgba8Image picture = decode_picture(encoded, left);
    left.take_pixels(picture.texels().size(), sizeof(glm::vec4) + sizeof(float));
    return picture;
  });
  if (!color) return color.error();
  Result<Image<std::uint16_t>> units = decoded(frame.depth, budget, decode_grey16);
  if (!units) return units.error();
  const int width = color->width(), height = color->height();
  const RgbdIntrinsics& lens = frame.intrinsics;
  if ((lens.width && lens.width != width) || (lens.height && lens.height != height))
    return Error{frame.color.string(), "is " + size_text(width, height) +
                                           " texels, but the lens is given for " +
                                           size_text(lens.width, lens.height)};
  if (units->width() != width || units->height() != height)
    return Error{frame.depth.string(), "is " + size_text(units->width(), units->height()) +
                                           " texels, but its colours are " +
                                           size_text(width, height)};

  if (Result<> masked = apply_mask(frame, budget, *color); !masked) return masked.error();

  DepthImage picture;
  picture.name = frame.name;
  picture.camera = camera_of(frame, width, height);
  picture.color = linear_from_srgb8(*color);
  if (lens.distortion.model != LensDistortion::Model::none)
    undistort(lens.distortion, picture.camera, picture.color, *units);
  picture.depth = Image<float>(width, height, kNoDepth);
  float nearest = kNoDepth, farthest = 0;
  for (std::size_t i = 0; i < picture.depth.texels().size(); ++i) {
    const std::uint16_t unit = units->texels()[i];
    glm::vec4& texel = picture.color.texels()[i];
    texel = texel.a < 0.5f ? glm::vec4(0.0f) : glm::vec4(glm::vec3(texel), 1.0f);
    if (unit == 0 || unit == 65535 || texel.a == 0) continue;
    const float eye_z = float(unit * frame.metres_per_unit);
    picture.depth.texels()[i] = eye_z;
    nearest = std::min(nearest, eye_z);
    farthest = std::max(farthest, eye_z);
  }
  if (farthest == 0) return Error{frame.depth.string(), "holds no depth"};
  // Surfaces between samples may reach a little beyond them.
  picture.camera.z_near = 0.5 * nearest;
  picture.camera.z_far = 2.0 * farthest;
  if (Result<> valid = validate(picture); !valid)
    return Error{frame.color.string(), valid.error().message()};
  return picture;
}

}  // namespace rilievo
