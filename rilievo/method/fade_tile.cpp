// Eight pixels of a row of a block at a time. A colour is mixed two bytes at a time: 0 and 2, then
// 1 and 3.
#include "rilievo/method/fade_tile.h"

#include <algorithm>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/method/fade_tile.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using F = hn::CappedTag<float, FrameTile::kBlock>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using VU = hn::Vec<U>;

// Surfaces are the same, or as leaves of one tree, where their distances from the old eye differ by
// at most this share.
constexpr float kSameSurface = 0.15f;

// Each byte of a and b, b with so many shares of 256.
HWY_INLINE VU mix_bytes(VU a, VU b, VU of_b) {
  const U u;
  const VU even = hn::Set(u, 0x00ff00ffu), half = hn::Set(u, 0x00800080u);
  const VU of_a = hn::Sub(hn::Set(u, 256u), of_b);
  const auto mix = [&](VU of, VU with) {
    return hn::Add(half, hn::Add(hn::Mul(of, of_a), hn::Mul(with, of_b)));
  };
  const VU low = mix(hn::And(a, even), hn::And(b, even));
  const VU high = mix(hn::And(hn::ShiftRight<8>(a), even), hn::And(hn::ShiftRight<8>(b), even));
  return hn::Or(hn::And(hn::ShiftRight<8>(low), even), hn::AndNot(even, high));
}

// Pixels from (x, y) on, whose colours and depths are given.
HWY_INLINE VU mixed(const FadedFrames& frames, int x, int y, VU color, VF w) {
  const F f;
  const I i;
  const U u;
  const auto of = [&](float value) { return hn::Set(f, value); };
  const VF across = hn::Add(of(float(x)), hn::ConvertTo(f, hn::Iota(i, 0)));
  const glm::vec3 row = frames.axis * glm::vec3(0, float(y), 1);
  const auto coordinate = [&](int k) {
    return hn::Add(hn::Mul(across, of(frames.axis[0][k])),
                   hn::Add(hn::Mul(w, of(frames.step[k])), of(row[k])));
  };
  const VF z = coordinate(2);
  const VF near_by = hn::Div(of(-1), z), expected = hn::Mul(w, near_by);
  const auto to_raster = [&](int k) {
    const VF at = hn::Sub(hn::Mul(coordinate(k), near_by), of(frames.raster_start[k]));
    return hn::Sub(hn::Mul(at, of(frames.to_raster[k])), of(0.5f));
  };
  const VF px = to_raster(0), py = to_raster(1), zero = hn::Zero(f);
  const auto inside = hn::And(
      hn::And(hn::Lt(z, zero), hn::And(hn::Ge(px, zero), hn::Ge(py, zero))),
      hn::And(hn::Lt(px, of(float(frames.width - 1))), hn::Lt(py, of(float(frames.height - 1)))));
  if (hn::AllFalse(f, inside)) return color;
  // Those outside look at texel 0.
  const VF x_in = hn::IfThenElseZero(inside, px), y_in = hn::IfThenElseZero(inside, py);
  const VI left = hn::ConvertTo(i, x_in), top = hn::ConvertTo(i, y_in);
  const VF right_by = hn::Sub(x_in, hn::ConvertTo(f, left)),
           down_by = hn::Sub(y_in, hn::ConvertTo(f, top));
  const VI stride = hn::Set(i, frames.width), first = hn::Add(hn::Mul(top, stride), left);
  // The nearest texel shows the surface.
  const VF half = of(0.5f);
  const VI right = hn::IfThenElseZero(hn::RebindMask(i, hn::Ge(right_by, half)), hn::Set(i, 1));
  const VI below = hn::IfThenElseZero(hn::RebindMask(i, hn::Ge(down_by, half)), stride);
  const VF shown = hn::GatherIndex(f, frames.old_inverse_z, hn::Add(first, hn::Add(right, below)));
  const auto same = hn::And(
      inside, hn::Le(hn::Abs(hn::Sub(shown, expected)), hn::Mul(of(kSameSurface), expected)));
  if (hn::AllFalse(f, same)) return color;
  const auto texels = [&](VI at) { return hn::GatherIndex(u, frames.old_color, at); };
  const VI one = hn::Set(i, 1), lower = hn::Add(first, stride);
  const auto shares = [&](VF of_one) {
    return hn::BitCast(u, hn::ConvertTo(i, hn::Mul(of_one, of(256))));
  };
  const VU to_right = shares(right_by), down = shares(down_by);
  const VU old = mix_bytes(mix_bytes(texels(first), texels(hn::Add(first, one)), to_right),
                           mix_bytes(texels(lower), texels(hn::Add(lower, one)), to_right), down);
  return hn::IfThenElse(hn::RebindMask(u, same),
                        mix_bytes(color, old, hn::Set(u, frames.old_weight)), color);
}

void fade(const FadedFrames& frames, FrameTile& tile) {
  constexpr int kBlock = FrameTile::kBlock, kBlocks = FrameTile::kBlocks;
  const F f;
  const U u;
  const int columns = std::min(FrameTile::kSize, frames.width - tile.x);
  const int rows = std::min(FrameTile::kSize, frames.height - tile.y);
  float last_depths[kBlock] = {};
  std::uint32_t last_colors[kBlock] = {};
  for (int y = 0; y < rows; ++y) {
    const std::size_t row =
        std::size_t(tile.y + y) * std::size_t(frames.width) + std::size_t(tile.x);
    for (int x = 0; x < columns; x += int(hn::Lanes(f))) {
      FrameTile::Plane& plane = tile.first[y / kBlock * kBlocks + x / kBlock];
      const int at = y % kBlock * kBlock + x % kBlock;
      const std::size_t from = row + std::size_t(x), count = std::size_t(columns - x);
      const float* depths = frames.inverse_z + from;
      const std::uint32_t* colors = frames.color + from;
      if (count < hn::Lanes(f)) {
        // The row ends here, and perhaps the frame.
        std::copy_n(depths, count, last_depths);
        std::copy_n(colors, count, last_colors);
        depths = last_depths, colors = last_colors;
      }
      const VF w = hn::LoadU(f, depths);
      const VU color = hn::LoadU(u, colors);
      hn::Store(mixed(frames, tile.x + x, tile.y + y, color, w), u, plane.content + at);
      hn::Store(w, f, plane.inverse_z + at);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(fade);

void fade_tile(const FadedFrames& frames, FrameTile& tile) {
  HWY_DYNAMIC_DISPATCH(fade)(frames, tile);
}

}  // namespace rilievo
#endif
