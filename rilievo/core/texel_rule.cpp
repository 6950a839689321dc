#include "rilievo/core/texel_rule.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// Surfaces closer than this to the plane are one with it, in widths of a texel: half of the step up
// to which warps link two texels in any case (LinkOptions::gentle) and draw what lies between them.
// On ferns and palms less cost 0.6 dB, as leaves beside each other lost their antialiasing.
constexpr float kSlack = 3.0f;
// Along a thin thing that leads away from the eye depth changes by up to this, in widths of a texel
// from one texel to the next.
constexpr float kThinStep = 4.0f;
// Samples on a steep surface leave no wider gap than this share of a step.
constexpr float kOnWay = 0.6f;
constexpr std::size_t kMaxSamples = 8;

// A neighbour's step in nearness; does it belong to the same object?
struct Step {
  bool known = false;
  float value = 0;
};

// The smaller of two steps in a row; none if they have opposite signs.
float smaller(float before, float after) {
  if (before * after <= 0) return 0;
  return std::abs(before) < std::abs(after) ? before : after;
}

// What is thin, and which texels show it.
class ThinSurfaces {
 public:
  explicit ThinSurfaces(const TexelSamples& texels) : t_(texels) {}

  // The samples of a texel that show a surface in front of the centre's.
  struct Front {
    float nearness = kNoNearness;
    std::uint32_t object = 0;
    glm::ivec2 texel{0};
    glm::vec2 place{0.0f};  // of the nearest sample, from the centre of the first texel
    float room = 0;         // of nearness: as far it may be from one texel to the next
  };
  [[nodiscard]] Front front_of(int x, int y, std::uint8_t own) const {
    Front front;
    const std::size_t first = t_.first(x, y);
    const float center = t_.center(x, y);
    for (int s = 0; s < t_.samples(); ++s) {
      const float z = t_.sample[first + std::size_t(s)];
      if ((own >> s & 1) || !(z > center) || !(z > front.nearness)) continue;
      front = {z,
               t_.sample_object[first + std::size_t(s)],
               {x, y},
               glm::vec2(x, y) + t_.places[std::size_t(s)],
               0};
    }
    if (front.nearness == kNoNearness) return front;
    front.room = t_.nearness.noise + kThinStep * t_.nearness.texel(front.nearness);
    // It may be the end of a steep surface, such as the ground before the horizon.
    float steepest = 0;
    for (int k = 0; k < 9; ++k) {
      const glm::ivec2 at(x + k % 3 - 1, y + k / 3 - 1);
      if (outside(at) || t_.center_object(at.x, at.y) != front.object ||
          t_.center(at.x, at.y) == kNoNearness)
        continue;
      const TexelPlane plane = plane_at(at);
      if (plane.shows(front.place - glm::vec2(at), front.nearness, front.object))
        steepest = std::max(steepest, std::abs(plane.per_x) + std::abs(plane.per_y));
      else if (leads_to(front, at))
        steepest = std::max(steepest, std::abs(t_.center(at.x, at.y) - front.nearness));
    }
    front.room += 2 * steepest;
    return front;
  }
  // Which samples of a texel show that surface?
  [[nodiscard]] std::uint8_t samples_of(const Front& front, int x, int y) const {
    if (outside({x, y})) return 0;
    std::uint8_t mask = 0;
    const std::size_t first = t_.first(x, y);
    for (int s = 0; s < t_.samples(); ++s)
      if (near(front, t_.sample[first + std::size_t(s)], t_.sample_object[first + std::size_t(s)]))
        mask = std::uint8_t(mask | 1u << s);
    return mask;
  }
  // Is it this texel that shows the surface?
  [[nodiscard]] bool shows(const Front& front, int x, int y, int count) const {
    return along(front, {x, y}, count, {1, 0}) || along(front, {x, y}, count, {0, 1});
  }

 private:
  [[nodiscard]] bool outside(const glm::ivec2& at) const {
    return at.x < 0 || at.y < 0 || at.x >= t_.center.width() || at.y >= t_.center.height();
  }
  [[nodiscard]] bool near(const Front& front, float nearness, std::uint32_t object) const {
    return object == front.object && std::abs(nearness - front.nearness) <= front.room;
  }
  [[nodiscard]] TexelPlane plane_at(const glm::ivec2& at) const {
    return texel_plane(t_.nearness, t_.center, t_.center_object, at.x, at.y);
  }
  // Does the centre of a texel show the surface? Nobody knows beyond the border.
  [[nodiscard]] bool at_center(const Front& front, const glm::ivec2& at) const {
    if (outside(at)) return true;
    if (t_.center_object(at.x, at.y) != front.object || t_.center(at.x, at.y) == kNoNearness)
      return false;
    return near(front, t_.center(at.x, at.y), front.object) ||
           plane_at(at).shows(front.place - glm::vec2(at), front.nearness, front.object) ||
           leads_to(front, at);
  }
  // Does a steep surface lead from the front to the centre of a neighbour that shows the same
  // object? Then there are samples on the way; between a thing and the wall behind it there are
  // none.
  [[nodiscard]] bool leads_to(const Front& front, const glm::ivec2& at) const {
    const float to = t_.center(at.x, at.y), step = std::abs(to - front.nearness);
    std::array<float, 2 + 2 * kMaxSamples> on_way{to, front.nearness};
    auto end_of_way = on_way.begin() + 2;
    for (const glm::ivec2& p : {front.texel, at})
      for (std::size_t i = t_.first(p.x, p.y), end = i + t_.places.size(); i < end; ++i)
        if (t_.sample_object[i] == front.object &&
            (t_.sample[i] - to) * (t_.sample[i] - front.nearness) < 0)
          *end_of_way++ = t_.sample[i];
    std::sort(on_way.begin(), end_of_way);
    float widest = 0;
    for (auto next = on_way.begin() + 1; next != end_of_way; ++next)
      widest = std::max(widest, *next - *(next - 1));
    return widest <= kOnWay * step;
  }
  // Across the surface in this direction: does it end on both sides within two texels, and does
  // this texel have most of it?
  [[nodiscard]] bool along(const Front& front, const glm::ivec2& at, int count,
                           const glm::ivec2& step) const {
    int of_other = 0;
    for (const int side : {-1, 1}) {
      const glm::ivec2 beside = at + side * step, beyond = beside + side * step;
      if (at_center(front, beside)) return false;
      const int others = std::popcount(samples_of(front, beside.x, beside.y));
      if (others == 0) continue;
      if (of_other > 0 || at_center(front, beyond) || samples_of(front, beyond.x, beyond.y) != 0)
        return false;
      if (others > count || (others == count && side < 0)) return false;
      of_other = others;
    }
    return is_wide_enough(front, at, count, step);
  }
  // What is half a texel wide has half of the samples of one texel in each row that it crosses, in
  // the mean over a few rows: places of samples lie nearer to each other in one direction than in
  // another. A third is half, more or less. Near an end the texel itself must have
  // half, as otherwise tips would be drawn out.
  [[nodiscard]] bool is_wide_enough(const Front& front, const glm::ivec2& at, int count,
                                    const glm::ivec2& step) const {
    const glm::ivec2 onwards(step.y, step.x);
    const auto in_row = [&](int along) {
      int found = 0;
      for (int across = -kRows - 1; across <= kRows + 1; ++across) {
        const glm::ivec2 p = at + along * onwards + across * step;
        if (outside(p)) continue;
        found += std::popcount(samples_of(front, p.x, p.y)) + int(at_center(front, p));
      }
      return found;
    };
    int found = in_row(0), rows = 1, ends = 0;
    for (const int way : {-1, 1})
      for (int along = way; std::abs(along) <= kRows; along += way, ++rows) {
        const int of_row = in_row(along);
        found += of_row;
        if (of_row > 0) continue;
        ++ends;
        break;
      }
    // Of a short piece all of it shows, or nothing.
    if (rows <= kRows || (ends > 0 && 2 * count < t_.samples())) return false;
    return 3 * found >= rows * (t_.samples() + 1);
  }
  static constexpr int kRows = 2;  // to either side

  const TexelSamples& t_;
};

}  // namespace

Nearness::Nearness(const Camera& camera) : projection(camera.projection) {
  at_near = of_eye_z(camera.z_near), at_far = of_eye_z(camera.z_far);
  const ImageWindow& w = camera.window;
  texel_width =
      float(std::max((w.right - w.left) / camera.width, (w.top - w.bottom) / camera.height));
  // A few steps of a float just below 1.
  noise = float(0x1p-21 * std::abs(at_near - at_far));
}

float Nearness::of_eye_z(double eye_z) const {
  if (eye_z == double(kNoDepth)) return kNoNearness;
  switch (projection) {
    case Projection::perspective:
      return float(1 / eye_z);
    case Projection::back_perspective:
      return float(-1 / eye_z);
    default:
      return float(-eye_z);
  }
}

double Nearness::eye_z(float nearness) const {
  switch (projection) {
    case Projection::perspective:
      return 1 / double(nearness);
    case Projection::back_perspective:
      return -1 / double(nearness);
    default:
      return -double(nearness);
  }
}

TexelSamples::TexelSamples(const Camera& camera, std::span<const glm::vec2> places)
    : nearness(camera),
      places(places.begin(), places.end()),
      center(camera.width, camera.height, kNoNearness),
      center_object(camera.width, camera.height, kNoObject) {
  RILIEVO_EXPECTS(!places.empty() && places.size() <= kMaxSamples);
  sample.assign(center.texels().size() * places.size(), kNoNearness);
  sample_object.assign(sample.size(), kNoObject);
}

TexelPlane texel_plane(const Nearness& nearness, const Image<float>& center,
                       const Image<std::uint32_t>& objects, int x, int y) {
  TexelPlane plane;
  plane.nearness = center(x, y);
  plane.object = objects.empty() ? kNoObject : objects(x, y);
  const auto shows = [&](const glm::ivec2& at) {
    return at.x >= 0 && at.y >= 0 && at.x < center.width() && at.y < center.height() &&
           center(at.x, at.y) != kNoNearness &&
           (objects.empty() || objects(at.x, at.y) == plane.object);
  };
  const auto slope = [&](const glm::ivec2& step) {
    const glm::ivec2 at(x, y);
    const auto to = [&](int side) -> Step {
      const glm::ivec2 beside = at + side * step;
      if (!shows(beside)) return {};
      return {true, float(side) * (center(beside.x, beside.y) - plane.nearness)};
    };
    const Step before = to(-1), after = to(1);
    if (before.known && after.known) return smaller(before.value, after.value);
    if (!before.known && !after.known) return 0.0f;
    // Of one step alone nobody knows whether it is a plane's, unless the next one is as large.
    const int side = before.known ? -1 : 1;
    const float one = before.known ? before.value : after.value;
    const glm::ivec2 beside = at + side * step, beyond = beside + side * step;
    if (!shows(beyond)) return one;
    return smaller(one, float(side) * (center(beyond.x, beyond.y) - center(beside.x, beside.y)));
  };
  plane.per_x = slope({1, 0});
  plane.per_y = slope({0, 1});
  plane.room = nearness.noise + kSlack * nearness.texel(plane.nearness);
  return plane;
}

ShownSamples choose_samples(const TexelSamples& t) {
  const int width = t.center.width(), height = t.center.height(), samples = t.samples();
  ShownSamples shown;
  shown.mask = Image<std::uint8_t>(width, height);
  const ThinSurfaces thin(t);
  std::vector<std::vector<ThinTexel>> rows{std::size_t(height)};
  parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t first = t.first(x, y);
      std::uint8_t mask = 0;
      bool others = false;
      if (t.center(x, y) == kNoNearness) {
        for (int s = 0; s < samples; ++s) others |= t.sample[first + std::size_t(s)] != kNoNearness;
      } else {
        const TexelPlane plane = texel_plane(t.nearness, t.center, t.center_object, x, y);
        std::uint8_t behind = 0;
        for (int s = 0; s < samples; ++s) {
          const std::size_t i = first + std::size_t(s);
          const glm::vec2& place = t.places[std::size_t(s)];
          if (plane.shows(place, t.sample[i], t.sample_object[i]))
            mask = std::uint8_t(mask | 1u << s);
          else if (plane.hides(place, t.sample[i]))
            behind = std::uint8_t(behind | 1u << s);
          else
            others |= t.sample[i] != kNoNearness;
        }
        if (mask != 0) mask = std::uint8_t(mask | behind);
      }
      if (others) {
        const ThinSurfaces::Front front = thin.front_of(x, y, mask);
        if (front.nearness != kNoNearness) {
          const std::uint8_t of_front = thin.samples_of(front, x, y);
          if (thin.shows(front, x, y, std::popcount(of_front))) {
            // It hides in part what is behind.
            mask = of_front;
            for (int s = 0; s < samples; ++s) {
              const float z = t.sample[first + std::size_t(s)];
              if (z != kNoNearness && z < front.nearness - front.room)
                mask = std::uint8_t(mask | 1u << s);
            }
            rows[std::size_t(y)].push_back({x, y, front.nearness, front.object});
          }
        }
      }
      shown.mask(x, y) = mask;
    }
  });
  for (const std::vector<ThinTexel>& row : rows)
    shown.thin.insert(shown.thin.end(), row.begin(), row.end());
  return shown;
}

}  // namespace rilievo
