// A row of a block at a time. The quad's edges are straight: what holds at a block's corners holds
// between them, and most blocks lie within a quad.
#include "rilievo/layered_impostor/software/slice_blocks.h"

#include <algorithm>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/layered_impostor/software/slice_blocks.cpp"
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
using MF = hn::Mask<F>;

constexpr int kBlock = FrameTile::kBlock;

#include "rilievo/render/software/tile_kernels.inl"

double at(const glm::dvec3& affine, double x, double y) {
  return affine.x * x + affine.y * y + affine.z;
}

// How far a place lies within the quad's edges, all of them times w, and beyond the near plane;
// >= 0: it does.
double within(const PlacedSlice& placed, double x, double y) {
  const double w = at(placed.w, x, y), u = at(placed.u, x, y), v = at(placed.v, x, y);
  return std::min({w, placed.most_w - w, u - double(placed.texels.x) * w,
                   double(placed.texels.z) * w - u, v - double(placed.texels.y) * w,
                   double(placed.texels.w) * w - v});
}

// A value that is affine in the pixel, from a block's corner on.
struct Plane {
  float corner, per_x, per_y;

  Plane(const glm::dvec3& affine, double x, double y)
      : corner(float(at(affine, x, y))), per_x(float(affine.x)), per_y(float(affine.y)) {}
  HWY_INLINE VF operator()(VF x, float y) const {
    const F f;
    return hn::Add(hn::Set(f, corner + y * per_y), hn::Mul(x, hn::Set(f, per_x)));
  }
};

// A slice in a block.
class SliceBlock {
 public:
  SliceBlock(const PlacedSlice& placed, FrameTile& tile, int block)
      : placed_(placed),
        tile_(tile),
        block_(block),
        left_(tile.x + block % FrameTile::kBlocks * kBlock),
        top_(tile.y + block / FrameTile::kBlocks * kBlock),
        u_(placed.u, left_, top_),
        v_(placed.v, left_, top_),
        w_(placed.w, left_, top_) {}

  void draw() {
    const int x0 = std::max(left_, placed_.x0), x1 = std::min(left_ + kBlock, placed_.x1),
              y0 = std::max(top_, placed_.y0), y1 = std::min(top_ + kBlock, placed_.y1);
    if (x0 >= x1 || y0 >= y1) return;
    const glm::dvec3& w = placed_.w;
    const double most = std::max({at(w, x0, y0), at(w, x1, y0), at(w, x0, y1), at(w, x1, y1)});
    if (float(most * placed_.inverse_scale) <= farthest(tile_, block_)) return;
    inside_ = std::min({within(placed_, x0, y0), within(placed_, x1, y0), within(placed_, x0, y1),
                        within(placed_, x1, y1)}) >= 0;
    // Before anything is written: the same whatever the number of lanes.
    if (!inside_ && tile_.samples > 1 && !tile_.expanded[block_]) {
      bool cut = false;
      for_rows(x0, y0, x1, y1, [&](int y, int, VF x, MF in) {
        const Found found = find(y, x, in);
        cut = cut || !hn::AllFalse(F(), hn::AndNot(found.all_covered, found.shown));
      });
      if (cut) tile_.expand(block_);
    }
    for_rows(x0, y0, x1, y1, [&](int y, int first, VF x, MF in) {
      const Found found = find(y, x, in);
      if (!hn::AllFalse(F(), found.shown)) write(y, first, x, found);
    });
  }

 private:
  // Which places does the quad cover?
  HWY_INLINE MF covers(VF x, float y) const {
    const F f;
    const VF zero = hn::Zero(f), u = u_(x, y), v = v_(x, y), w = w_(x, y);
    const auto edge = [&](float texel) { return hn::Mul(hn::Set(f, texel), w); };
    const glm::vec4& texels = placed_.texels;
    const MF near = hn::And(hn::Ge(w, zero), hn::Le(w, hn::Set(f, float(placed_.most_w))));
    const MF across = hn::And(hn::Ge(u, edge(texels.x)), hn::Le(u, edge(texels.z)));
    return hn::And(near,
                   hn::And(across, hn::And(hn::Ge(v, edge(texels.y)), hn::Le(v, edge(texels.w)))));
  }

  // Calls visit(y, first, x, in) for the vectors of a rectangle of the block's pixels, from (first,
  // y) on: their left edges, and which of them lie in it.
  template <class Visit>
  HWY_INLINE void for_rows(int x0, int y0, int x1, int y1, const Visit& visit) const {
    const F f;
    for (int y = y0; y < y1; ++y)
      for (int i = 0; i < kBlock; i += int(hn::Lanes(f))) {
        const VF x = hn::Add(hn::Iota(f, 0), hn::Set(f, float(i)));
        const MF in = hn::And(hn::Ge(x, hn::Set(f, float(x0 - left_))),
                              hn::Lt(x, hn::Set(f, float(x1 - left_))));
        if (!hn::AllFalse(f, in)) visit(y - top_, i, x, in);
      }
  }

  // What some pixels show.
  struct Found {
    MF shown;                    // on the quad, with a texel of the slice
    MF covered[4], all_covered;  // samples; not if the block lies within the quad
    VF w;                        // at the centre
    VI texel;
  };
  // Of pixels that are `in`, with left edges at x.
  HWY_INLINE Found find(int y, VF x, MF in) const {
    const F f;
    const I i32;
    const U u32;
    const int samples = tile_.samples;
    const VF half = hn::Set(f, 0.5f), middle = hn::Add(x, half);
    const float center_y = float(y) + 0.5f;
    Found found;
    found.shown = found.all_covered = in;
    found.w = w_(middle, center_y), found.texel = hn::Zero(i32);
    if (!inside_) {
      found.shown = hn::Lt(half, half);
      for (int s = 0; s < samples; ++s) {
        const float sx = samples == 1 ? 0.5f : FrameTile::kSampleX[s],
                    sy = samples == 1 ? 0.5f : FrameTile::kSampleY[s];
        found.covered[s] = hn::And(in, covers(hn::Add(x, hn::Set(f, sx)), float(y) + sy));
        found.shown = hn::Or(found.shown, found.covered[s]);
        found.all_covered = hn::And(found.all_covered, found.covered[s]);
      }
      if (hn::AllFalse(f, found.shown)) return found;
    }
    // The texel at a pixel's centre. Beyond the quad's edge as well: a fragment has the centre's
    // texel even if only other samples lie on the quad.
    const VF z = hn::Div(hn::Set(f, 1.0f), found.w);
    const VF u = hn::Mul(u_(middle, center_y), z), v = hn::Mul(v_(middle, center_y), z);
    const SlicedPicture& picture = *placed_.picture;
    const VF before = hn::Set(f, -1.0f);
    const auto on_picture = [&](VF at, int size) {
      return hn::And(hn::Gt(at, before), hn::Lt(at, hn::Set(f, float(size))));
    };
    found.shown = hn::And(found.shown, hn::And(on_picture(u, picture.codes.width()),
                                               on_picture(v, picture.codes.height())));
    if (hn::AllFalse(f, found.shown)) return found;
    const VI column = hn::ConvertTo(i32, hn::IfThenElseZero(found.shown, u)),
             row = hn::ConvertTo(i32, hn::IfThenElseZero(found.shown, v));
    found.texel = hn::Add(hn::Mul(row, hn::Set(i32, picture.codes.width())), column);
    const VU code = hn::GatherIndex(u32, picture.codes.texels().data(), found.texel);
    const VI front = hn::BitCast(i32, hn::And(code, hn::Set(u32, 0xffffu))),
             back = hn::BitCast(i32, hn::ShiftRight<16>(code));
    const auto shows = hn::And(hn::Lt(front, hn::Set(i32, placed_.back)),
                               hn::Gt(back, hn::Set(i32, placed_.front - 1)));
    found.shown = hn::And(found.shown, hn::RebindMask(f, shows));
    if (placed_.from > 0 || placed_.to < 1) {
      const VF hash = pixel_hash(f, tile_, left_, top_, middle, hn::Set(f, center_y));
      found.shown = hn::And(found.shown, hn::And(hn::Ge(hash, hn::Set(f, placed_.from)),
                                                 hn::Lt(hash, hn::Set(f, placed_.to))));
    }
    return found;
  }

  // Samples that are covered, and not hidden.
  HWY_INLINE void write(int y, int first, VF x, const Found& found) {
    const F f;
    const U u32;
    const SlicedPicture& picture = *placed_.picture;
    const VU content = tile_.of == TileContent::color
                           ? hn::GatherIndex(u32, picture.color.texels().data(), found.texel)
                       : picture.object.empty()
                           ? hn::Set(u32, placed_.object)
                           : hn::GatherIndex(u32, picture.object.texels().data(), found.texel);
    const int planes = tile_.planes(block_), pixel = y * kBlock + first;
    const VF inverse_scale = hn::Set(f, float(placed_.inverse_scale));
    for (int s = 0; s < planes; ++s) {
      const VF w = planes == 1 ? found.w
                               : w_(hn::Add(x, hn::Set(f, FrameTile::kSampleX[s])),
                                    float(y) + FrameTile::kSampleY[s]);
      const VF inverse_z = hn::Mul(w, inverse_scale);
      FrameTile::Plane& plane = tile_.plane(block_, s);
      const VF before = hn::Load(f, plane.inverse_z + pixel);
      MF nearer = hn::And(found.shown, hn::Gt(inverse_z, before));
      if (planes > 1 && !inside_) nearer = hn::And(nearer, found.covered[s]);
      if (hn::AllFalse(f, nearer)) continue;
      put(f, plane, pixel, nearer, inverse_z, content);
      tile_.changed[block_] = true;
    }
  }

  const PlacedSlice& placed_;
  FrameTile& tile_;
  int block_, left_, top_;
  Plane u_, v_, w_;
  bool inside_ = false;  // the quad covers all pixels of the block that it can
};

void draw(const PlacedSlice& placed, FrameTile& tile) {
  const int from_x = std::max(placed.x0 - tile.x, 0) / kBlock,
            from_y = std::max(placed.y0 - tile.y, 0) / kBlock,
            to_x = std::min(placed.x1 - tile.x, FrameTile::kSize),
            to_y = std::min(placed.y1 - tile.y, FrameTile::kSize);
  for (int y = from_y; y * kBlock < to_y; ++y)
    for (int x = from_x; x * kBlock < to_x; ++x)
      SliceBlock(placed, tile, y * FrameTile::kBlocks + x).draw();
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(draw);

void draw_slice(const PlacedSlice& placed, FrameTile& tile) {
  HWY_DYNAMIC_DISPATCH(draw)(placed, tile);
}

}  // namespace rilievo
#endif
