// How it is done fast: positions are found for a block of samples by SIMD, as addresses; then the
// samples are copied there one by one, in their order, without a branch. Scatter instructions are
// no faster than that. Of splats only those are kept that reach the tile: most samples of a deep
// scene are asked by several tiles. A nearest sample that misses is copied to a row that nobody
// reads, and those of one block are copied in turn with finding the next block's positions
// (alternate): a sixth faster; splats of two by two are bound by their masked stores and gain
// nothing.
//
// A position becomes an index by adding 1.5 * 2^23: the sum's lowest bits are then the nearest
// integer. One addition, where a conversion needs several instructions to mend what is too large.
// Positions are half a texel less for it (set_coefficients), so that the nearest integer is the
// texel's index.
#include "rilievo/layered_relief/prewarp_kernels.h"

#include <algorithm>
#include <cstring>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/layered_relief/prewarp_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;

constexpr std::uint32_t kBlock = 256;

constexpr float kToIndex = 12582912.0f;          // 1.5 * 2^23
constexpr std::int32_t kIndexBits = 0x4B400000;  // its bits

static_assert(sizeof(ReliefSample) == 8, "copied as one word");

HWY_INLINE void copy(ReliefSample* to, const ReliefSample* from) {
  std::uint64_t word;
  std::memcpy(&word, from, 8);
  std::memcpy(to, &word, 8);
}

// Of the samples at `from`, one a lane.
struct Lanes {
  VI u, v;     // in their tile
  VF code, w;  // w: what x and y are multiplied with
};

HWY_INLINE Lanes load(const PrewarpCoefficients& k, const ReliefSample* from) {
  const F f;
  const I i;
  const U d;
  const auto* words = reinterpret_cast<const std::uint32_t*>(from);
  hn::Vec<U> place, color;
  hn::LoadInterleaved2(d, words, place, color);
  const auto low = hn::Set(d, 0xff);
  Lanes lanes;
  lanes.u = hn::BitCast(i, hn::And(place, low));
  lanes.v = hn::BitCast(i, hn::And(hn::ShiftRight<8>(place), low));
  lanes.code = hn::ConvertTo(f, hn::BitCast(i, hn::ShiftRight<16>(place)));
  lanes.w = hn::Div(hn::Set(f, 1.0f),
                    hn::Add(hn::Mul(hn::Set(f, k.w_code), lanes.code), hn::Set(f, k.w_0)));
  return lanes;
}

// (scale u + shift) w: the index that it rounds to, with kIndexBits added.
HWY_INLINE VI index_of(VF u, VF scale, VF shift, VF w) {
  const VF position = hn::Mul(hn::Add(hn::Mul(scale, u), shift), w);
  return hn::BitCast(I(), hn::Add(position, hn::Set(F(), kToIndex)));
}

// 0 <= index < size?
HWY_INLINE hn::Mask<I> within(VI index, VI size) {
  const U d;
  return hn::RebindMask(I(), hn::Lt(hn::BitCast(d, index), hn::BitCast(d, size)));
}

// Of its columns?
HWY_INLINE hn::Mask<I> in_columns(const PrewarpRun& run, VI u) {
  const I i;
  return hn::And(hn::Gt(u, hn::Set(i, int(run.u_from) - 1)), hn::Lt(u, hn::Set(i, int(run.u_to))));
}

// Not too near?
HWY_INLINE hn::Mask<I> is_shown(const PrewarpCoefficients& k, const Lanes& s) {
  return hn::RebindMask(I(), hn::Ge(s.code, hn::Set(F(), k.least_code)));
}

// How many of the first `count` lanes are set?
HWY_INLINE std::size_t count_first(hn::Mask<I> mask, std::uint32_t count) {
  const I i;
  if (count < hn::Lanes(i)) mask = hn::And(mask, hn::FirstN(i, count));
  return hn::CountTrue(i, mask);
}

// How copy_rectangle() is told of so many columns: by a mask if masked stores are cheap.
HWY_INLINE VI columns_of(VI wide) {
#if HWY_TARGET <= HWY_AVX3
  const VI one = hn::Set(I(), 1);
  return hn::Sub(hn::Shl(one, wide), one);
#else
  return wide;
#endif
}

// Copies a sample to `columns` of `high` rows from `to`, at most kWide (2 or 4) and kHigh each.
// Every row is stored to, a missing one again where the last one is: how many there are is as good
// as random, and a branch on it would be foretold wrongly.
template <int kWide, int kHigh>
HWY_INLINE void copy_rectangle(ReliefSample* to, std::int32_t columns, int high,
                               std::ptrdiff_t pitch, const ReliefSample* from) {
  // To the next row, or none. Compilers make a branch of `row < high ? pitch : 0`.
  const auto step = [&](int row) { return pitch & -std::ptrdiff_t(row < high); };
#if HWY_TARGET <= HWY_AVX3
  const hn::FixedTag<std::uint64_t, kWide> d;
  std::uint64_t word;
  std::memcpy(&word, from, 8);
  const auto copies = hn::Set(d, word);
  std::uint8_t bits[8] = {};
  std::memcpy(bits, &columns, sizeof columns);
  const auto mask = hn::LoadMaskBits(d, bits);
  for (int row = 1; row <= kHigh; to += step(row++))
    hn::BlendedStore(copies, mask, d, reinterpret_cast<std::uint64_t*>(to));
#else
  for (int row = 1; row <= kHigh; to += step(row++)) {
    ReliefSample* column = to;
    for (int k = 1; k <= kWide; column += k++ < columns) copy(column, from);
  }
#endif
}

// Splats that cover texels: where the first is, how far they go, and whose they are. Compressed
// vectors are stored whole.
struct Found {
  static constexpr std::size_t kStored = kBlock + hn::MaxLanes(F());
  HWY_ALIGN std::int32_t address[kStored], wide[kStored], high[kStored], which[kStored];
  std::size_t count = 0;
};

template <int kWide, int kHigh>
void copy_found(const Found& found, const PrewarpTile& tile, const ReliefSample* samples) {
  ReliefSample* const texels = tile.texels;
  const std::ptrdiff_t pitch = tile.pitch;
  const std::size_t count = found.count;
  for (std::size_t n = 0; n < count; ++n)
    copy_rectangle<kWide, kHigh>(texels + found.address[n], found.wide[n], found.high[n], pitch,
                                 samples + found.which[n]);
}

// Of at most four texels along an axis: by what is enough for the largest of them.
void copy_few(const Found& found, int widest, int highest, const PrewarpTile& tile,
              const ReliefSample* samples) {
  if (widest <= 2) {
    if (highest <= 2)
      copy_found<2, 2>(found, tile, samples);
    else if (highest == 3)
      copy_found<2, 3>(found, tile, samples);
    else
      copy_found<2, 4>(found, tile, samples);
  } else {
    if (highest <= 2)
      copy_found<4, 2>(found, tile, samples);
    else if (highest == 3)
      copy_found<4, 3>(found, tile, samples);
    else
      copy_found<4, 4>(found, tile, samples);
  }
}

// Copies samples to where they belong, in their order.
HWY_INLINE void copy_block(ReliefSample* texels, const ReliefSample* samples,
                           const std::int32_t* address, std::uint32_t count) {
  std::uint32_t n = 0;
  for (; n + 4 <= count; n += 4) {
    copy(texels + address[n], samples + n);
    copy(texels + address[n + 1], samples + n + 1);
    copy(texels + address[n + 2], samples + n + 2);
    copy(texels + address[n + 3], samples + n + 3);
  }
  for (; n < count; ++n) copy(texels + address[n], samples + n);
}

// Calls find(at, samples, count, half) for each vector of each block of the run, at = 0, lanes,
// ..., and in turn put(from, to, samples, half) for the same part of the block before: finding
// positions and storing samples keep different parts of the processor busy. `half`: which of two
// buffers a block has.
template <typename Find, typename Put>
HWY_INLINE void alternate(const PrewarpRun& run, const Find& find, const Put& put) {
  const std::uint32_t lanes = std::uint32_t(hn::Lanes(F()));
  std::uint32_t half = 0, begin = 0;
  for (; begin < run.count; begin += kBlock, half ^= 1) {
    const std::uint32_t count = std::min(kBlock, run.count - begin);
    const ReliefSample* samples = run.samples + begin;
    if (begin == 0) {
      for (std::uint32_t at = 0; at < count; at += lanes) find(at, samples, count, half);
      continue;
    }
    std::uint32_t at = 0;
    for (; at < count; at += lanes) {
      find(at, samples, count, half);
      put(at, at + lanes, samples - kBlock, half ^ 1);
    }
    if (at < kBlock) put(at, kBlock, samples - kBlock, half ^ 1);
  }
  if (begin == 0) return;
  begin -= kBlock;
  put(0, run.count - begin, run.samples + begin, half ^ 1);
}

std::size_t nearest_run(const PrewarpCoefficients& k, const PrewarpRun& run,
                        const PrewarpTile& tile) {
  const F f;
  const I i;
  HWY_ALIGN std::int32_t address[2][kBlock];
  const VI missed = hn::Set(i, tile.missed), pitch = hn::Set(i, tile.pitch);
  const VI width = hn::Set(i, tile.width), height = hn::Set(i, tile.height);
  const VI x_first = hn::Set(i, tile.x + kIndexBits), y_first = hn::Set(i, tile.y + kIndexBits);
  const VF scale = hn::Set(f, k.scale);
  std::size_t drawn = 0;
  alternate(
      run,
      [&](std::uint32_t at, const ReliefSample* samples, std::uint32_t count, std::uint32_t half)
          HWY_ATTR {
            const Lanes s = load(k, samples + at);
            const VF u = hn::Add(hn::ConvertTo(f, s.u), hn::Set(f, run.u));
            const VF v = hn::Add(hn::ConvertTo(f, s.v), hn::Set(f, run.v));
            const VF shift_x = hn::Add(hn::Mul(hn::Set(f, k.x_code), s.code), hn::Set(f, k.x_0));
            const VF shift_y = hn::Add(hn::Mul(hn::Set(f, k.y_code), s.code), hn::Set(f, k.y_0));
            const VI x = hn::Sub(index_of(u, scale, shift_x, s.w), x_first);
            const VI y = hn::Sub(index_of(v, scale, shift_y, s.w), y_first);
            auto inside = hn::And(within(x, width), within(y, height));
            inside = hn::And(inside, is_shown(k, s));
            if (!run.all_columns) inside = hn::And(inside, in_columns(run, s.u));
            const VI to = hn::Add(hn::Mul(y, pitch), x);
            hn::Store(hn::IfThenElse(inside, to, missed), i, address[half] + at);
            drawn += count_first(inside, count - at);
          },
      [&](std::uint32_t from, std::uint32_t to, const ReliefSample* samples, std::uint32_t half)
          HWY_ATTR { copy_block(tile.texels, samples + from, address[half] + from, to - from); });
  return drawn;
}

// Splats of at most one texel, of at most four along an axis, or of any size. Texels whose centres
// lie in [left, right) x [top, bottom) of a splat are covered; two splats that share an edge
// compute the same number for it.
template <SplatReach reach>
std::size_t splat_run(const PrewarpCoefficients& k, const PrewarpRun& run,
                      const PrewarpTile& tile) {
  const F f;
  const I i;
  const std::uint32_t lanes = std::uint32_t(hn::Lanes(f));
  Found found;
  const VI lane = hn::Iota(i, 0), pitch = hn::Set(i, tile.pitch);
  const VI x_first = hn::Set(i, tile.x + kIndexBits);
  const VI x_last = hn::Set(i, tile.x + tile.width + kIndexBits);
  const VI y_first = hn::Set(i, tile.y + kIndexBits);
  const VI y_last = hn::Set(i, tile.y + tile.height + kIndexBits);
  const VF scale = hn::Set(f, k.scale);
  const VF low_x = hn::Set(f, 0.5f - run.half_x), high_x = hn::Set(f, 0.5f + run.half_x);
  const VF low_y = hn::Set(f, 0.5f - run.half_y), high_y = hn::Set(f, 0.5f + run.half_y);
  ReliefSample* const texels = tile.texels;
  std::size_t drawn = 0;
  for (std::uint32_t begin = 0; begin < run.count; begin += kBlock) {
    const std::uint32_t count = std::min(kBlock, run.count - begin);
    const ReliefSample* samples = run.samples + begin;
    found.count = 0;
    VI widest = hn::Zero(i), highest = hn::Zero(i);
    for (std::uint32_t at = 0; at < count; at += lanes) {
      const Lanes s = load(k, samples + at);
      const auto edge = [&](VF position, VF end, VF shift) {
        return index_of(hn::Add(position, end), scale, shift, s.w);
      };
      const VF v = hn::Add(hn::ConvertTo(f, s.v), hn::Set(f, run.v));
      const VF shift_y = hn::Add(hn::Mul(hn::Set(f, k.y_code), s.code), hn::Set(f, k.y_0));
      const VI y0 = hn::Max(edge(v, low_y, shift_y), y_first);
      const VI y1 = hn::Min(edge(v, high_y, shift_y), y_last);
      // Tiles are strips, and most of what misses one lies above or below it.
      auto covers = hn::And(hn::Gt(y1, y0), is_shown(k, s));
      if (hn::AllFalse(i, covers)) continue;
      const VF u = hn::Add(hn::ConvertTo(f, s.u), hn::Set(f, run.u));
      const VF shift_x = hn::Add(hn::Mul(hn::Set(f, k.x_code), s.code), hn::Set(f, k.x_0));
      const VI x0 = hn::Max(edge(u, low_x, shift_x), x_first);
      const VI x1 = hn::Min(edge(u, high_x, shift_x), x_last);
      covers = hn::And(covers, hn::Gt(x1, x0));
      if (!run.all_columns) covers = hn::And(covers, in_columns(run, s.u));
      if (count - at < lanes) covers = hn::And(covers, hn::FirstN(i, count - at));
      const VI to = hn::Add(hn::Mul(hn::Sub(y0, y_first), pitch), hn::Sub(x0, x_first));
      const auto keep = [&](VI value, std::int32_t* values) HWY_ATTR {
        hn::StoreU(hn::Compress(value, covers), i, values + found.count);
      };
      keep(to, found.address);
      keep(hn::Add(lane, hn::Set(i, std::int32_t(at))), found.which);
      if constexpr (reach != SplatReach::one) {
        const VI wide = hn::Sub(x1, x0), high = hn::Sub(y1, y0);
        if constexpr (reach == SplatReach::few) {
          widest = hn::Max(widest, hn::IfThenElseZero(covers, wide));
          highest = hn::Max(highest, hn::IfThenElseZero(covers, high));
          keep(columns_of(wide), found.wide);
        } else {
          keep(wide, found.wide);
        }
        keep(high, found.high);
      }
      found.count += hn::CountTrue(i, covers);
    }
    drawn += found.count;
    if constexpr (reach == SplatReach::one) {
      for (std::size_t n = 0; n < found.count; ++n)
        copy(texels + found.address[n], samples + found.which[n]);
    } else if constexpr (reach == SplatReach::few) {
      if (found.count > 0)
        copy_few(found, hn::GetLane(hn::MaxOfLanes(i, widest)),
                 hn::GetLane(hn::MaxOfLanes(i, highest)), tile, samples);
    } else {
      for (std::size_t n = 0; n < found.count; ++n) {
        ReliefSample* to = texels + found.address[n];
        for (int row = 0; row < found.high[n]; ++row, to += tile.pitch)
          for (int column = 0; column < found.wide[n]; ++column)
            copy(to + column, samples + found.which[n]);
      }
    }
  }
  return drawn;
}

std::size_t draw_tile(const PrewarpCoefficients& k, std::span<const PrewarpRun> runs,
                      const PrewarpTile& tile) {
  std::size_t drawn = 0;
  for (const PrewarpRun& run : runs) switch (run.reach) {
      case SplatReach::nearest:
        drawn += nearest_run(k, run, tile);
        break;
      case SplatReach::one:
        drawn += splat_run<SplatReach::one>(k, run, tile);
        break;
      case SplatReach::few:
        drawn += splat_run<SplatReach::few>(k, run, tile);
        break;
      case SplatReach::many:
        drawn += splat_run<SplatReach::many>(k, run, tile);
        break;
    }
  return drawn;
}

// Of one vector's worth of texels, which are emptied.
HWY_INLINE void resolve_lanes(const ResolveCoefficients& k, ReliefSample* from,
                              std::uint32_t* color, std::uint16_t* delta) {
  const F f;
  const I i;
  const U d;
  const hn::Rebind<std::uint16_t, I> half;
  auto* const words = reinterpret_cast<std::uint32_t*>(from);
  hn::Vec<U> place, colors;
  hn::LoadInterleaved2(d, words, place, colors);
  const auto code = hn::ShiftRight<16>(place);
  const auto empty = hn::Eq(code, hn::Set(d, kEmptyCode));
  if (hn::AllTrue(d, empty)) {
    hn::StoreU(hn::Zero(d), d, color);
    hn::StoreU(hn::Set(half, std::uint16_t(kEmptyCode)), half, delta);
    return;
  }
  const auto nothing = hn::Set(d, 0xffffffffu);
  hn::StoreU(nothing, d, words);
  hn::StoreU(nothing, d, words + hn::Lanes(d));
  const VF value = hn::ConvertTo(f, hn::BitCast(i, code));
  const VF from_near = hn::Add(hn::Mul(hn::Set(f, k.delta_code), value), hn::Set(f, k.delta_0));
  const VF z = hn::Add(hn::Mul(hn::Set(f, k.z_code), value), hn::Set(f, k.z_0));
  const VF exact = hn::Add(hn::Div(from_near, z), hn::Set(f, 0.5f));
  // Out of range only where rounding at the ends makes it so, or empty.
  const VF largest = hn::Set(f, float(kLargestCode));
  const VF clamped = hn::Min(hn::Max(exact, hn::Zero(f)), largest);
  const auto codes =
      hn::IfThenElse(empty, hn::Set(d, kEmptyCode), hn::BitCast(d, hn::ConvertTo(i, clamped)));
  hn::StoreU(hn::IfThenZeroElse(empty, colors), d, color);
  hn::StoreU(hn::DemoteTo(half, hn::BitCast(i, codes)), half, delta);
}

void resolve(const ResolveCoefficients& k, const PrewarpTile& tile, std::uint32_t* color,
             std::uint16_t* delta, std::size_t plane_pitch) {
  const int lanes = int(hn::Lanes(F()));
  for (int row = 0; row < tile.height; ++row) {
    ReliefSample* from = tile.texels + std::ptrdiff_t(row) * tile.pitch;
    std::uint32_t* to_color = color + std::size_t(row) * plane_pitch;
    std::uint16_t* to_delta = delta + std::size_t(row) * plane_pitch;
    int column = 0;
    for (; column + lanes <= tile.width; column += lanes)
      resolve_lanes(k, from + column, to_color + column, to_delta + column);
    if (column == tile.width) continue;
    // The rest by way of memory of our own: beyond it lies what others write. Rows of a tile are
    // followed by others, or by the one that nobody reads.
    ReliefSample texels[16];
    std::uint32_t colors[16];
    std::uint16_t deltas[16];
    const auto rest = std::size_t(tile.width - column);
    std::memset(static_cast<void*>(texels), 0xff, sizeof texels);
    std::memcpy(texels, from + column, rest * sizeof(ReliefSample));
    resolve_lanes(k, texels, colors, deltas);
    std::copy_n(colors, rest, to_color + column);
    std::copy_n(deltas, rest, to_delta + column);
    std::memset(static_cast<void*>(from + column), 0xff, rest * sizeof(ReliefSample));
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(draw_tile);
HWY_EXPORT(resolve);

std::size_t prewarp_tile(const PrewarpCoefficients& coefficients, std::span<const PrewarpRun> runs,
                         const PrewarpTile& tile) {
  return HWY_DYNAMIC_DISPATCH(draw_tile)(coefficients, runs, tile);
}

void resolve_tile(const ResolveCoefficients& coefficients, const PrewarpTile& tile,
                  std::uint32_t* color, std::uint16_t* delta, std::size_t plane_pitch) {
  HWY_DYNAMIC_DISPATCH(resolve)(coefficients, tile, color, delta, plane_pitch);
}

}  // namespace rilievo
#endif
