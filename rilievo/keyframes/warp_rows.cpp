// Positions and footprints are computed for a vector of texels, and stored one texel at a time: two
// texels of a vector may cover one pixel, and most cover one or two. The largest of what meets at a
// pixel does not depend on the order.
#include "rilievo/keyframes/warp_rows.h"

#include <algorithm>
#include <cstring>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/keyframes/warp_rows.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

#include "rilievo/core/lane_numbers.inl"

using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using VU = hn::Vec<U>;
using Mask = hn::Mask<F>;
constexpr std::size_t kMaxLanes = 16;

HWY_INLINE VF number(float value) { return hn::Set(F(), value); }
HWY_INLINE VF select(Mask yes, VF a, VF b) { return hn::IfThenElse(yes, a, b); }

// A row of a RasterMap along a row of texels.
struct Along {
  float per_x, start, per_w;

  Along(const float (&row)[4], float y)
      : per_x(row[0]), start(row[1] * y + row[2]), per_w(row[3]) {}
  HWY_INLINE VF at(VF x, VF w) const {
    return hn::Add(hn::Add(hn::Mul(number(per_x), x), number(start)), hn::Mul(number(per_w), w));
  }
};

HWY_INLINE VF clamped(VF v, float low, float high) {
  return hn::Min(hn::Max(v, number(low)), number(high));
}

void splat(const WarpSource& source, int y, int from, int to, float near, const DepthStrip& out) {
  const F f;
  const I i32;
  const int lanes = int(hn::Lanes(f));
  const float py = float(y) + 0.5f;
  const Along along_x(source.to_frame.x, py), along_y(source.to_frame.y, py),
      along_z(source.to_frame.z, py);
  const float* const depths = source.keyframe->inverse_z.row(y).data();
  const VF most = number(largest_square(source));
  const int first = out.first - 1, last = out.first + out.rows;
  alignas(64) std::int32_t places[kMaxLanes], wides[kMaxLanes], highs[kMaxLanes];
  alignas(64) float inverse_z[kMaxLanes];
  alignas(64) float tail[kMaxLanes] = {};
  for (int x = from; x < to; x += lanes) {
    const float* at = depths + x;
    if (to - x < lanes) {
      std::fill_n(tail, kMaxLanes, 0.0f);
      std::copy_n(at, to - x, tail);
      at = tail;
    }
    const VF w = hn::LoadU(f, at);
    const VF px = hn::Add(hn::ConvertTo(f, lane_numbers(i32, x)), number(0.5f));
    const VF z = along_z.at(px, w);
    const VF per_z = hn::Div(number(1), hn::Max(z, number(1e-6f)));
    const VF there = hn::Mul(w, per_z);
    const Mask shown = hn::And(hn::And(hn::Gt(w, hn::Zero(f)), hn::Gt(z, number(1e-6f))),
                               hn::Le(there, number(near)));
    if (hn::AllFalse(f, shown)) continue;
    const VF qx = hn::Sub(hn::Mul(along_x.at(px, w), per_z), number(0.5f));
    const VF qy = hn::Sub(hn::Mul(along_y.at(px, w), per_z), number(0.5f));
    const VF magnified =
        hn::Min(hn::Max(hn::Mul(per_z, number(source.pixels_per_texel)), number(1)), most);
    const VF half = hn::Mul(number(kHalfSquare), magnified);
    const auto whole = [&](VF v, float low, float high) {
      return hn::ConvertTo(i32, clamped(v, low, high));
    };
    const float right = float(out.width - 1);
    const VI left_x = whole(hn::Ceil(hn::Sub(qx, half)), 0, right + 1),
             right_x = whole(hn::Floor(hn::Add(qx, half)), -1, right),
             top = whole(hn::Ceil(hn::Sub(qy, half)), float(first), float(last + 1)),
             bottom = whole(hn::Floor(hn::Add(qy, half)), float(first - 1), float(last));
    const VI wide = hn::Sub(right_x, left_x), high = hn::Sub(bottom, top);
    const VI before_0 = hn::Set(i32, -1), two = hn::Set(i32, 2);
    const auto within = hn::And(hn::RebindMask(i32, shown),
                                hn::And(hn::Gt(wide, before_0), hn::Gt(high, before_0)));
    if (hn::AllFalse(i32, within)) continue;
    const VI stride = hn::Set(i32, int(out.stride));
    // Places in the strip; what is not within changes nothing, at a place of its own.
    const VI place = hn::Add(hn::Mul(hn::Sub(top, hn::Set(i32, first)), stride),
                             hn::Add(left_x, hn::Set(i32, DepthStrip::kBorder)));
    hn::Store(hn::IfThenElseZero(within, place), i32, places);
    hn::Store(hn::IfThenElseZero(hn::RebindMask(f, within), there), f, inverse_z);
    hn::Store(hn::IfThenElseZero(within, wide), i32, wides);
    const auto small = hn::Or(hn::Not(within), hn::And(hn::Lt(wide, two), hn::Lt(high, two)));
    if (hn::AllTrue(i32, small)) {
      hn::Store(hn::IfThenElseZero(within, hn::Mul(high, stride)), i32, highs);
      for (int lane = 0; lane < lanes; ++lane) {
        // One or two pixels wide and high: without branches, which would be mispredicted.
        const float nearest = inverse_z[lane];
        float* const upper = out.inverse_z + places[lane];
        float* const lower = upper + highs[lane];
        const int beside = wides[lane];
        upper[0] = std::max(upper[0], nearest), upper[beside] = std::max(upper[beside], nearest);
        lower[0] = std::max(lower[0], nearest), lower[beside] = std::max(lower[beside], nearest);
      }
      continue;
    }
    hn::Store(hn::IfThenElse(within, high, before_0), i32, highs);
    for (int lane = 0; lane < lanes; ++lane) {
      const float nearest = inverse_z[lane];
      float* row = out.inverse_z + places[lane];
      for (int y_left = highs[lane]; y_left >= 0; --y_left, row += out.stride)
        for (int column = 0; column <= wides[lane]; ++column)
          row[column] = std::max(row[column], nearest);
    }
  }
}

#include "rilievo/keyframes/warp_lookup.inl"

// A vector of a row of which `left` numbers are left; 0 beyond.
HWY_INLINE VF load_row(const float* row, int x, int left) {
  if (left >= int(hn::Lanes(F()))) return hn::LoadU(F(), row + x);
  alignas(64) float tail[kMaxLanes] = {};
  std::copy_n(row + x, left, tail);
  return hn::Load(F(), tail);
}

// Adds `part` of what was found, as colours.
HWY_INLINE void add_part(const Found& found, VF part, Found& sum) {
  const VF per_weight =
      hn::Div(part, select(hn::Gt(found.weight, hn::Zero(F())), found.weight, number(1)));
  sum.r = hn::Add(sum.r, hn::Mul(found.r, per_weight));
  sum.g = hn::Add(sum.g, hn::Mul(found.g, per_weight));
  sum.b = hn::Add(sum.b, hn::Mul(found.b, per_weight));
}

std::uint32_t shade(const WarpSource* sources, int count, const DepthStrip& strip, int y,
                    const float* cover, float nearest_thing, float* inverse_z,
                    std::uint32_t* color) {
  const F f;
  const I i32;
  const U u32;
  const int lanes = int(hn::Lanes(f));
  const float py = float(y) + 0.5f;
  const VF zero = hn::Zero(f), one = number(1), least = number(float(kLeastShown));
  const float *row = strip.row(y), *above = strip.row(y - 1), *below = strip.row(y + 1);
  std::uint32_t holes = 0;
  for (int x = 0; x < strip.width; x += lanes) {
    const VF px = hn::Add(hn::ConvertTo(f, lane_numbers(i32, x)), number(0.5f));
    const VF splatted = hn::LoadU(f, row + x);
    const VF left_of = hn::LoadU(f, row + x - 1), right_of = hn::LoadU(f, row + x + 1);
    const VF over = hn::LoadU(f, above + x), under = hn::LoadU(f, below + x);
    const VF nearest = hn::Max(hn::Max(left_of, right_of), hn::Max(over, under));
    const int left = strip.width - x;
    // Behind what covers it; of these, before which there is something that no keyframe shows?
    Mask covered = hn::Gt(zero, zero), unknown = covered;
    if (cover) {
      const VF hides = load_row(cover, x, left);
      covered = hn::Gt(hides, splatted);
      if (!hn::AllFalse(f, covered))
        unknown = hn::AndNot(
            hn::Or(hn::Gt(hides, number(nearest_thing)), seen_until(sources, count, px, py, hides)),
            covered);
    }
    // Pixel by pixel, so that the same ones are with any number of lanes.
    Mask plain = hn::Gt(zero, zero);
    if (strip.plain_sky && strip.plain_sky[x / kPlainSkyColumns] != 0)
      plain = hn::AndNot(covered, hn::Eq(hn::Max(splatted, nearest), zero));
    if (left >= lanes && hn::AllTrue(f, plain)) {
      hn::StoreU(hn::Set(u32, kPlainSky), u32, color + x);
      hn::StoreU(zero, f, inverse_z + x);
      continue;
    }
    const VU under_cover =
        hn::IfThenZeroElse(hn::RebindMask(u32, unknown), hn::Set(u32, kCoveredPixel));
    if (hn::AllTrue(f, covered)) {
      hn::StoreU(under_cover, u32, color + x);
      hn::StoreU(zero, f, inverse_z + x);
      holes += std::uint32_t(hn::CountTrue(f, unknown));
      continue;
    }
    // At an edge the surface in front covers a part of the pixel, and the one behind the rest. One
    // of them is the pixel's own.
    const VF farthest = hn::Min(hn::Min(left_of, right_of), hn::Min(over, under));
    const VF times = number(1 + kSameSurfaceDepth);
    const Mask is_behind = hn::Gt(nearest, hn::Mul(splatted, times));
    const Mask edge = hn::Or(is_behind, hn::Gt(splatted, hn::Mul(farthest, times)));
    const VF front = select(is_behind, nearest, splatted),
             back = select(is_behind, splatted, farthest);
    // In the sky away from edges what was before it is elsewhere by now. A surface may have another
    // one just before it, which is no edge.
    const Mask mixes = hn::Or(edge, hn::Gt(front, zero));
    const Found nearer = find(sources, count, px, py, front, mixes);
    const auto has_color = [&](const Found& found) {
      return hn::And(hn::Gt(found.cover, least), hn::Gt(found.weight, zero));
    };
    const Mask known = has_color(nearer);
    // In front is what an eye has come too near to. Nothing behind it is seen.
    const Mask left_behind = hn::AndNot(known, nearer.too_near);
    // Shown as a whole where it is no edge.
    Mask shown = hn::And(known, hn::Or(edge, hn::Gt(nearer.own, zero)));
    VF part = hn::IfThenElseZero(shown, one), w = front;
    Found sum{zero, zero, zero, zero, zero, zero, zero, left_behind};
    if (!hn::AllFalse(f, edge)) {
      const Found farther = find(sources, count, px, py, back, edge);
      const Mask behind = hn::AndNot(left_behind, hn::And(edge, has_color(farther)));
      // Without anything behind, the surface in front is all there is.
      const VF covers =
          hn::Div(nearer.front, select(hn::Gt(nearer.weight, zero), nearer.weight, one));
      part = select(
          behind,
          hn::Min(hn::Mul(covers, number(1.0f / (float(kQuarterParts) * kTexelWeights))), one),
          part);
      w = select(hn::And(behind, hn::Lt(part, number(0.5f))), back, w);
      shown = hn::Or(shown, behind);
      add_part(farther, hn::IfThenElseZero(behind, hn::Sub(one, part)), sum);
    }
    add_part(nearer, part, sum);
    const auto byte = [&](VF channel) {
      const VF value = hn::Min(hn::Add(channel, number(0.5f)), number(255));
      return hn::BitCast(u32, hn::ConvertTo(i32, value));
    };
    VU out = hn::Or(hn::Or(byte(sum.r), hn::ShiftLeft<8>(byte(sum.g))),
                    hn::Or(hn::ShiftLeft<16>(byte(sum.b)), hn::Set(u32, 0xff000000u)));
    out = hn::IfThenElseZero(hn::RebindMask(u32, shown), out);
    out = hn::IfThenElse(hn::RebindMask(u32, plain), hn::Set(u32, kPlainSky), out);
    shown = hn::Or(shown, plain);
    w = hn::IfThenElseZero(hn::AndNot(covered, shown), w);
    out = hn::IfThenElse(hn::RebindMask(u32, covered), under_cover, out);
    if (left >= lanes) {
      hn::StoreU(out, u32, color + x);
      hn::StoreU(w, f, inverse_z + x);
      const Mask filled = hn::Or(hn::AndNot(covered, shown), hn::AndNot(unknown, covered));
      holes += std::uint32_t(lanes) - std::uint32_t(hn::CountTrue(f, filled));
      continue;
    }
    alignas(64) std::uint32_t colors[kMaxLanes];
    alignas(64) float depths[kMaxLanes];
    hn::Store(out, u32, colors);
    hn::Store(w, f, depths);
    for (int i = 0; i < left; ++i)
      color[x + i] = colors[i], inverse_z[x + i] = depths[i], holes += colors[i] == 0;
  }
  return holes;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(splat);
HWY_EXPORT(shade);

void splat_row(const WarpSource& source, int y, int from, int to, float near,
               const DepthStrip& out) {
  HWY_DYNAMIC_DISPATCH(splat)(source, y, from, to, near, out);
}

std::uint32_t shade_row(const WarpSource* sources, int count, const DepthStrip& strip, int y,
                        const float* cover, float nearest_thing, float* inverse_z,
                        std::uint32_t* color) {
  return HWY_DYNAMIC_DISPATCH(shade)(sources, count, strip, y, cover, nearest_thing, inverse_z,
                                     color);
}

}  // namespace rilievo
#endif
