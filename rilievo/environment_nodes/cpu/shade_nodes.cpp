// A block of 8 x 8 pixels at a time: what its samples show of each layer, which of that is nearest,
// then the colours of that alone. Merging is by whole bytes of colour, as with OpenGL, where layers
// are textures. No fused multiply-adds and no estimates: every instruction set gives the same
// bytes.
#include "rilievo/environment_nodes/cpu/shade_nodes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "rilievo/core/expects.h"
#include "rilievo/environment_nodes/cube_grid.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/environment_nodes/cpu/shade_nodes.cpp"
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
template <int samples>
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
          const MF seen = hn::And(hn::Lt(depth[s], one), hn::Ge(z, before));
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

// Where the fields of the wanted triangles lie from those of the first one, in words.
HWY_INLINE VI index_of(VU triangle, MF wanted) {
  const U u32;
  constexpr std::uint32_t kWords = sizeof(NodeTriangle) / sizeof(std::uint32_t);
  const VU of = hn::IfThenElseZero(hn::RebindMask(u32, wanted), triangle);
  return hn::BitCast(I(), hn::Mul(of, hn::Set(u32, kWords)));
}

// Directions in node space.
struct Directions {
  VF x, y, z;
};

// Where triangles have their colours at pixels' centres.
HWY_INLINE Directions find_directions(const NodeTriangle* triangles, VU number, MF wanted, VF x,
                                      VF y) {
  const F f;
  const U u32;
  const auto along = [&](VF at, VF per_x, VF per_y, VF dx, VF dy) {
    return hn::Add(at, hn::Add(hn::Mul(dx, per_x), hn::Mul(dy, per_y)));
  };
  const VU one = hn::Set(u32, hn::ExtractLane(number, hn::FindKnownFirstTrue(f, wanted)));
  if (hn::AllFalse(f, hn::AndNot(hn::RebindMask(f, hn::Eq(number, one)), wanted))) {
    const NodeTriangle& t = triangles[hn::GetLane(one)];
    const VF dx = hn::Sub(x, hn::Set(f, t.x)), dy = hn::Sub(y, hn::Set(f, t.y));
    const auto axis = [&](int k) {
      return along(hn::Set(f, t.at[k]), hn::Set(f, t.per_x[k]), hn::Set(f, t.per_y[k]), dx, dy);
    };
    return {axis(0), axis(1), axis(2)};
  }
  const VI index = index_of(number, wanted);
  const auto field = [&](const float& of_first) { return hn::GatherIndex(f, &of_first, index); };
  const NodeTriangle& first = triangles[0];
  const VF dx = hn::Sub(x, field(first.x)), dy = hn::Sub(y, field(first.y));
  const auto axis = [&](int k) {
    return along(field(first.at[k]), field(first.per_x[k]), field(first.per_y[k]), dx, dy);
  };
  return {axis(0), axis(1), axis(2)};
}

// Where directions meet a cube's faces: u to the right and v downwards, each from 0 to 1.
struct FacePoints {
  VI face;
  VF u, v;
};

HWY_INLINE FacePoints find_face_points(const Directions& d, MF wanted) {
  const F f;
  const I i32;
  const VF ax = hn::Abs(d.x), ay = hn::Abs(d.y), az = hn::Abs(d.z), zero = hn::Zero(f);
  const MF is_x = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az));
  const MF is_y = hn::AndNot(is_x, hn::Ge(ay, az));
  const VF depth = hn::IfThenElse(is_x, ax, hn::IfThenElse(is_y, ay, az));
  FacePoints points{hn::Zero(i32), zero, zero};
  VF right = zero, up = zero;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const MF on_axis = axis == 0 ? is_x : axis == 1 ? is_y : hn::Not(hn::Or(is_x, is_y));
    const VF along = axis == 0 ? d.x : axis == 1 ? d.y : d.z;
    const MF on_face = hn::And(on_axis, face % 2 ? hn::Lt(along, zero) : hn::Ge(along, zero));
    if (hn::AllFalse(f, hn::And(on_face, wanted))) continue;
    const FaceAxes& axes = face_axes()[std::size_t(face)];
    const auto part = [&](const glm::ivec3& of) {
      return hn::Add(
          hn::Add(hn::Mul(hn::Set(f, float(of.x)), d.x), hn::Mul(hn::Set(f, float(of.y)), d.y)),
          hn::Mul(hn::Set(f, float(of.z)), d.z));
    };
    right = hn::IfThenElse(on_face, part(axes.right), right);
    up = hn::IfThenElse(on_face, part(axes.up), up);
    points.face = hn::IfThenElse(hn::RebindMask(i32, on_face), hn::Set(i32, face), points.face);
  }
  const VF half = hn::Set(f, 0.5f);
  points.u = hn::Add(half, hn::Div(hn::Mul(half, right), depth));
  points.v = hn::Sub(half, hn::Div(hn::Mul(half, up), depth));
  return points;
}

// Between 0 and `most`; 0 for what is no number.
HWY_INLINE VF limited(VF value, VF most) {
  const F f;
  value = hn::IfThenElseZero(hn::Gt(value, hn::Zero(f)), value);
  return hn::Min(value, most);
}

// sRGB-encoded, 0 to 255.
struct Colors {
  VF r, g, b;
};

// The colours of a node between four texels.
HWY_INLINE Colors find_colors(const MemoryNode& node, const FacePoints& at) {
  const F f;
  const I i32;
  const U u32;
  const int wide = node.wide();
  const VF size = hn::Set(f, float(node.mesh.face_size)), half = hn::Set(f, 0.5f),
           one = hn::Set(f, 1.0f);
  const VF u = hn::Add(hn::Mul(at.u, size), half), v = hn::Add(hn::Mul(at.v, size), half);
  const VI x = hn::ConvertTo(i32, limited(u, size)), y = hn::ConvertTo(i32, limited(v, size));
  const VF fx = limited(hn::Sub(u, hn::ConvertTo(f, x)), one),
           fy = limited(hn::Sub(v, hn::ConvertTo(f, y)), one);
  const VI row = hn::Add(hn::Mul(at.face, hn::Set(i32, wide)), y);
  const VI index = hn::Add(hn::Mul(row, hn::Set(i32, wide)), x);
  const std::uint32_t* texels = node.color.data();
  const VU t00 = hn::GatherIndex(u32, texels, index), t10 = hn::GatherIndex(u32, texels + 1, index),
           t01 = hn::GatherIndex(u32, texels + wide, index),
           t11 = hn::GatherIndex(u32, texels + wide + 1, index);
  const auto mix = [](VF a, VF b, VF by) { return hn::Add(a, hn::Mul(by, hn::Sub(b, a))); };
  const auto channel = [&]<int shift>() {
    const auto of = [&](VU texel) {
      return hn::ConvertTo(
          f, hn::BitCast(i32, hn::And(hn::ShiftRight<shift>(texel), hn::Set(u32, 0xffu))));
    };
    return mix(mix(of(t00), of(t10), fx), mix(of(t01), of(t11), fx), fy);
  };
  return {channel.template operator()<0>(), channel.template operator()<8>(),
          channel.template operator()<16>()};
}

// The identifiers of a node's nearest texels.
HWY_INLINE VU find_objects(const MemoryNode& node, const FacePoints& at) {
  const F f;
  const I i32;
  const U u32;
  const int size = node.mesh.face_size;
  const VF scale = hn::Set(f, float(size)), most = hn::Set(f, float(size - 1));
  const auto texel = [&](VF share) {
    return hn::ConvertTo(i32, limited(hn::Mul(share, scale), most));
  };
  const VI row = hn::Add(hn::Mul(at.face, hn::Set(i32, size)), texel(at.v));
  return hn::GatherIndex(u32, node.object.data(),
                         hn::Add(hn::Mul(row, hn::Set(i32, size)), texel(at.u)));
}

// Calls visit(node, mask) for each node of which a wanted lane shows a triangle.
template <class Visit>
HWY_INLINE void for_nodes(const NodeLayer& layer, VU triangle, MF wanted, const Visit& visit) {
  const F f;
  if (layer.nodes() == 1) {
    visit(*layer.drawn(0).node, wanted);
    return;
  }
  const U u32;
  const VU of = hn::GatherIndex(u32, &layer.triangles()[0].node, index_of(triangle, wanted));
  for (std::size_t n = 0; n < layer.nodes(); ++n) {
    const MF its = hn::And(wanted, hn::RebindMask(f, hn::Eq(of, hn::Set(u32, std::uint32_t(n)))));
    if (!hn::AllFalse(f, its)) visit(*layer.drawn(n).node, its);
  }
}

// The colours of the wanted lanes' triangles, at least one, at pixels' centres.
HWY_INLINE Colors shade(const NodeLayer& layer, VU triangle, MF wanted, VF x, VF y) {
  const F f;
  const Directions directions = find_directions(layer.triangles().data(), triangle, wanted, x, y);
  const FacePoints points = find_face_points(directions, wanted);
  Colors colors{hn::Zero(f), hn::Zero(f), hn::Zero(f)};
  for_nodes(layer, triangle, wanted, [&](const MemoryNode& node, MF its) {
    const Colors found = find_colors(node, points);
    colors.r = hn::IfThenElse(its, found.r, colors.r);
    colors.g = hn::IfThenElse(its, found.g, colors.g);
    colors.b = hn::IfThenElse(its, found.b, colors.b);
  });
  return colors;
}

HWY_INLINE VU bytes_of(const Colors& colors) {
  const F f;
  const I i32;
  const U u32;
  const auto byte = [&](VF value) {
    return hn::BitCast(
        u32, hn::ConvertTo(i32, hn::Add(limited(value, hn::Set(f, 255.0f)), hn::Set(f, 0.5f))));
  };
  return hn::Or(hn::Or(hn::Set(u32, 0xff000000u), byte(colors.r)),
                hn::Or(hn::ShiftLeft<8>(byte(colors.g)), hn::ShiftLeft<16>(byte(colors.b))));
}

// What a tile holds of the wanted lanes' triangles.
HWY_INLINE VU find_content(const PlacedNodes& placed, const NodeLayer& layer, TileContent of,
                           VU triangle, MF wanted, VF x, VF y) {
  const U u32;
  if (of == TileContent::color) return bytes_of(shade(layer, triangle, wanted, x, y));
  if (placed.object != kNoObject) return hn::Set(u32, placed.object);
  const FacePoints points =
      find_face_points(find_directions(layer.triangles().data(), triangle, wanted, x, y), wanted);
  VU content = hn::Set(u32, 1u);
  for_nodes(layer, triangle, wanted, [&](const MemoryNode& node, MF its) {
    if (!node.object.empty())
      content = hn::IfThenElse(hn::RebindMask(u32, its), find_objects(node, points), content);
  });
  return content;
}

// The centres of a block's pixels from the i-th on.
HWY_INLINE VF center_x(int x, int i) {
  const F f;
  return hn::Add(hn::Iota(f, 0), hn::Set(f, float(x + i % kBlock) + 0.5f));
}
HWY_INLINE VF center_y(int y, int i) { return hn::Set(F(), float(y + i / kBlock) + 0.5f); }

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
        content = find_content(placed, layer, tile.of, triangle, seen, px, py);
      } else if (!known) {
        first_content = content = find_content(placed, layer, tile.of, first, of_first, px, py);
        known = true;
      }
      hn::Store(hn::IfThenElse(seen, z, before), f, plane.inverse_z + i);
      hn::Store(
          hn::IfThenElse(hn::RebindMask(u32, seen), content, hn::Load(u32, plane.content + i)), u32,
          plane.content + i);
      tile.changed[block] = true;
    }
  }
}

// Are the triangles skins?
HWY_INLINE MF are_skins(const NodeLayer& layer, VU triangle) {
  const I i32;
  const VI first = hn::Set(i32, std::int32_t(layer.first_skin()));
  return hn::RebindMask(F(), hn::Not(hn::Lt(hn::BitCast(i32, triangle), first)));
}

// What pixels show of the layers: the share of each in the colour, and 1 / eye_z (0: nothing).
struct Merged {
  VF share[kMaxDrawnNodes];
  VF inverse_z;
};

// The nearest surface, and what lies within the tolerance of it: see gl/node_shaders.cpp.
HWY_INLINE void merge(const PlacedNodes& placed, const Shown (&shown)[kMaxDrawnNodes][1], int i,
                      Merged& out) {
  const F f;
  const U u32;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  VF z[kMaxDrawnNodes];
  MF skin[kMaxDrawnNodes];
  VF nearest = zero, nearest_skin = zero;
  for (std::size_t k = 0; k < placed.count; ++k) {
    z[k] = hn::Load(f, shown[k][0].inverse_z + i);
    skin[k] = are_skins(placed.layers[k], hn::Load(u32, shown[k][0].triangle + i));
    nearest = hn::IfThenElse(skin[k], nearest, hn::Max(nearest, z[k]));
    nearest_skin = hn::IfThenElse(skin[k], hn::Max(nearest_skin, z[k]), nearest_skin);
  }
  const MF only_skins = hn::Eq(nearest, zero);
  nearest = hn::IfThenElse(only_skins, nearest_skin, nearest);
  const VF limit =
      hn::Div(hn::Set(f, 1 + placed.options.tolerance), hn::Max(nearest, hn::Set(f, 1e-30f)));
  const bool binary = placed.options.merge == NodeMerge::binary;
  VF most = hn::Set(f, -1.0f), sum = zero;
  out.inverse_z = nearest;
  for (std::size_t k = 0; k < placed.count; ++k) {
    MF counts = hn::And(hn::Gt(z[k], zero), hn::Not(hn::Xor(skin[k], only_skins)));
    counts = hn::And(counts, hn::Le(hn::Div(one, hn::Max(z[k], hn::Set(f, 1e-30f))), limit));
    out.share[k] = zero;
    if (hn::AllFalse(f, counts)) continue;
    const VU triangle = hn::Load(u32, shown[k][0].triangle + i);
    const VF quality =
        hn::GatherIndex(f, &placed.layers[k].triangles()[0].quality, index_of(triangle, counts));
    VF weight = hn::IfThenElse(only_skins, one, hn::Add(quality, hn::Set(f, 0.25f)));
    if (placed.options.merge == NodeMerge::positional)
      weight = hn::Mul(weight, hn::Set(f, placed.nearness[k]));
    const MF best = hn::And(counts, hn::Gt(weight, most));
    most = hn::IfThenElse(best, weight, most);
    out.inverse_z = hn::IfThenElse(best, z[k], out.inverse_z);
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
    nearest =
        std::max(nearest, find_shown<1>(placed.layers[k], placed.scale, tile, x, y, shown[k]));
  if (nearest == 0 || nearest <= tile.farthest[block]) return;
  const int planes = tile.planes(block);
  const VF zero = hn::Zero(f), half = hn::Set(f, 0.5f);
  for (int i = 0; i < kPixels; i += int(hn::Lanes(f))) {
    Merged merged;
    if (placed.options.merge == NodeMerge::first)
      merge_first(placed, shown, i, merged);
    else
      merge(placed, shown, i, merged);
    VF farthest = hn::Load(f, tile.first[block].inverse_z + i);
    for (int s = 1; s < planes; ++s)
      farthest = hn::Min(farthest, hn::Load(f, tile.plane(block, s).inverse_z + i));
    const MF seen = hn::Gt(merged.inverse_z, farthest);
    if (hn::AllFalse(f, seen)) continue;
    const VF px = center_x(x, i), py = center_y(y, i);
    Colors sum{zero, zero, zero};
    for (std::size_t k = 0; k < placed.count; ++k) {
      const MF has_share = hn::And(seen, hn::Gt(merged.share[k], zero));
      if (hn::AllFalse(f, has_share)) continue;
      const Colors colors =
          shade(placed.layers[k], hn::Load(u32, shown[k][0].triangle + i), has_share, px, py);
      const auto add = [&](VF& to, VF value) {
        value = hn::Mul(merged.share[k], hn::Floor(hn::Add(value, half)));
        to = hn::Add(to, hn::IfThenElseZero(has_share, value));
      };
      add(sum.r, colors.r), add(sum.g, colors.g), add(sum.b, colors.b);
    }
    const VU content = bytes_of(sum);
    for (int s = 0; s < planes; ++s) {
      FrameTile::Plane& plane = tile.plane(block, s);
      const VF before = hn::Load(f, plane.inverse_z + i);
      const MF nearer = hn::Gt(merged.inverse_z, before);
      hn::Store(hn::IfThenElse(nearer, merged.inverse_z, before), f, plane.inverse_z + i);
      hn::Store(
          hn::IfThenElse(hn::RebindMask(u32, nearer), content, hn::Load(u32, plane.content + i)),
          u32, plane.content + i);
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
    for (std::size_t k = 0; k < placed.count; ++k)
      if (tile.samples == 4)
        draw_over<4>(placed, placed.layers[k], tile, block, x, y);
      else
        draw_over<1>(placed, placed.layers[k], tile, block, x, y);
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
