// A block of 8 x 8 pixels at a time: what its samples show of each layer, which of that is nearest,
// then the colours of that alone. Merging is by whole bytes of colour, as with OpenGL, where layers
// are textures. No fused multiply-adds and no estimates: every instruction set gives the same
// bytes.
#include "rilievo/environment_nodes/software/shade_nodes.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "rilievo/core/expects.h"
#include "rilievo/environment_nodes/cube_grid.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/environment_nodes/software/shade_nodes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

// A vector is a row of a block, or half of one.
using F = hn::CappedTag<float, FrameTile::kBlock>;
using U = hn::RebindToUnsigned<F>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;
using VU = hn::Vec<U>;
using VI = hn::Vec<I>;
using MF = hn::Mask<F>;

constexpr int kBlock = FrameTile::kBlock, kPixels = FrameTile::kBlockPixels;
// Just before the far plane: what is drawn there covers nothing's 1 / eye_z.
constexpr float kBeforeFar = 1 + 0x1p-20f;

#include "rilievo/core/load_records.inl"

#include "rilievo/environment_nodes/software/node_texels.inl"

#include "rilievo/render/software/tile_kernels.inl"

#include "rilievo/environment_nodes/software/visible_samples.inl"

#include "rilievo/environment_nodes/software/surface_texels.inl"

#include "rilievo/environment_nodes/software/merge_layers.inl"

// The content, as the tile holds it, of pixels of the only layer, which has all nodes.
HWY_INLINE VU find_unmixed(const PlacedNodes& placed, const NodeLayer& layer, const FrameTile& tile,
                           const LayerPixels& at) {
  if (!placed.unmixes)
    return find_content(placed, layer, tile.of, at.triangle, at.wanted, at.points);
  Colors colors = shade<true>(layer, at.triangle, at.wanted, at.points);
  const VU object = keep_to_surfaces(placed, layer, tile, 0, at, colors);
  return tile.of == TileContent::color ? bytes_of(colors) : object;
}

// Draws a layer over what the block shows.
template <int samples>
void draw_over(const PlacedNodes& placed, const NodeLayer& layer, FrameTile& tile, int block, int x,
               int y) {
  const F f;
  const U u32;
  Shown shown[samples];
  const float nearest = find_shown<samples>(layer, placed.scale, tile, x, y, shown);
  if (nearest == 0 || nearest < tile.farthest[block]) return;
  const int lanes = int(hn::Lanes(f));
  const VF zero = hn::Zero(f);
  for (int i = 0; samples > 1 && !tile.expanded[block] && i < kPixels; i += lanes) {
    const VU first = hn::Load(u32, shown[0].triangle + i);
    const MF any = hn::Gt(hn::Load(f, shown[0].inverse_z + i), zero);
    MF differ = hn::Lt(zero, zero);
    for (int s = 1; s < samples; ++s) {
      const MF also = hn::Gt(hn::Load(f, shown[s].inverse_z + i), zero);
      const VU triangle = hn::Load(u32, shown[s].triangle + i);
      differ =
          hn::Or(differ, hn::Or(hn::Xor(any, also), hn::RebindMask(f, hn::Ne(triangle, first))));
    }
    if (!hn::AllFalse(f, differ)) tile.expand(block);
  }
  const int planes = tile.samples == 4 ? tile.planes(block) : 1;
  for (int i = 0; i < kPixels; i += lanes) {
    const VF px = center_x(x, i), py = center_y(y, i);
    const VU first = hn::Load(u32, shown[0].triangle + i);
    const MF of_first = hn::Gt(hn::Load(f, shown[0].inverse_z + i), zero);
    VU first_content = hn::Zero(u32);  // once it is known
    bool known = false;
    for (int s = 0; s < planes; ++s) {
      FrameTile::Plane& plane = tile.plane(block, s);
      const VF z = hn::Load(f, shown[s].inverse_z + i), before = hn::Load(f, plane.inverse_z + i);
      const MF seen = hn::And(hn::Gt(z, zero), hn::Ge(z, before));
      if (hn::AllFalse(f, seen)) continue;
      const VU triangle = hn::Load(u32, shown[s].triangle + i);
      const MF other = hn::Or(hn::RebindMask(f, hn::Ne(triangle, first)), hn::Not(of_first));
      VU content = first_content;
      if (!hn::AllFalse(f, hn::And(seen, other))) {
        // A triangle has one depth in a pixel, whichever pixels lie beside it in a vector.
        const VF own = hn::IfThenElse(other, z, hn::Load(f, shown[0].inverse_z + i));
        const TexelPoints points = find_points(layer, triangle, seen, px, py);
        content = find_unmixed(placed, layer, tile, {triangle, seen, px, py, own, points});
      } else if (!known) {
        const VF own = hn::Load(f, shown[0].inverse_z + i);
        const TexelPoints points = find_points(layer, first, of_first, px, py);
        first_content = content =
            find_unmixed(placed, layer, tile, {first, of_first, px, py, own, points});
        known = true;
      }
      put(f, plane, i, seen, z, content);
      tile.changed[block] = true;
    }
  }
}

// What pixels show of merged layers, where it is nearer than `farthest`.
struct MergedPixels {
  MF seen;
  VF inverse_z;
  VU content;
};

// Of the pixels from the i-th on, at (px, py), of the first `count` layers. False: of none.
HWY_INLINE bool merge_pixels(const PlacedNodes& placed, std::size_t count, const FrameTile& tile,
                             const Shown (&shown)[kMaxDrawnNodes][1], int i, VF px, VF py,
                             VF farthest, MergedPixels& out) {
  const F f;
  const U u32;
  const VF zero = hn::Zero(f), half = hn::Set(f, 0.5f);
  Merged merged;
  Colors colors[kMaxDrawnNodes];
  VU objects[kMaxDrawnNodes];
  const auto shade_layer = [&](std::size_t k, MF wanted, VF inverse_z) {
    colors[k] = Colors{zero, zero, zero, zero, zero};
    objects[k] = hn::Zero(u32);
    if (hn::AllFalse(f, wanted)) return;
    const VU triangle = hn::Load(u32, shown[k][0].triangle + i);
    const TexelPoints points = find_points(placed.layers[k], triangle, wanted, px, py);
    colors[k] = shade<true>(placed.layers[k], triangle, wanted, points);
    objects[k] = keep_to_surfaces(placed, placed.layers[k], tile, k,
                                  {triangle, wanted, px, py, inverse_z, points}, colors[k]);
  };
  if (placed.options.merge == NodeMerge::first) {
    merge_first(placed, shown, i, merged);
    out.seen = hn::Gt(merged.inverse_z, farthest);
    if (hn::AllFalse(f, out.seen)) return false;
    for (std::size_t k = 0; k < count; ++k)
      shade_layer(k, hn::And(out.seen, hn::Gt(merged.share[k], zero)), merged.inverse_z);
  } else {
    Candidates candidates;
    find_candidates(placed, count, shown, i, px, py, tile.nothing, candidates);
    out.seen = hn::Gt(candidates.nearest, farthest);
    if (hn::AllFalse(f, out.seen)) return false;
    VF weights[kMaxDrawnNodes];
    for (std::size_t k = 0; k < count; ++k) {
      const MF counts = hn::And(out.seen, candidates.counts[k]);
      shade_layer(k, counts, candidates.z[k]);
      weights[k] = colors[k].weight;
    }
    merge(placed, count, candidates, weights, merged);
    out.seen = hn::Gt(merged.inverse_z, farthest);
  }
  Colors sum{zero, zero, zero, zero, zero};
  // The identifier of the layer that shows most of the colour.
  VF most = zero;
  VU object = hn::Zero(u32);
  for (std::size_t k = 0; k < count; ++k) {
    const MF has_share = hn::And(out.seen, hn::Gt(merged.share[k], zero));
    if (hn::AllFalse(f, has_share)) continue;
    const MF more = hn::And(has_share, hn::Gt(merged.share[k], most));
    most = hn::IfThenElse(more, merged.share[k], most);
    object = hn::IfThenElse(hn::RebindMask(u32, more), objects[k], object);
    const auto add = [&](VF& to, VF value) {
      value = hn::Mul(merged.share[k], hn::Floor(hn::Add(value, half)));
      to = hn::Add(to, hn::IfThenElseZero(has_share, value));
    };
    add(sum.r, colors[k].r), add(sum.g, colors[k].g), add(sum.b, colors[k].b);
  }
  out.inverse_z = merged.inverse_z;
  out.content = tile.of == TileContent::color ? bytes_of(sum) : object;
  return true;
}

#include "rilievo/environment_nodes/software/edge_samples.inl"

// Draws merged layers over what the block shows.
void draw_merged(const PlacedNodes& placed, FrameTile& tile, int block, int x, int y) {
  const F f;
  const U u32;
  Shown shown[kMaxDrawnNodes][1];
  const bool with_skins = placed.skins_in.holds(x, y);
  float nearest = 0;
  // The last layer may be left out.
  const std::size_t count = placed.count - (placed.layers[placed.count - 1].reaches(x, y) ? 0 : 1);
  for (std::size_t k = 0; k < count; ++k)
    nearest = std::max(nearest, find_shown<1, true>(placed.layers[k], placed.scale, tile, x, y,
                                                    shown[k], with_skins));
  EdgeSamples edges;
  const std::uint64_t marked = placed.antialiased ? placed.edges.word(x, y) : 0;
  if (marked != 0) {
    tile.expand(block);
    find_edge_samples(placed, count, tile, x, y, marked, shown, edges);
    draw_edge_samples(placed, count, tile, block, edges);
  }
  if (nearest == 0 || nearest <= tile.farthest[block]) return;
  const int planes = tile.planes(block);
  for (int i = 0; i < kPixels; i += int(hn::Lanes(f))) {
    VF farthest = hn::Load(f, tile.first[block].inverse_z + i);
    for (int s = 1; s < planes; ++s)
      farthest = hn::Min(farthest, hn::Load(f, tile.plane(block, s).inverse_z + i));
    MergedPixels merged;
    if (!merge_pixels(placed, count, tile, shown, i, center_x(x, i), center_y(y, i), farthest,
                      merged))
      continue;
    for (int s = 0; s < planes; ++s) {
      FrameTile::Plane& plane = tile.plane(block, s);
      MF nearer = hn::Gt(merged.inverse_z, hn::Load(f, plane.inverse_z + i));
      if (marked != 0) {
        const VU own = hn::Load(u32, edges.own[s] + i);
        nearer = hn::AndNot(hn::RebindMask(f, hn::Ne(own, hn::Zero(u32))), nearer);
      }
      put(f, plane, i, nearer, merged.inverse_z, merged.content);
    }
    tile.changed[block] = true;
  }
}

void shade_tile(const PlacedNodes& placed, FrameTile& tile) {
  for (int block = 0; block < FrameTile::kBlockCount; ++block) {
    const int x = tile.x + block % FrameTile::kBlocks * kBlock,
              y = tile.y + block / FrameTile::kBlocks * kBlock;
    if (x >= tile.width || y >= tile.height) continue;
    if (placed.merged) {
      draw_merged(placed, tile, block, x, y);
      continue;
    }
    if (tile.samples == 4)
      draw_over<4>(placed, placed.layers[0], tile, block, x, y);
    else
      draw_over<1>(placed, placed.layers[0], tile, block, x, y);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(shade_tile);

void shade_nodes(const PlacedNodes& placed, FrameTile& tile) {
  RILIEVO_EXPECTS(placed.merged || placed.layers[0].samples() == tile.samples);
  HWY_DYNAMIC_DISPATCH(shade_tile)(placed, tile);
}

}  // namespace rilievo
#endif
