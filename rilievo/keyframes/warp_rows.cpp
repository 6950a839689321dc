// Positions and footprints are computed for a vector of texels, and stored one texel at a time: two
// texels of a vector may cover one pixel, and most cover one or two. The largest of what meets at a
// pixel does not depend on the order.
#include "rilievo/keyframes/warp_rows.h"

#include <algorithm>
#include <cmath>
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

// A vector of a row of which `left` numbers are left; 0 beyond.
HWY_INLINE VF load_row(const float* row, int x, int left) {
  if (left >= int(hn::Lanes(F()))) return hn::LoadU(F(), row + x);
  alignas(64) float tail[kMaxLanes] = {};
  std::copy_n(row + x, std::max(left, 0), tail);
  return hn::Load(F(), tail);
}

// Places of texels in the frame, in pixels from the first pixel's centre.
struct Places {
  VF x, y, z, inverse_z;
};

HWY_INLINE Places places_of(const WarpSource& source, float row, VF column, VF w) {
  const VF z = Along(source.to_frame.z, row).at(column, w);
  const VF per_z = hn::Div(number(1), hn::Max(z, number(1e-6f)));
  const auto at = [&](const float(&map)[4]) {
    return hn::Sub(hn::Mul(Along(map, row).at(column, w), per_z), number(0.5f));
  };
  return {at(source.to_frame.x), at(source.to_frame.y), z, hn::Mul(w, per_z)};
}

HWY_INLINE VF farther_axis(const Places& a, const Places& b) {
  return hn::Max(hn::Abs(hn::Sub(a.x, b.x)), hn::Abs(hn::Sub(a.y, b.y)));
}

// A texel in the frame.
struct Place {
  float x, y, inverse_z;
};

// Along the line from one to the other, `half` to each side of it along the axis on which it goes
// less far.
void draw_bridge(const Place& from, const Place& to, float half, const DepthStrip& out) {
  const float step_x = to.x - from.x, step_y = to.y - from.y;
  const bool across = std::abs(step_x) >= std::abs(step_y);
  const int top = out.first - 1, bottom = out.first + out.rows, right = out.width - 1;
  const float begin = across ? from.x : from.y, step = across ? step_x : step_y,
              beside = across ? from.y : from.x, step_beside = across ? step_y : step_x,
              deeper = to.inverse_z - from.inverse_z;
  // Whole numbers from `low` to `high`, of which there are few, within the frame's or the strip's.
  const auto first_of = [](float low, int least, int most) {
    return int(std::clamp(std::ceil(low), float(least), float(most + 1)));
  };
  const auto last_of = [](float high, int least, int most) {
    return int(std::clamp(std::floor(high), float(least - 1), float(most)));
  };
  const int least = across ? 0 : top, most = across ? right : bottom,
            least_beside = across ? top : 0, most_beside = across ? bottom : right;
  const int last = last_of(std::max(begin, begin + step), least, most);
  for (int i = first_of(std::min(begin, begin + step), least, most); i <= last; ++i) {
    const float way = std::clamp((float(i) - begin) / step, 0.0f, 1.0f);
    const float inverse_z = from.inverse_z + way * deeper, middle = beside + way * step_beside;
    const int last_beside = last_of(middle + half, least_beside, most_beside);
    for (int k = first_of(middle - half, least_beside, most_beside); k <= last_beside; ++k) {
      float& pixel = across ? out.row(k)[i] : out.row(i)[k];
      pixel = std::max(pixel, inverse_z);
    }
  }
}

// Draws what closes the cracks between texels `from` and `to` of one surface.
void draw_bridges(const Places& from, const Places& to, Mask wanted, VF half, float near,
                  const DepthStrip& out) {
  const F f;
  const VF step = farther_axis(from, to);
  const Mask seen = hn::And(hn::Gt(to.z, number(1e-6f)), hn::Le(to.inverse_z, number(near)));
  const Mask crack = hn::And(hn::Gt(step, hn::Add(half, half)), hn::Le(step, number(kWidestCrack)));
  const Mask open = hn::And(wanted, hn::And(seen, crack));
  if (hn::AllFalse(f, open)) return;
  alignas(64) float opens[kMaxLanes], halves[kMaxLanes], ends[2][3][kMaxLanes];
  hn::Store(hn::IfThenElseZero(open, number(1)), f, opens);
  hn::Store(half, f, halves);
  for (const int end : {0, 1}) {
    const Places& at = end == 0 ? from : to;
    hn::Store(at.x, f, ends[end][0]);
    hn::Store(at.y, f, ends[end][1]);
    hn::Store(at.inverse_z, f, ends[end][2]);
  }
  const auto place = [&](int end, std::size_t i) {
    return Place{ends[end][0][i], ends[end][1][i], ends[end][2][i]};
  };
  for (std::size_t i = 0; i < hn::Lanes(f); ++i)
    if (opens[i] > 0) draw_bridge(place(0, i), place(1, i), halves[i], out);
}

// Closes the cracks between texels of row `y`, from column `x` on, and their neighbours to the
// right and below (kCrackParallax).
HWY_NOINLINE void close_cracks(const WarpSource& source, int x, int y, VF px, VF w, Mask shown,
                               VF half, float near, const DepthStrip& out) {
  const F f;
  const Keyframe& key = *source.keyframe;
  const int left = key.camera.width - x;
  const float py = float(y) + 0.5f;
  const VF right = load_row(key.inverse_z.row(y).data(), x + 1, left - 1),
           below = y + 1 < key.camera.height ? load_row(key.inverse_z.row(y + 1).data(), x, left)
                                             : hn::Zero(f);
  // Most are not: that is seen before anything is warped.
  const auto is_slanted = [&](VF depth) {
    const VF step = hn::Abs(hn::Sub(depth, w));
    return hn::And(hn::And(shown, hn::Gt(depth, hn::Zero(f))),
                   hn::And(hn::Gt(step, hn::Mul(number(kLeastSlant), w)),
                           hn::Le(step, hn::Mul(number(kSameSurfaceDepth), w))));
  };
  const Mask slants_right = is_slanted(right), slants_below = is_slanted(below);
  if (hn::AllFalse(f, hn::Or(slants_right, slants_below))) return;
  const Places here = places_of(source, py, px, w);
  const Places at_infinity = places_of(source, py, px, hn::Zero(f));
  const Mask moved = hn::Gt(farther_axis(here, at_infinity), number(kCrackParallax));
  const auto close = [&](Mask slants, float row, VF column, VF depth) {
    const Mask wanted = hn::And(moved, slants);
    if (!hn::AllFalse(f, wanted))
      draw_bridges(here, places_of(source, row, column, depth), wanted, half, near, out);
  };
  close(slants_right, py, hn::Add(px, number(1)), right);
  close(slants_below, py + 1, px, below);
}

void splat(const WarpSource& source, int y, int from, int to, float near, bool may_crack,
           const DepthStrip& out) {
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
    if (may_crack) close_cracks(source, x, y, px, w, shown, half, near, out);
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

void splat_row(const WarpSource& source, int y, int from, int to, float near, bool may_crack,
               const DepthStrip& out) {
  HWY_DYNAMIC_DISPATCH(splat)(source, y, from, to, near, may_crack, out);
}

std::uint32_t shade_row(const WarpSource* sources, int count, const DepthStrip& strip, int y,
                        const float* cover, float nearest_thing, float* inverse_z,
                        std::uint32_t* color) {
  return HWY_DYNAMIC_DISPATCH(shade)(sources, count, strip, y, cover, nearest_thing, inverse_z,
                                     color);
}

}  // namespace rilievo
#endif
