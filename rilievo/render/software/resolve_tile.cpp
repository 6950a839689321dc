// Four bytes are averaged two at a time: of each 32-bit pixel first bytes 0 and 2, then 1 and 3, in
// 16 bits each, which hold the sum of four bytes.
#include "rilievo/render/software/resolve_tile.h"

#include <algorithm>
#include <cstdint>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/render/software/resolve_tile.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using U = hn::CappedTag<std::uint32_t, 16>;

void average(const FrameTile& tile, int block, std::uint32_t* out) {
  const U u;
  const auto bytes = hn::Set(u, 0x00ff00ffu), half = hn::Set(u, 0x00020002u);
  for (std::size_t i = 0; i < FrameTile::kBlockPixels; i += hn::Lanes(u)) {
    const auto first = hn::Load(u, tile.first[block].content + i);
    auto even = hn::Add(half, hn::And(first, bytes));
    auto odd = hn::Add(half, hn::And(hn::ShiftRight<8>(first), bytes));
    for (const FrameTile::Plane& plane : tile.more[block]) {
      const auto c = hn::Load(u, plane.content + i);
      even = hn::Add(even, hn::And(c, bytes));
      odd = hn::Add(odd, hn::And(hn::ShiftRight<8>(c), bytes));
    }
    // Below 2^10 each: what is shifted into the lower one is masked away.
    const auto e = hn::And(hn::ShiftRight<2>(even), bytes),
               o = hn::And(hn::ShiftRight<2>(odd), bytes);
    hn::Store(hn::Or(e, hn::ShiftLeft<8>(o)), u, out + i);
  }
}

// Copies past the caches: the frame is larger than they are, and is not read while it is drawn.
// `to` must be a multiple of 16 bytes.
template <class T>
HWY_INLINE void copy_out(const T* from, T* to) {
  const hn::CappedTag<T, 4> d;
  for (std::size_t i = 0; i < FrameTile::kBlock; i += hn::Lanes(d))
    hn::Stream(hn::Load(d, from + i), d, to + i);
}

void resolve(FrameTile& tile, std::uint32_t* content, float* inverse_z, std::size_t stride) {
  constexpr int kBlock = FrameTile::kBlock, kBlocks = FrameTile::kBlocks;
  for (int i = 0; i < FrameTile::kBlockCount; ++i)
    if (tile.expanded[i]) average(tile, i, tile.first[i].content);
  const int columns = std::min(FrameTile::kSize, tile.width - tile.x);
  const int rows = std::min(FrameTile::kSize, tile.height - tile.y);
  const auto aligned = [](const void* p) { return reinterpret_cast<std::uintptr_t>(p) % 16 == 0; };
  const bool whole =
      columns % kBlock == 0 && stride % 4 == 0 && aligned(content) && aligned(inverse_z);
  // Row by row, so that whole lines of memory are written one after the other.
  for (int y = 0; y < rows; ++y) {
    const std::size_t to = std::size_t(tile.y + y) * stride + std::size_t(tile.x);
    const FrameTile::Plane* planes = tile.first + y / kBlock * kBlocks;
    const int first = y % kBlock * kBlock;
    for (int x = 0; x < columns; x += kBlock) {
      const FrameTile::Plane& plane = planes[x / kBlock];
      if (whole) {
        copy_out(plane.content + first, content + to + x);
      } else {
        std::copy_n(plane.content + first, std::min(kBlock, columns - x), content + to + x);
      }
    }
    for (int x = 0; x < columns; x += kBlock) {
      const FrameTile::Plane& plane = planes[x / kBlock];
      if (whole) {
        copy_out(plane.inverse_z + first, inverse_z + to + x);
      } else {
        std::copy_n(plane.inverse_z + first, std::min(kBlock, columns - x), inverse_z + to + x);
      }
    }
  }
  hwy::FlushStream();
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(resolve);

void resolve_tile(FrameTile& tile, std::uint32_t* content, float* inverse_z, std::size_t stride) {
  HWY_DYNAMIC_DISPATCH(resolve)(tile, content, inverse_z, stride);
}

}  // namespace rilievo
#endif
