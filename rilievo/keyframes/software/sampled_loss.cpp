#include "rilievo/keyframes/software/sampled_loss.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/color.h"
#include "rilievo/core/expects.h"
#include "rilievo/keyframes/warp_keyframes.h"
#include "rilievo/render/shading/sky_rays.h"

namespace rilievo {
namespace {

constexpr int kSamples = 4;
// Half a byte's step squared in three channels: rounding is no loss.
constexpr double kRounding = 0.25;
// Pixels around the rectangle of the objects that count as its own; and one pixel in so many is of
// the whole frame, wherever that is.
constexpr double kAround = 4;
constexpr int kOfFrame = 8;

double square(const glm::dvec3& a) { return glm::dot(a, a); }

// Of `count` samples, of which the last component of `sums` counts those that show surfaces.
glm::dvec3 mean(const glm::ivec4& sums, int count, const glm::dvec3& sky) {
  return (glm::dvec3(sums) + double(count - sums.w) * sky) / double(count);
}

bool lies_in(const RasterRect& rect, const FramePixel& pixel) {
  return pixel.x >= rect.left && pixel.x < rect.right && pixel.y >= rect.top &&
         pixel.y < rect.bottom;
}

}  // namespace

SampledLoss::SampledLoss(const RayScene& rays) : sky_(rays.scene().sky), caster_(rays) {
  const Scene& scene = rays.scene();
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    bounds_.push_back(
        transformed(rays.poses()[i], scene.models[std::size_t(scene.objects[i].model)].bounds));
}

RasterRect SampledLoss::find_rect(const Camera& camera,
                                  std::span<const std::uint32_t> objects) const {
  const RasterRect all{0, 0, double(camera.width), double(camera.height)};
  Box bounds;
  for (const std::uint32_t object : objects) bounds.add(bounds_[object]);
  if (bounds.empty()) return all;
  const RasterRect seen =
      rect_of_box(camera, view_of_box(eye_from_world(camera), bounds, Projection::perspective));
  if (seen.empty()) return all;
  return {std::max(all.left, std::floor(seen.left - kAround)),
          std::max(all.top, std::floor(seen.top - kAround)),
          std::min(all.right, std::ceil(seen.right + kAround)),
          std::min(all.bottom, std::ceil(seen.bottom + kAround))};
}

// In rows, each once.
void SampledLoss::choose_pixels(const Camera& camera, const RasterRect& rect) {
  const auto next = [&](double from, double to) {
    random_ = random_ * 1664525u + 1013904223u;
    return std::uint16_t(std::uint32_t(from) + (random_ >> 8) % std::uint32_t(to - from));
  };
  pixels_.clear();
  for (int i = 0; i < kPixels; ++i) {
    const RasterRect of =
        i % kOfFrame == 0 ? RasterRect{0, 0, double(camera.width), double(camera.height)} : rect;
    const std::uint16_t x = next(of.left, of.right);
    pixels_.push_back({x, next(of.top, of.bottom)});
  }
  std::sort(pixels_.begin(), pixels_.end(), [](const FramePixel& a, const FramePixel& b) {
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  });
  pixels_.erase(std::unique(pixels_.begin(), pixels_.end(),
                            [](const FramePixel& a, const FramePixel& b) {
                              return a.x == b.x && a.y == b.y;
                            }),
                pixels_.end());
}

// The sums of the samples' bytes of each pixel.
void SampledLoss::cast(const Camera& camera, std::span<const FramePixel> pixels,
                       std::span<const std::uint32_t> objects, std::vector<glm::ivec4>& sums) {
  caster_.cast(camera, kSamples, pixels, objects);
  sums.assign(pixels.size(), glm::ivec4(0));
  const std::span<const float> depths = caster_.inverse_z();
  const std::span<const std::uint32_t> triangles = caster_.triangles();
  // What is shaded comes back in another order: a pixel is known by its place.
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    unsigned left = 0;
    for (int s = 0; s < kSamples; ++s)
      left |= unsigned(depths[i * kSamples + std::size_t(s)] > 0) << s;
    for (int s = 0; left != 0; ++s) {
      if (!(left >> s & 1)) continue;
      const std::uint32_t triangle = triangles[i * kSamples + std::size_t(s)];
      unsigned same = 0;
      for (int k = s; k < kSamples; ++k)
        same |=
            unsigned((left >> k & 1) != 0 && triangles[i * kSamples + std::size_t(k)] == triangle)
            << k;
      seen_.add(caster_.meshes(),
                {triangle, pixels[i].x, std::uint16_t(camera.height - 1 - pixels[i].y),
                 std::uint16_t(same)});
      left &= ~same;
    }
  }
  const auto before = [](const FramePixel& a, const FramePixel& b) {
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  };
  seen_.shade(caster_.view(camera, kSamples), [&](const SeenTriangles::Shaded& shaded) {
    std::uint32_t bytes[Surfaces::kMaxCount];
    premultiplied_bytes(shaded.surfaces, shaded.colors, bytes);
    for (std::size_t i = 0; i < shaded.pixels.size(); ++i) {
      const SeenTriangles::Pixel& of = shaded.pixels[i];
      const FramePixel at{of.x, std::uint16_t(camera.height - 1 - of.y)};
      const auto found = std::lower_bound(pixels.begin(), pixels.end(), at, before);
      int count = 0;
      for (int s = 0; s < kSamples; ++s) count += of.samples >> s & 1;
      const std::uint32_t c = bytes[i];
      sums[std::size_t(found - pixels.begin())] +=
          count * glm::ivec4(c & 255, c >> 8 & 255, c >> 16 & 255, 1);
    }
  });
}

void SampledLoss::add(const Camera& camera, std::span<const std::uint32_t> objects,
                      std::span<const std::uint32_t> shown, double remembered) {
  RILIEVO_EXPECTS_EQ(shown.size(), std::size_t(camera.width) * std::size_t(camera.height));
  const RasterRect rect = find_rect(camera, objects);
  choose_pixels(camera, rect);
  const auto in_rect = double(std::ranges::count_if(
      pixels_, [&](const FramePixel& pixel) { return lies_in(rect, pixel); }));
  const double beside = double(pixels_.size()) - in_rect;
  // What a pixel stands for, in means of the pixels that were chosen.
  const double share = (rect.right - rect.left) * (rect.bottom - rect.top) /
                       (double(camera.width) * camera.height),
               of_inner = share * double(pixels_.size()) / std::max(in_rect, 1.0),
               of_outer = (1 - share) * double(pixels_.size()) / std::max(beside, 1.0);
  cast(camera, pixels_, objects, direct_sums_);
  // The truth: four pixels of a frame of twice the size. Rows of it are in order, too.
  const Camera fine = supersampled(camera, 2);
  parts_.clear();
  for (std::size_t from = 0; from < pixels_.size();) {
    std::size_t to = from;
    while (to < pixels_.size() && pixels_[to].y == pixels_[from].y) ++to;
    for (int row = 0; row < 2; ++row)
      for (std::size_t i = from; i < to; ++i)
        for (int column = 0; column < 2; ++column)
          parts_.push_back(
              {std::uint16_t(2 * pixels_[i].x + column), std::uint16_t(2 * pixels_[i].y + row)});
    from = to;
  }
  cast(fine, parts_, objects, true_sums_);
  const SkyRays sky_rays(camera);
  const auto sky_bytes = [&](int x, int y) {
    const glm::vec3 color = sky_rays.radiance(sky_, x, camera.height - 1 - y);
    glm::dvec3 bytes;
    for (int c = 0; c < 3; ++c)
      bytes[c] = std::round(255 * srgb_from_linear(std::clamp(color[c], 0.0f, 1.0f)));
    return bytes;
  };
  // Where little of the view is surfaces, so many looks are not enough to know it.
  const double keeps =
      remembered * surfaces_ < kEnoughSurfaces ? std::max(remembered, kRemembered) : remembered;
  for (double* sum : {&shown_, &direct_, &counted_, &surfaces_}) *sum *= keeps;
  for (std::size_t from = 0, part = 0; from < pixels_.size();) {
    std::size_t to = from;
    while (to < pixels_.size() && pixels_[to].y == pixels_[from].y) ++to;
    const std::size_t in_row = to - from;
    for (std::size_t i = from; i < to; ++i) {
      const std::size_t first = part + 2 * (i - from), second = first + 2 * in_row;
      const glm::ivec4 all =
          true_sums_[first] + true_sums_[first + 1] + true_sums_[second] + true_sums_[second + 1];
      const glm::ivec4& few = direct_sums_[i];
      const glm::dvec3 sky = sky_bytes(pixels_[i].x, pixels_[i].y);
      const glm::dvec3 truth = mean(all, 4 * kSamples, sky);
      const double of_direct = square(mean(few, kSamples, sky) - truth);
      const std::uint32_t seen =
          shown[std::size_t(pixels_[i].y) * std::size_t(camera.width) + pixels_[i].x];
      const double weight = lies_in(rect, pixels_[i]) ? of_inner : of_outer;
      shown_ += weight *
                (seen == 0 || seen == kCoveredPixel || seen == kPlainSky
                     ? of_direct
                     : square(glm::dvec3(seen & 255, seen >> 8 & 255, seen >> 16 & 255) - truth));
      direct_ += weight * of_direct;
      counted_ += weight, surfaces_ += all.w > 0;
    }
    part += 4 * in_row;
    from = to;
  }
}

double SampledLoss::loss_db(double shown, double direct, double counted) {
  const double rounding = kRounding * counted + 1e-9;
  return 10 * std::log10((shown + rounding) / (std::max(direct, kUnseen * counted) + rounding));
}

}  // namespace rilievo
