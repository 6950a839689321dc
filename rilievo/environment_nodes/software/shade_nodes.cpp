// A block of 8 x 8 pixels at a time: what its samples show of each layer, which of that is nearest,
// then the colours of that alone. Merging is by whole bytes of colour, as with OpenGL, where layers
// are textures. No fused multiply-adds and no estimates: every instruction set gives the same
// bytes.
#include "rilievo/environment_nodes/software/shade_nodes.h"

#include <algorithm>
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

#include "rilievo/environment_nodes/software/node_texels.inl"

#include "rilievo/render/software/tile_kernels.inl"

// What one sample of each pixel of a block shows of a layer.
struct Shown {
  HWY_ALIGN float inverse_z[kPixels];  // of the frame; 0: nothing
  HWY_ALIGN std::uint32_t triangle[kPixels];
};

// The samples of a row of a block, as a visibility buffer has them.
template <int samples>
struct RowLoad {
  const float* depth;
  const std::uint32_t* triangle;
  // At the right edge of the frame: a copy, with nothing beyond it.
  HWY_ALIGN float depths[kBlock * samples];
  HWY_ALIGN std::uint32_t triangles[kBlock * samples];

  RowLoad(const SampleBuffer& from, int x, int row) {
    depth = from.depths(row) + std::size_t(x) * samples;
    triangle = from.triangles(row) + std::size_t(x) * samples;
    if (x + kBlock <= from.width) return;
    std::fill_n(depths, kBlock * samples, 1.0f);
    std::fill_n(triangles, kBlock * samples, 0u);
    std::copy_n(depth, (from.width - x) * samples, depths);
    std::copy_n(triangle, (from.width - x) * samples, triangles);
    depth = depths, triangle = triangles;
  }
  // Of the pixels from `i` on.
  HWY_INLINE void load(int i, VF (&z)[samples], VU (&t)[samples]) const {
    const F f;
    const U u32;
    if constexpr (samples == 1) {
      z[0] = hn::LoadU(f, depth + i), t[0] = hn::LoadU(u32, triangle + i);
    } else {
      hn::LoadInterleaved4(f, depth + 4 * i, z[0], z[1], z[2], z[3]);
      hn::LoadInterleaved4(u32, triangle + 4 * i, t[0], t[1], t[2], t[3]);
    }
  }
};

// What all samples of a block show of a layer. Returns the nearest one's 1 / eye_z, 0 for nothing.
// Of merged nodes skins lie behind all surfaces.
template <int samples, bool merged = false>
float find_shown(const NodeLayer& layer, double scale, const FrameTile& tile, int x, int y,
                 Shown (&out)[samples]) {
  const F f;
  const U u32;
  const VF sky = hn::Set(f, NodeLayer::kSkyDepth), one = hn::Set(f, 1.0f), zero = hn::Zero(f);
  const VF per_depth = hn::Set(f, float(1 / (layer.nearest() * scale)));
  // What is infinitely far is not nothing; what lies beyond the far plane is drawn there.
  const VF something = hn::Set(f, 1e-30f), least = hn::Set(f, tile.nothing * kBeforeFar);
  const std::array<NodeLayer::Seen, 3> parts = layer.seen();
  VF nearest = zero;
  for (int row = 0; row < kBlock; ++row) {
    const int first = row * kBlock;
    for (int i = 0; i < kBlock; i += int(hn::Lanes(f)))
      for (Shown& s : out) {
        hn::Store(zero, f, s.inverse_z + first + i);
        hn::Store(hn::Zero(u32), u32, s.triangle + first + i);
      }
    if (y + row >= tile.height) continue;
    for (const NodeLayer::Seen& part : parts) {
      if (!part.samples) continue;
      const RowLoad<samples> from(*part.samples, x, tile.height - 1 - (y + row));
      for (int i = 0; i < kBlock; i += int(hn::Lanes(f))) {
        VF depth[samples];
        VU triangle[samples];
        from.load(i, depth, triangle);
        for (int s = 0; s < samples; ++s) {
          const VF z = hn::Max(hn::Mul(hn::Sub(sky, depth[s]), per_depth), something);
          const VF before = hn::Load(f, out[s].inverse_z + first + i);
          MF seen = hn::And(hn::Lt(depth[s], one), hn::Ge(z, before));
          if (merged && part.first > 0) {
            const MF surface =
                hn::And(hn::Gt(before, zero),
                        hn::RebindMask(f, hn::Lt(hn::Load(u32, out[s].triangle + first + i),
                                                 hn::Set(u32, layer.first_skin()))));
            seen = hn::AndNot(surface, seen);
          }
          hn::Store(hn::IfThenElse(seen, z, before), f, out[s].inverse_z + first + i);
          hn::Store(hn::IfThenElse(hn::RebindMask(u32, seen),
                                   hn::Add(triangle[s], hn::Set(u32, part.first)),
                                   hn::Load(u32, out[s].triangle + first + i)),
                    u32, out[s].triangle + first + i);
        }
      }
    }
    for (int i = 0; i < kBlock; i += int(hn::Lanes(f)))
      for (Shown& s : out) {
        VF z = hn::Load(f, s.inverse_z + first + i);
        z = hn::IfThenElseZero(hn::Gt(z, zero), hn::Max(z, least));
        hn::Store(z, f, s.inverse_z + first + i);
        nearest = hn::Max(nearest, z);
      }
  }
  return hn::GetLane(hn::MaxOfLanes(f, nearest));
}

// The centres of a block's pixels from the i-th on.
HWY_INLINE VF center_x(int x, int i) {
  const F f;
  return hn::Add(hn::Iota(f, 0), hn::Set(f, float(x + i % kBlock) + 0.5f));
}
HWY_INLINE VF center_y(int y, int i) { return hn::Set(F(), float(y + i / kBlock) + 0.5f); }

// Are the triangles skins?
HWY_INLINE MF are_skins(const NodeLayer& layer, VU triangle) {
  const I i32;
  const VI first = hn::Set(i32, std::int32_t(layer.first_skin()));
  return hn::RebindMask(F(), hn::Not(hn::Lt(hn::BitCast(i32, triangle), first)));
}

// Where node `k` sees points of the frame's eye space.
HWY_INLINE Directions seen_by(const PlacedNodes& placed, std::size_t k, VF x, VF y, VF z) {
  const F f;
  const glm::mat4& m = placed.node_from_eye[k];
  const auto axis = [&](int row) {
    const auto column = [&](int c) { return hn::Set(f, m[c][row]); };
    return hn::Add(hn::Add(hn::Mul(column(0), x), hn::Mul(column(1), y)),
                   hn::Add(hn::Mul(column(2), z), column(3)));
  };
  return {axis(0), axis(1), axis(2)};
}
HWY_INLINE VF ahead_of(const Directions& seen) {
  return hn::Max(hn::Abs(seen.x), hn::Max(hn::Abs(seen.y), hn::Abs(seen.z)));
}

// The four texels around what pixels show of a surface, of which those alone count that lie about
// as deep: the others show what is beside a silhouette.
struct SurfaceTexels {
  MF beside;     // a silhouette
  VI color[4];   // where, in the node's colours
  VI object[4];  // in its identifiers and disparities
  VF weight[4];  // 0: of another surface
};

// Beside silhouettes, where the least weight of colours is 0, what pixels show of surfaces of a
// layer's node; `k` is its number among all. See gl/node_shaders.cpp.
HWY_INLINE SurfaceTexels find_surface_texels(const PlacedNodes& placed, const NodeLayer& layer,
                                             const SoftwareNode& node, std::size_t k, VU triangle,
                                             MF wanted, VF px, VF py, VF inverse_z, float nothing,
                                             VF least_weight) {
  const F f;
  const I i32;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  SurfaceTexels out;
  out.beside = hn::And(wanted, hn::AndNot(are_skins(layer, triangle), hn::Eq(least_weight, zero)));
  if (hn::AllFalse(f, out.beside)) return out;
  const glm::vec4& rays = placed.rays;
  const VF ahead = hn::Div(
      one, hn::Max(hn::Mul(inverse_z, hn::Set(f, float(placed.scale))), hn::Set(f, 1e-30f)));
  const VF x = hn::Mul(hn::Add(hn::Set(f, rays.x), hn::Mul(hn::Set(f, rays.z), px)), ahead);
  const VF y = hn::Mul(hn::Add(hn::Set(f, rays.y), hn::Mul(hn::Set(f, rays.w), py)), ahead);
  VF own =
      hn::Div(one, hn::Max(ahead_of(seen_by(placed, k, x, y, hn::Neg(ahead))), hn::Set(f, 1e-9f)));
  own = hn::IfThenZeroElse(hn::Le(inverse_z, hn::Set(f, nothing * (2 * kBeforeFar - 1))), own);

  const FacePoints at = find_face_points(
      find_directions(layer.triangles().data(), triangle, out.beside, px, py), out.beside);
  const int face = node.mesh.face_size, wide = node.wide();
  const VF size = hn::Set(f, float(face)), half = hn::Set(f, 0.5f);
  const VF u = hn::Add(hn::Mul(at.u, size), half), v = hn::Add(hn::Mul(at.v, size), half);
  const VI left = hn::ConvertTo(i32, limited(u, size)), top = hn::ConvertTo(i32, limited(v, size));
  const VF fx = limited(hn::Sub(u, hn::ConvertTo(f, left)), one),
           fy = limited(hn::Sub(v, hn::ConvertTo(f, top)), one);
  const VI last = hn::Set(i32, face - 1), none = hn::Zero(i32);
  VF off[4];
  VF least = hn::Set(f, 1e30f);
  for (int c = 0; c < 4; ++c) {
    const VI column = hn::Add(left, hn::Set(i32, c & 1)), row = hn::Add(top, hn::Set(i32, c >> 1));
    const VI first =
        hn::Mul(hn::Add(hn::Mul(at.face, hn::Set(i32, wide)), row), hn::Set(i32, wide));
    out.color[c] = hn::Add(first, column);
    // Disparities and identifiers have no border.
    const auto inside = [&](VI index) {
      return hn::Min(hn::Max(hn::Sub(index, hn::Set(i32, 1)), none), last);
    };
    const VI of_row =
        hn::Mul(hn::Add(hn::Mul(at.face, hn::Set(i32, face)), inside(row)), hn::Set(i32, face));
    out.object[c] = hn::Add(of_row, inside(column));
    const VF disparity = hn::GatherIndex(f, node.disparity.data(), out.object[c]);
    out.weight[c] = hn::Max(hn::Mul(c & 1 ? fx : hn::Sub(one, fx), c >> 1 ? fy : hn::Sub(one, fy)),
                            hn::Set(f, 1e-3f));
    off[c] = hn::Abs(hn::Sub(disparity, own));
    least = hn::Min(least, off[c]);
  }
  const VF most = hn::Add(least, hn::Mul(hn::Set(f, placed.options.tolerance), own));
  for (int c = 0; c < 4; ++c)
    out.weight[c] = hn::IfThenElseZero(hn::Le(off[c], most), out.weight[c]);
  return out;
}

// Beside silhouettes surfaces keep their own colours.
HWY_INLINE void keep_colors(const SoftwareNode& node, const SurfaceTexels& of, Colors& colors) {
  const F f;
  const I i32;
  const U u32;
  if (hn::AllFalse(f, of.beside)) return;
  VU texel[4];
  VF sum = hn::Zero(f);
  for (int c = 0; c < 4; ++c) {
    texel[c] = hn::GatherIndex(u32, node.color.data(), of.color[c]);
    sum = hn::Add(sum, of.weight[c]);
  }
  const auto mean = [&]<int shift>(VF& channel) {
    VF total = hn::Zero(f);
    for (int c = 0; c < 4; ++c) {
      const VF value = hn::ConvertTo(
          f, hn::BitCast(i32, hn::And(hn::ShiftRight<shift>(texel[c]), hn::Set(u32, 0xffu))));
      total = hn::Add(total, hn::Mul(of.weight[c], value));
    }
    channel = hn::IfThenElse(of.beside, hn::Div(total, sum), channel);
  };
  mean.template operator()<0>(colors.r);
  mean.template operator()<8>(colors.g);
  mean.template operator()<16>(colors.b);
}

// Beside silhouettes surfaces have the identifier of the nearest of their own texels.
HWY_INLINE VU keep_object(const SoftwareNode& node, const SurfaceTexels& of, VU object) {
  const F f;
  const U u32;
  if (hn::AllFalse(f, of.beside)) return object;
  VF most = hn::Zero(f);
  for (int c = 0; c < 4; ++c) {
    const MF nearer = hn::And(of.beside, hn::Gt(of.weight[c], most));
    most = hn::IfThenElse(nearer, of.weight[c], most);
    object = hn::IfThenElse(hn::RebindMask(u32, nearer),
                            hn::GatherIndex(u32, node.object.data(), of.object[c]), object);
  }
  return object;
}

// What a layer's nodes, which are numbers `first`, first + 1, ... among all, show at depths
// 1 / inverse_z: colours or identifiers, as the tile holds. `colors`: shade<true>()'s.
HWY_INLINE VU keep_to_surfaces(const PlacedNodes& placed, const NodeLayer& layer,
                               const FrameTile& tile, std::size_t first, VU triangle, MF wanted,
                               VF px, VF py, VF inverse_z, Colors& colors) {
  const U u32;
  const bool of_objects = tile.of != TileContent::color && placed.object == kNoObject;
  VU object = of_objects ? find_content(placed, layer, tile.of, triangle, wanted, px, py)
                         : hn::Set(u32, placed.object);
  std::size_t n = 0;
  for_nodes(layer, triangle, wanted, [&](const SoftwareNode& node, MF its) {
    while (layer.drawn(n).node != &node) ++n;
    if (tile.of != TileContent::color && (!of_objects || node.object.empty())) return;
    const SurfaceTexels texels = find_surface_texels(placed, layer, node, first + n, triangle, its,
                                                     px, py, inverse_z, tile.nothing, colors.least);
    if (of_objects)
      object = keep_object(node, texels, object);
    else
      keep_colors(node, texels, colors);
  });
  return object;
}

// What a tile holds of one layer's triangles, of which all nodes are, at depths 1 / inverse_z.
HWY_INLINE VU find_unmixed(const PlacedNodes& placed, const NodeLayer& layer, const FrameTile& tile,
                           VU triangle, MF wanted, VF px, VF py, VF inverse_z) {
  if (!placed.unmixes) return find_content(placed, layer, tile.of, triangle, wanted, px, py);
  Colors colors = shade<true>(layer, triangle, wanted, px, py);
  const VU object =
      keep_to_surfaces(placed, layer, tile, 0, triangle, wanted, px, py, inverse_z, colors);
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
        content = find_unmixed(placed, layer, tile, triangle, seen, px, py, own);
      } else if (!known) {
        first_content = content = find_unmixed(placed, layer, tile, first, of_first, px, py,
                                               hn::Load(f, shown[0].inverse_z + i));
        known = true;
      }
      put(f, plane, i, seen, z, content);
      tile.changed[block] = true;
    }
  }
}

// What pixels show of the layers: the share of each in the colour, and 1 / eye_z (0: nothing).
struct Merged {
  VF share[kMaxDrawnNodes];
  VF inverse_z;
};

// The layers that pixels may show, before they are weighed.
struct Candidates {
  VF z[kMaxDrawnNodes], share[kMaxDrawnNodes];
  MF counts[kMaxDrawnNodes];
  MF only_skins;
  VF nearest;  // 1 / eye_z; 0: nothing
};

// What node `k` leaves of what lies at points of the frame's eye space: see gl/node_shaders.cpp.
HWY_INLINE VF find_share(const PlacedNodes& placed, std::size_t k, VF x, VF y, VF z, MF wanted) {
  const F f;
  const I i32;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  const Directions seen = seen_by(placed, k, x, y, z);
  const VF ahead = ahead_of(seen);
  const FacePoints at = find_face_points(seen, wanted);
  const SoftwareNode& node = *placed.layers[k].drawn(0).node;
  const int size = node.mesh.face_size;
  const VF scale = hn::Set(f, float(size)), half = hn::Set(f, 0.5f),
           most = hn::Set(f, float(size - 1));
  const auto texels = [&](VF share, VI(&out)[2]) {
    const VF low = limited(hn::Sub(hn::Mul(share, scale), half), most);
    out[0] = hn::ConvertTo(i32, low);
    out[1] = hn::Min(hn::Add(out[0], hn::Set(i32, 1)), hn::Set(i32, size - 1));
  };
  VI u[2], v[2];
  texels(at.u, u), texels(at.v, v);
  VF nearest = hn::Set(f, kNothing);
  for (const VI row : v) {
    const VI first =
        hn::Mul(hn::Add(hn::Mul(at.face, hn::Set(i32, size)), row), hn::Set(i32, size));
    for (const VI column : u)
      nearest = hn::Max(nearest, hn::GatherIndex(f, node.disparity.data(), hn::Add(first, column)));
  }
  const VF farther =
      hn::Sub(hn::Div(one, hn::Max(hn::Mul(nearest, ahead), hn::Set(f, 1e-9f))), one);
  const VF two = hn::Set(f, 2.0f);
  const VF share =
      hn::Sub(two, hn::Div(hn::Mul(two, farther), hn::Set(f, placed.options.tolerance)));
  return hn::IfThenElse(hn::Lt(nearest, zero), one, hn::Min(hn::Max(share, zero), one));
}

// Where surfaces do not agree: their shares, and the nearest that is left.
HWY_INLINE void settle(const PlacedNodes& placed, const MF (&surface)[kMaxDrawnNodes], VF px, VF py,
                       float nothing, MF differ, Candidates& out) {
  const F f;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  const glm::vec4& rays = placed.rays;
  const VF x = hn::Add(hn::Set(f, rays.x), hn::Mul(hn::Set(f, rays.z), px));
  const VF y = hn::Add(hn::Set(f, rays.y), hn::Mul(hn::Set(f, rays.w), py));
  const VF sky = hn::Set(f, nothing / 0.999f);
  VF accepted = zero;
  for (std::size_t k = 0; k < placed.count; ++k) {
    const MF wanted = hn::And(differ, surface[k]);
    if (hn::AllFalse(f, wanted)) continue;
    const VF ahead = hn::Div(
        one, hn::Max(hn::Mul(out.z[k], hn::Set(f, float(placed.scale))), hn::Set(f, 1e-30f)));
    const MF near = hn::And(wanted, hn::Gt(out.z[k], sky));
    for (std::size_t j = 0; j < placed.count; ++j) {
      if (k == 0 || j == k || hn::AllFalse(f, near)) continue;
      const VF share =
          find_share(placed, j, hn::Mul(x, ahead), hn::Mul(y, ahead), hn::Neg(ahead), near);
      out.share[k] = hn::IfThenElse(near, hn::Min(out.share[k], share), out.share[k]);
    }
    const MF left = hn::And(wanted, hn::Ge(out.share[k], hn::Set(f, 0.5f)));
    accepted = hn::IfThenElse(left, hn::Max(accepted, out.z[k]), accepted);
  }
  const MF some = hn::And(differ, hn::Gt(accepted, zero));
  out.nearest = hn::IfThenElse(some, accepted, out.nearest);
  for (std::size_t k = 0; k < placed.count; ++k)
    out.share[k] = hn::IfThenElse(hn::AndNot(some, differ), one, out.share[k]);
}

// See gl/node_shaders.cpp.
HWY_INLINE void find_candidates(const PlacedNodes& placed, const Shown (&shown)[kMaxDrawnNodes][1],
                                int i, VF px, VF py, float nothing, Candidates& out) {
  const F f;
  const U u32;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f), tiny = hn::Set(f, 1e-30f);
  MF surface[kMaxDrawnNodes];
  VF nearest = zero, nearest_skin = zero, farthest = hn::Set(f, 1e30f);
  for (std::size_t k = 0; k < placed.count; ++k) {
    out.z[k] = hn::Load(f, shown[k][0].inverse_z + i);
    out.share[k] = one;
    const MF skin = are_skins(placed.layers[k], hn::Load(u32, shown[k][0].triangle + i));
    surface[k] = hn::AndNot(skin, hn::Gt(out.z[k], zero));
    nearest = hn::IfThenElse(skin, nearest, hn::Max(nearest, out.z[k]));
    farthest = hn::IfThenElse(surface[k], hn::Min(farthest, out.z[k]), farthest);
    nearest_skin = hn::IfThenElse(skin, hn::Max(nearest_skin, out.z[k]), nearest_skin);
  }
  out.only_skins = hn::Eq(nearest, zero);
  out.nearest = hn::IfThenElse(out.only_skins, nearest_skin, nearest);
  const MF differ =
      hn::And(hn::Gt(nearest, zero),
              hn::Gt(nearest, hn::Mul(farthest, hn::Set(f, 1 + 0.5f * placed.options.tolerance))));
  if (!hn::AllFalse(f, differ)) settle(placed, surface, px, py, nothing, differ, out);
  const VF limit = hn::Div(hn::Set(f, 1 + placed.options.tolerance), hn::Max(out.nearest, tiny));
  for (std::size_t k = 0; k < placed.count; ++k) {
    const MF skin =
        hn::And(out.only_skins, hn::And(hn::Gt(out.z[k], zero), hn::Eq(out.z[k], nearest_skin)));
    const MF near = hn::And(surface[k], hn::Le(hn::Div(one, hn::Max(out.z[k], tiny)), limit));
    out.counts[k] = hn::Or(skin, near);
  }
}

// `weights`: of the texels that layers show, 0 to 255.
HWY_INLINE void merge(const PlacedNodes& placed, const Candidates& from,
                      const VF (&weights)[kMaxDrawnNodes], Merged& out) {
  const F f;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  const bool binary = placed.options.merge == NodeMerge::binary;
  VF most = hn::Set(f, -1.0f), sum = zero;
  out.inverse_z = from.nearest;
  for (std::size_t k = 0; k < placed.count; ++k) {
    out.share[k] = zero;
    const MF counts = from.counts[k];
    if (hn::AllFalse(f, counts)) continue;
    // In the steps that a byte of alpha has above a skin's.
    const VF steps =
        hn::Floor(hn::Add(hn::Mul(weights[k], hn::Set(f, 253.0f / 255.0f)), hn::Set(f, 0.5f)));
    VF weight = hn::IfThenElse(from.only_skins, one,
                               hn::Mul(from.share[k], hn::Add(steps, hn::Set(f, 0.25f))));
    if (placed.options.merge == NodeMerge::positional)
      weight = hn::Mul(weight, hn::Set(f, placed.nearness[k]));
    const MF best = hn::And(counts, hn::Gt(weight, most));
    most = hn::IfThenElse(best, weight, most);
    out.inverse_z = hn::IfThenElse(best, from.z[k], out.inverse_z);
    if (binary)
      for (std::size_t before = 0; before < k; ++before)
        out.share[before] = hn::IfThenZeroElse(best, out.share[before]);
    out.share[k] = binary ? hn::IfThenElseZero(best, one) : hn::IfThenElseZero(counts, weight);
    sum = hn::Add(sum, hn::IfThenElseZero(counts, weight));
  }
  if (binary) return;
  sum = hn::Max(sum, hn::Set(f, 1e-20f));
  for (std::size_t k = 0; k < placed.count; ++k) out.share[k] = hn::Div(out.share[k], sum);
}

// Others only in the gaps of the first.
HWY_INLINE void merge_first(const PlacedNodes& placed, const Shown (&shown)[kMaxDrawnNodes][1],
                            int i, Merged& out) {
  const F f;
  const U u32;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  const auto skin = [&](std::size_t k) {
    return are_skins(placed.layers[k], hn::Load(u32, shown[k][0].triangle + i));
  };
  const VF first = hn::Load(f, shown[0][0].inverse_z + i),
           others = hn::Load(f, shown[1][0].inverse_z + i);
  const MF gap = hn::Or(hn::Eq(first, zero), skin(0));
  const MF fills = hn::Or(hn::Not(skin(1)), hn::Gt(others, first));
  const MF second = hn::And(gap, hn::And(hn::Gt(others, zero), fills));
  out.inverse_z = hn::IfThenElse(second, others, first);
  out.share[0] = hn::IfThenZeroElse(second, one);
  out.share[1] = hn::IfThenElseZero(second, one);
}

// Draws merged layers over what the block shows.
void draw_merged(const PlacedNodes& placed, FrameTile& tile, int block, int x, int y) {
  const F f;
  const U u32;
  Shown shown[kMaxDrawnNodes][1];
  float nearest = 0;
  for (std::size_t k = 0; k < placed.count; ++k)
    nearest = std::max(nearest,
                       find_shown<1, true>(placed.layers[k], placed.scale, tile, x, y, shown[k]));
  if (nearest == 0 || nearest <= tile.farthest[block]) return;
  const bool first_alone = placed.options.merge == NodeMerge::first;
  const int planes = tile.planes(block);
  const VF zero = hn::Zero(f), half = hn::Set(f, 0.5f);
  for (int i = 0; i < kPixels; i += int(hn::Lanes(f))) {
    VF farthest = hn::Load(f, tile.first[block].inverse_z + i);
    for (int s = 1; s < planes; ++s)
      farthest = hn::Min(farthest, hn::Load(f, tile.plane(block, s).inverse_z + i));
    const VF px = center_x(x, i), py = center_y(y, i);
    Merged merged;
    Colors colors[kMaxDrawnNodes];
    VU objects[kMaxDrawnNodes];
    const auto shade_layer = [&](std::size_t k, MF wanted, VF inverse_z) {
      colors[k] = Colors{zero, zero, zero, zero, zero};
      objects[k] = hn::Zero(u32);
      if (hn::AllFalse(f, wanted)) return;
      const VU triangle = hn::Load(u32, shown[k][0].triangle + i);
      colors[k] = shade<true>(placed.layers[k], triangle, wanted, px, py);
      objects[k] = keep_to_surfaces(placed, placed.layers[k], tile, k, triangle, wanted, px, py,
                                    inverse_z, colors[k]);
    };
    MF seen;
    if (first_alone) {
      merge_first(placed, shown, i, merged);
      seen = hn::Gt(merged.inverse_z, farthest);
      if (hn::AllFalse(f, seen)) continue;
      for (std::size_t k = 0; k < placed.count; ++k)
        shade_layer(k, hn::And(seen, hn::Gt(merged.share[k], zero)), merged.inverse_z);
    } else {
      Candidates candidates;
      find_candidates(placed, shown, i, px, py, tile.nothing, candidates);
      seen = hn::Gt(candidates.nearest, farthest);
      if (hn::AllFalse(f, seen)) continue;
      VF weights[kMaxDrawnNodes];
      for (std::size_t k = 0; k < placed.count; ++k) {
        const MF counts = hn::And(seen, candidates.counts[k]);
        shade_layer(k, counts, candidates.z[k]);
        weights[k] = colors[k].weight;
      }
      merge(placed, candidates, weights, merged);
      seen = hn::Gt(merged.inverse_z, farthest);
    }
    Colors sum{zero, zero, zero, zero, zero};
    // The identifier of the layer that shows most of the colour.
    VF most = zero;
    VU object = hn::Zero(u32);
    for (std::size_t k = 0; k < placed.count; ++k) {
      const MF has_share = hn::And(seen, hn::Gt(merged.share[k], zero));
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
    const VU content = tile.of == TileContent::color ? bytes_of(sum) : object;
    for (int s = 0; s < planes; ++s) {
      FrameTile::Plane& plane = tile.plane(block, s);
      const VF before = hn::Load(f, plane.inverse_z + i);
      const MF nearer = hn::Gt(merged.inverse_z, before);
      put(f, plane, i, nearer, merged.inverse_z, content);
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
