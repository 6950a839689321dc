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
// Pixels of which so many as are asked for are taken.
constexpr int kCandidates = 4 * SampledLoss::kPixels;
// How likely pixels are to be off, in steps of a byte: beside their contrast; and where direct
// drawing fills a hole.
constexpr double kLeastLikely = 8, kOfDrawn = 32;
// Beside that, in means of all candidates: what is missing, or wrong all over, has no contrast.
constexpr double kOfAny = 0.3;

double square(const glm::dvec3& a) { return glm::dot(a, a); }

// Of `count` samples, of which the last component of `sums` counts those that show surfaces.
glm::dvec3 mean(const glm::ivec4& sums, int count, const glm::dvec3& sky) {
  return (glm::dvec3(sums) + double(count - sums.w) * sky) / double(count);
}

// In rows.
bool before(const FramePixel& a, const FramePixel& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; }

// How much a pixel is likely to be off, as far as its neighbours tell: frames and direct drawing
// differ from the truth at edges.
double likely_error(std::span<const std::uint32_t> shown, const Camera& camera,
                    const FramePixel& pixel) {
  const auto at = [&](int x, int y) {
    x = std::clamp(x, 0, camera.width - 1), y = std::clamp(y, 0, camera.height - 1);
    return shown[std::size_t(y) * std::size_t(camera.width) + std::size_t(x)];
  };
  const auto drawn = [](std::uint32_t c) { return c == 0 || c == kCoveredPixel; };
  const std::uint32_t c = at(pixel.x, pixel.y);
  if (drawn(c)) return kOfDrawn;
  if (c == kPlainSky) return kLeastLikely;
  int most = 0;
  for (const glm::ivec2& to : {glm::ivec2(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
    const std::uint32_t d = at(pixel.x + to.x, pixel.y + to.y);
    if (d == kPlainSky) continue;
    if (drawn(d))
      most = std::max(most, int(kOfDrawn));
    else
      for (const int shift : {0, 8, 16})
        most = std::max(most, std::abs(int(c >> shift & 255) - int(d >> shift & 255)));
  }
  return kLeastLikely + most;
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
  candidates_.reserve(kCandidates), chosen_.reserve(kPixels);
  pixels_.reserve(kPixels), weights_.reserve(kPixels), parts_.reserve(4 * kPixels);
  direct_sums_.reserve(kPixels), true_sums_.reserve(4 * kPixels);
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

// Of candidates, which are as likely as their area, those are taken that are likely to be off, and
// stand for less the likelier they are. In rows, each once.
void SampledLoss::choose_pixels(const Camera& camera, const RasterRect& rect,
                                std::span<const std::uint32_t> shown) {
  const auto next = [&] { return (random_ = random_ * 1664525u + 1013904223u) >> 8; };
  const auto within = [&](double from, double to) {
    return std::uint16_t(from + (std::uint64_t(next()) * std::uint64_t(to - from) >> 24));
  };
  candidates_.clear();
  int in_rect = 0;
  for (int i = 0; i < kCandidates; ++i) {
    const RasterRect of =
        i % kOfFrame == 0 ? RasterRect{0, 0, double(camera.width), double(camera.height)} : rect;
    const std::uint16_t x = within(of.left, of.right);
    candidates_.push_back({{x, within(of.top, of.bottom)}, 0, 0});
    in_rect += lies_in(rect, candidates_.back().pixel);
  }
  // What a candidate stands for, in means of all.
  const double share = (rect.right - rect.left) * (rect.bottom - rect.top) /
                       (double(camera.width) * camera.height),
               of_inner = share * kCandidates / std::max(in_rect, 1),
               of_outer = (1 - share) * kCandidates / std::max(kCandidates - in_rect, 1);
  double all = 0;
  for (Chosen& one : candidates_) {
    one.weight = lies_in(rect, one.pixel) ? of_inner : of_outer;
    one.likely = likely_error(shown, camera, one.pixel);
    all += one.likely;
  }
  const double any = kOfAny * all / kCandidates;
  for (Chosen& one : candidates_) one.likely += any;
  all *= 1 + kOfAny;
  const double step = all / kPixels;
  double at = step * (next() / 16777216.0);
  chosen_.clear();
  for (Chosen& one : candidates_) {
    int times = 0;
    for (at -= one.likely; at < 0; at += step) ++times;
    if (times == 0) continue;
    one.weight *= times * all / (one.likely * kCandidates);
    chosen_.push_back(one);
  }
  std::sort(chosen_.begin(), chosen_.end(),
            [](const Chosen& a, const Chosen& b) { return before(a.pixel, b.pixel); });
  pixels_.clear(), weights_.clear();
  for (const Chosen& one : chosen_) {
    const bool again = !pixels_.empty() && !before(pixels_.back(), one.pixel);
    if (!again) pixels_.push_back(one.pixel), weights_.push_back(0);
    weights_.back() += one.weight;
  }
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
                      std::span<const std::uint32_t> shown, int looks, double remembered) {
  RILIEVO_EXPECTS_EQ(shown.size(), std::size_t(camera.width) * std::size_t(camera.height));
  RILIEVO_EXPECTS(looks > 0);
  keep(remembered, looks);
  const RasterRect rect = find_rect(camera, objects);
  for (int i = 0; i < looks; ++i) look(camera, objects, rect, shown);
}

// Of other frames; and of one at which there were many more looks no more than that would be of
// many such frames. But where little of the view is surfaces as many as are needed to know it.
void SampledLoss::keep(double remembered, int looks) {
  if (remembered == 1 || surfaces_ == 0) return;
  const double as_such = looks * kPixels * remembered / (1 - remembered) / counted_,
               needed = (kEnoughSurfaces + 1) / surfaces_;
  const double keeps = std::min(1.0, std::max(std::min(remembered, as_such), needed));
  for (double* sum : {&shown_, &direct_, &counted_, &surfaces_}) *sum *= keeps;
}

void SampledLoss::look(const Camera& camera, std::span<const std::uint32_t> objects,
                       const RasterRect& rect, std::span<const std::uint32_t> shown) {
  choose_pixels(camera, rect, shown);
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
      const double weight = weights_[i];
      shown_ += weight *
                (seen == 0 || seen == kCoveredPixel || seen == kPlainSky
                     ? of_direct
                     : square(glm::dvec3(seen & 255, seen >> 8 & 255, seen >> 16 & 255) - truth));
      direct_ += weight * of_direct;
      surfaces_ += all.w > 0;
    }
    part += 4 * in_row;
    from = to;
  }
  counted_ += kPixels;
}

double SampledLoss::loss_db(double shown, double direct, double counted) {
  const double rounding = kRounding * counted + 1e-9;
  return 10 * std::log10((shown + rounding) / (std::max(direct, kUnseen * counted) + rounding));
}

}  // namespace rilievo
