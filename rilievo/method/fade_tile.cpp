// Eight pixels of a row of a block at a time. A colour is mixed two bytes at a time: 0 and 2, then
// 1 and 3.
#include "rilievo/method/fade_tile.h"

#include <algorithm>
#include <array>
#include <span>

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

// More that has moved in one tile is not told apart: all of it is new.
constexpr std::size_t kMostMoved = 64;

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

// The four texels of the old frame around a place.
struct OldTexels {
  VI first, right, below;  // of the top left one; what is added for the nearest one
};

struct OldPixels {
  VF inverse_z;    // of the nearest texel
  VU least, most;  // of each byte of the four
};

// Of each byte of a and b the smaller one, or the larger one.
#if HWY_TARGET == HWY_SCALAR
// A lane has no bytes there.
template <typename Choose>
VU choose_bytes(VU a, VU b, const Choose& choose) {
  const U u;
  VU all = hn::Zero(u);
  for (const std::uint32_t byte : {0xffu, 0xff00u, 0xff0000u, 0xff000000u}) {
    const VU mask = hn::Set(u, byte);
    all = hn::Or(all, choose(hn::And(a, mask), hn::And(b, mask)));
  }
  return all;
}
#else
template <typename Choose>
HWY_INLINE VU choose_bytes(VU a, VU b, const Choose& choose) {
  const hn::Repartition<std::uint8_t, U> bytes;
  return hn::BitCast(U(), choose(hn::BitCast(bytes, a), hn::BitCast(bytes, b)));
}
#endif

HWY_INLINE VU least_bytes(VU a, VU b) {
  return choose_bytes(a, b, [](auto one, auto other) HWY_ATTR { return hn::Min(one, other); });
}

HWY_INLINE VU most_bytes(VU a, VU b) {
  return choose_bytes(a, b, [](auto one, auto other) HWY_ATTR { return hn::Max(one, other); });
}

// The sum over the four bytes of a and b.
HWY_INLINE VU difference(VU a, VU b) {
  const U u;
  const VU bytes = hn::Sub(most_bytes(a, b), least_bytes(a, b)), even = hn::Set(u, 0x00ff00ffu);
  const VU pairs = hn::Add(hn::And(bytes, even), hn::And(hn::ShiftRight<8>(bytes), even));
  return hn::And(hn::Add(pairs, hn::ShiftRight<16>(pairs)), hn::Set(u, 0xffffu));
}

HWY_INLINE OldPixels of_texels(VF inverse_z, VU a, VU b, VU c, VU d) {
  return {inverse_z, least_bytes(least_bytes(a, b), least_bytes(c, d)),
          most_bytes(most_bytes(a, b), most_bytes(c, d))};
}

// Where all texels lie in 2 N of two rows, N lanes: several times as fast as to gather them.
// `offset`: from the first one.
HWY_INLINE OldPixels load_texels(const FadedFrames& frames, const OldTexels& at, std::size_t from,
                                 VI offset) {
  const F f;
  const I i;
  const U u;
  const std::size_t below = from + std::size_t(frames.width);
  const VI last = hn::Set(i, int(hn::Lanes(i)) - 1);
  const auto look = [&](auto d, const auto* row, VI index) {
    const auto lane = hn::IndicesFromVec(d, hn::And(index, last));
    return hn::IfThenElse(hn::RebindMask(d, hn::Gt(index, last)),
                          hn::TableLookupLanes(hn::LoadU(d, row + hn::Lanes(d)), lane),
                          hn::TableLookupLanes(hn::LoadU(d, row), lane));
  };
  const VI next = hn::Add(offset, hn::Set(i, 1)), nearest = hn::Add(offset, at.right);
  const float* depths = frames.old_inverse_z;
  const std::uint32_t* colors = frames.old_color;
  const auto lower = hn::RebindMask(f, hn::Gt(at.below, hn::Zero(i)));
  return of_texels(
      hn::IfThenElse(lower, look(f, depths + below, nearest), look(f, depths + from, nearest)),
      look(u, colors + from, offset), look(u, colors + from, next), look(u, colors + below, offset),
      look(u, colors + below, next));
}

HWY_INLINE OldPixels gather_texels(const FadedFrames& frames, const OldTexels& at) {
  const F f;
  const I i;
  const U u;
  const VI one = hn::Set(i, 1), lower = hn::Add(at.first, hn::Set(i, frames.width));
  const auto texels = [&](VI index) { return hn::GatherIndex(u, frames.old_color, index); };
  return of_texels(
      hn::GatherIndex(f, frames.old_inverse_z, hn::Add(at.first, hn::Add(at.right, at.below))),
      texels(at.first), texels(hn::Add(at.first, one)), texels(lower), texels(hn::Add(lower, one)));
}

// Do pixels from (x, y) on, or those beside them, show what has moved, or did the four texels of
// the old frame that begin at `first`? A pixel has the depth of one of its samples: silhouettes are
// found by what is beside them.
HWY_INLINE hn::Mask<F> has_moved(const FadedFrames& frames,
                                 std::span<const MovedThing* const> moved, int x, int y, VF w,
                                 VI first) {
  const F f;
  const I i;
  const VF across = hn::Add(hn::Set(f, float(x)), hn::ConvertTo(f, hn::Iota(i, 0)));
  const std::size_t width = std::size_t(frames.width), lanes = hn::Lanes(f),
                    at = std::size_t(y) * width + std::size_t(x);
  const bool has_beside = at > width && at + width + lanes < width * std::size_t(frames.height);
  const auto old = [&](int offset) {
    return hn::GatherIndex(f, frames.old_inverse_z, hn::Add(first, hn::Set(i, offset)));
  };
  const VF old_w[] = {old(0), old(1), old(frames.width), old(frames.width + 1)};
  const float* depths = frames.inverse_z + at;
  auto any = hn::Lt(across, hn::Zero(f));  // none
  for (const MovedThing* thing : moved) {
    if (float(y) < thing->top || float(y) >= thing->bottom) continue;
    const auto in =
        hn::And(hn::Ge(across, hn::Set(f, thing->left)), hn::Lt(across, hn::Set(f, thing->right)));
    if (hn::AllFalse(f, in)) continue;
    const auto shows = [&](VF value) {
      return hn::And(hn::Ge(value, hn::Set(f, thing->least_inverse_z)),
                     hn::Le(value, hn::Set(f, thing->most_inverse_z)));
    };
    auto it = shows(w);
    for (const VF one : old_w) it = hn::Or(it, shows(one));
    if (has_beside)
      for (const float* beside : {depths - 1, depths + 1, depths - width, depths + width})
        it = hn::Or(it, shows(hn::LoadU(f, beside)));
    any = hn::Or(any, hn::And(in, it));
  }
  return any;
}

// Pixels from (x, y) on, whose colours and depths are given.
HWY_INLINE VU mixed(const FadedFrames& frames, std::span<const MovedThing* const> moved, int x,
                    int y, VU color, VF w) {
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
  const OldTexels texels{
      first, hn::IfThenElseZero(hn::RebindMask(i, hn::Ge(right_by, half)), hn::Set(i, 1)),
      hn::IfThenElseZero(hn::RebindMask(i, hn::Ge(down_by, half)), stride)};
  // Where the frames differ little a row's pixels lie in one row.
  const int lanes = int(hn::Lanes(i)), from = hn::GetLane(hn::MinOfLanes(i, first));
  const VI offset = hn::Sub(first, hn::Set(i, from));
  const bool near_by_each_other = hn::AllTrue(i, hn::Lt(offset, hn::Set(i, 2 * lanes - 1))) &&
                                  from + frames.width + 2 * lanes <= frames.width * frames.height;
  const OldPixels old = near_by_each_other ? load_texels(frames, texels, std::size_t(from), offset)
                                           : gather_texels(frames, texels);
  auto same = hn::And(inside, hn::Le(hn::Abs(hn::Sub(old.inverse_z, expected)),
                                     hn::Mul(of(kSameSurface), expected)));
  if (!moved.empty()) same = hn::AndNot(has_moved(frames, moved, x, y, w, first), same);
  const VF passed = hn::Mul(w, of(frames.way));
  const VF as_before =
      hn::Mul(hn::Sub(of(kOtherShading), passed), of(1 / (kOtherShading - kSameShading)));
  const VF of_old = hn::Mul(hn::Min(hn::Max(as_before, zero), of(1)), of(float(frames.old_weight)));
  // The colour between the old texels that is nearest to the new one.
  return hn::IfThenElse(hn::RebindMask(u, same),
                        mix_bytes(color, most_bytes(old.least, least_bytes(old.most, color)),
                                  hn::BitCast(u, hn::ConvertTo(i, of_old))),
                        color);
}

double fade(const FadedFrames& frames, FrameTile& tile) {
  constexpr int kBlock = FrameTile::kBlock, kBlocks = FrameTile::kBlocks;
  const F f;
  const U u;
  const int columns = std::min(FrameTile::kSize, frames.width - tile.x);
  const int rows = std::min(FrameTile::kSize, frames.height - tile.y);
  float last_depths[kBlock] = {};
  std::uint32_t last_colors[kBlock] = {};
  VU of_old = hn::Zero(u);
  std::array<const MovedThing*, kMostMoved> things;
  std::size_t count_moved = 0;
  for (const MovedThing& thing : frames.moved)
    if (thing.left < float(tile.x + columns) && thing.right > float(tile.x) &&
        thing.top < float(tile.y + rows) && thing.bottom > float(tile.y) &&
        count_moved++ < things.size())
      things[count_moved - 1] = &thing;
  const bool all_moved = count_moved > things.size();
  const std::span<const MovedThing* const> moved(things.data(), all_moved ? 0 : count_moved);
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
      const VU mix = all_moved ? color : mixed(frames, moved, tile.x + x, tile.y + y, color, w);
      hn::Store(mix, u, plane.content + at);
      of_old = hn::Add(of_old, hn::IfThenElseZero(hn::FirstN(u, count), difference(mix, color)));
      hn::Store(w, f, plane.inverse_z + at);
    }
  }
  return double(hn::GetLane(hn::SumOfLanes(u, of_old))) / (3.0 * columns * rows);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(fade);

double fade_tile(const FadedFrames& frames, FrameTile& tile) {
  return HWY_DYNAMIC_DISPATCH(fade)(frames, tile);
}

}  // namespace rilievo
#endif
