// Few texels have something in front on both sides in their row: these are found many at a time,
// by the least Delta of eight, which three minima of the row with itself give. The others are asked
// one by one.
#include "rilievo/layered_relief/fill_pinholes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "rilievo/core/depth.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr int kPinholeRows = 32;
static_assert(kPinholeReach == 8, "three minima");

// Finds pinholes in a picture's Deltas.
class PinholeFinder {
 public:
  PinholeFinder(const PictureGeometry& geometry, double spacing, const std::uint16_t* delta)
      : camera_(geometry.capture),
        delta_(delta),
        step_(pinhole_step(geometry)),
        spacing_at_1_(spacing * geometry.plane_z) {}

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
    const double z = eye_z_from(DepthKind::window_z, decode_delta(delta, 16), camera_, {});
    return std::max(1.0, std::round(spacing_at_1_ / z));
  }

  const Camera& camera_;
  const std::uint16_t* delta_;
  int step_;
  double spacing_at_1_;  // at eye_z = 1
};

std::optional<PinholeFinder::Gap> PinholeFinder::gap(int x, int y, int right, int down) const {
  struct End {
    int way, steps;
    std::size_t texel;
  };
  const std::size_t texel = std::size_t(y) * std::size_t(camera_.width) + std::size_t(x);
  const auto advance = [&](End& end) {
    const std::size_t from = end.texel;
    while (++end.steps <= kPinholeReach) {
      const int u = x + end.way * end.steps * right, v = y + end.way * end.steps * down;
      if (u < 0 || v < 0 || u >= camera_.width || v >= camera_.height) return false;
      end.texel = std::size_t(v) * std::size_t(camera_.width) + std::size_t(u);
      if (int(delta_[from]) > int(delta_[end.texel]) + step_) return true;
    }
    return false;
  };
  End near{-1, 0, texel}, far{1, 0, texel};
  if (!advance(near) || !advance(far)) return std::nullopt;
  for (;;) {
    if (delta_[near.texel] > delta_[far.texel]) std::swap(near, far);
    const int texels = near.steps + far.steps - 1;
    if (texels > kPinholeReach) return std::nullopt;
    if (int(delta_[far.texel]) - int(delta_[near.texel]) <= kPinholeEnds * step_)
      return Gap{near.texel, far.texel, texels};
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
  auto& least_of = strip.least;
  const auto width = std::size_t(camera_.width), padded = width + 2 * kPinholeReach;
  const std::uint16_t* const row = delta_ + std::size_t(y) * width;
  for (std::vector<std::uint16_t>& least : least_of) least.assign(padded, 0xffff);
  std::copy_n(row, width, least_of[0].begin() + kPinholeReach);
  for (std::size_t k = 1; k < least_of.size(); ++k) {
    const std::size_t apart = std::size_t(1) << (k - 1);
    const std::uint16_t* const from = least_of[k - 1].data();
    std::uint16_t* const to = least_of[k].data();
    for (std::size_t i = 0; i + apart < padded; ++i) to[i] = std::min(from[i], from[i + apart]);
  }
  const std::uint16_t* const before = least_of[3].data();
  const std::uint16_t* const after = before + kPinholeReach + 1;
  for (std::size_t x = 0; x < width; ++x) {
    if (int(row[x]) <= std::max(int(before[x]), int(after[x])) + step_) continue;
    if (const auto from = end_of_pinhole(int(x), y))
      strip.filled.push_back({std::size_t(y) * width + x, *from, {}});
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
  scratch.before = picture.delta;
  const auto strips = std::size_t((h + kPinholeRows - 1) / kPinholeRows);
  if (scratch.strips.size() < strips) scratch.strips.resize(strips);
  const PinholeFinder finder(picture.geometry, spacing, scratch.before.data());
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
      picture.color[f.texel] = f.color, picture.delta[f.texel] = scratch.before[f.from];
}

}  // namespace rilievo
