// Few texels have something in front on both sides close by, along any line: pinhole_candidates()
// finds these many at a time. They are asked one by one.
#include "rilievo/layered_relief/fill_pinholes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "rilievo/core/depth.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_relief/pinhole_candidates.h"

namespace rilievo {
namespace {

constexpr int kPinholeRows = 32;

// Finds pinholes in a picture's Deltas.
class PinholeFinder {
 public:
  PinholeFinder(const PictureGeometry& geometry, double spacing, const std::uint16_t* delta)
      : camera_(geometry.capture),
        delta_(delta),
        step_(pinhole_step(geometry)),
        spacing_at_1_(spacing * geometry.plane_z),
        widest_(int(std::min(spacing_at(camera_.z_near), double(kPinholeReach)))) {}

  // Appends those of row `y`.
  void find(int y, PinholeScratch::Strip& strip) const;

 private:
  // Both ends of the gap along a line, and its length.
  struct Gap {
    std::size_t near = 0, far = 0;  // the nearer and the farther end
    int texels = 0;
  };
  [[nodiscard]] std::optional<Gap> gap(int x, int y, int right, int down) const;
  [[nodiscard]] std::optional<std::size_t> end_of_pinhole(int x, int y) const;
  // How many texels are neighbouring samples apart there?
  [[nodiscard]] double spacing(std::uint16_t delta) const {
    return spacing_at(eye_z_from(DepthKind::window_z, decode_delta(delta, 16), camera_, {}));
  }
  [[nodiscard]] double spacing_at(double z) const {
    return std::max(1.0, std::round(spacing_at_1_ / z));
  }

  const Camera& camera_;
  const std::uint16_t* delta_;
  int step_;
  double spacing_at_1_;  // at eye_z = 1
  int widest_;           // no gap is closed that is wider
};

std::optional<PinholeFinder::Gap> PinholeFinder::gap(int x, int y, int right, int down) const {
  // Steps to the picture's border.
  const int above = y, below = camera_.height - 1 - y;
  const auto room = [&](int way) {
    const int across = way * right > 0 ? camera_.width - 1 - x : x;
    const int along = way * down > 0 ? below : above;
    return std::min({kPinholeReach, right ? across : kPinholeReach, down ? along : kPinholeReach});
  };
  struct End {
    std::ptrdiff_t stride;
    int room, steps;
    const std::uint16_t* at;
  };
  const std::uint16_t* const texel =
      delta_ + std::size_t(y) * std::size_t(camera_.width) + std::size_t(x);
  const std::ptrdiff_t stride = std::ptrdiff_t(down) * camera_.width + right;
  const auto advance = [&](End& end) {
    const int in_front = int(*end.at) - step_;
    while (++end.steps <= end.room) {
      end.at += end.stride;
      if (int(*end.at) < in_front) return true;
    }
    return false;
  };
  End near{-stride, room(-1), 0, texel}, far{stride, room(1), 0, texel};
  if (!advance(near) || !advance(far)) return std::nullopt;
  for (;;) {
    if (*near.at > *far.at) std::swap(near, far);
    const int texels = near.steps + far.steps - 1;
    if (texels > kPinholeReach) return std::nullopt;
    if (int(*far.at) - int(*near.at) <= kPinholeEnds * step_)
      return Gap{std::size_t(near.at - delta_), std::size_t(far.at - delta_), texels};
    // The farther one shows what is seen through the gap.
    if (!advance(far)) return std::nullopt;
  }
}

std::optional<std::size_t> PinholeFinder::end_of_pinhole(int x, int y) const {
  constexpr std::array<std::array<int, 2>, 4> kLines{{{0, 1}, {1, 0}, {1, 1}, {1, -1}}};
  std::optional<Gap> shortest;
  for (const auto& [right, down] : kLines) {
    const std::optional<Gap> here = gap(x, y, right, down);
    if (!here) return std::nullopt;
    if (!shortest || here->texels < shortest->texels) shortest = here;
  }
  if (shortest->texels > spacing(delta_[shortest->near])) return std::nullopt;
  return shortest->far;
}

void PinholeFinder::find(int y, PinholeScratch::Strip& strip) const {
  const auto width = std::size_t(camera_.width);
  strip.candidates.resize(width);
  const std::size_t count =
      pinhole_candidates(delta_, camera_.width, camera_.height, y, step_, kPinholeEnds * step_,
                         widest_, strip.candidates.data());
  for (std::size_t i = 0; i < count; ++i) {
    const int x = strip.candidates[i];
    if (const auto from = end_of_pinhole(x, y))
      strip.filled.push_back({std::size_t(y) * width + std::size_t(x), delta_[*from], *from, {}});
  }
}

}  // namespace

int pinhole_step(const PictureGeometry& geometry) {
  const Camera& camera = geometry.capture;
  // Deltas are steps far (z - near) / (z (far - near)).
  const double z = geometry.plane_z;
  const double texel = z * (camera.window.right - camera.window.left) / camera.width;
  const double per_metre = double(delta_steps(16)) * camera.z_far * camera.z_near /
                           ((camera.z_far - camera.z_near) * z * z);
  return int(std::clamp(std::ceil(kPinholeDepth * texel * per_metre), 1.0, 65535.0));
}

void fill_pinholes(Prewarped& picture, double spacing, PinholeScratch& scratch) {
  const int h = picture.height();
  const auto strips = std::size_t((h + kPinholeRows - 1) / kPinholeRows);
  if (scratch.strips.size() < strips) scratch.strips.resize(strips);
  const PinholeFinder finder(picture.geometry, spacing, picture.delta.data());
  parallel_for(std::size_t(0), strips, [&](std::size_t i) {
    PinholeScratch::Strip& strip = scratch.strips[i];
    strip.filled.clear();
    const int end = std::min((int(i) + 1) * kPinholeRows, h);
    for (int y = int(i) * kPinholeRows; y < end; ++y) finder.find(y, strip);
    // An end of one pinhole may be within another.
    for (PinholeScratch::Filled& f : strip.filled) f.color = picture.color[f.from];
  });
  for (std::size_t i = 0; i < strips; ++i)
    for (const PinholeScratch::Filled& f : scratch.strips[i].filled)
      picture.color[f.texel] = f.color, picture.delta[f.texel] = f.delta;
}

}  // namespace rilievo
