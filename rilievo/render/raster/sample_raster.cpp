// Cf. [Pineda 1988, A Parallel Algorithm for Polygon Rasterization] on edge functions.
//
// Two steps, in rounds of a few thousand triangles: each triangle is projected, and left out where
// it cannot be seen (SIMD over triangles); then what is left is rasterised (SIMD over samples), by
// strips of rows that share nothing.
//
// Two triangles that share an edge compute the same number for it at each sample: the edge always
// runs from its smaller to its larger end. So no sample between them is missed or taken twice.
#include "rilievo/render/raster/sample_raster.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/shading/surface.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/render/raster/sample_raster.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

#include "rilievo/render/shading/simd_numbers.inl"
// A template over these numbers.
#include "rilievo/render/shading/shading_model.inl"

using Triangles = SampleRaster::Triangles;
using U = hn::RebindToUnsigned<F>;
using Mask = hn::Mask<F>;

constexpr std::uint32_t kMaxLanes = SampleRaster::kMaxLanes;

#include "rilievo/core/lane_numbers.inl"
#include "rilievo/render/raster/triangle_setup.inl"
// With what that has.
#include "rilievo/render/raster/stroke_setup.inl"

// Where the samples of a vector lie, from the left edge of its first texel on.
struct Pattern {
  float x[kMaxLanes], y[kMaxLanes];
};

// Vectors that hold a texel's samples, where a vector is too short for all of them.
constexpr int kMaxParts = 4;

Pattern make_pattern(int part, const SampleBuffer& of, int lanes) {
  const int samples = of.samples;
  Pattern pattern;
  for (int k = 0; k < lanes; ++k) {
    const int sample = part * lanes + k;
    glm::vec2 p = sample_position(sample % samples, samples);
    // Of vectors with an even number of texels. See height_in_row().
    if (of.staggered) p.y = staggered_position(sample, 0).y;
    pattern.x[k] = float(sample / samples) + p.x, pattern.y[k] = p.y;
  }
  return pattern;
}

constexpr bool kOneLane = hn::MaxLanes(F()) == 1;

// The height of a staggered sample over its row, where a vector has one texel.
[[maybe_unused]] float height_in_row(int column) { return staggered_position(column, 0).y; }

// How far to the right of the pattern the samples of a row lie.
float beside_pattern(const SampleBuffer& of, int row) {
  return of.staggered ? staggered_position(0, row).x - 0.5f : 0.0f;
}

struct Edge {
  vfloat x, y, along_x, along_y;  // from its smaller end to its larger one
  Mask turned;                    // the triangle runs along it the other way
};

Edge make_edge(float ax, float ay, float bx, float by) {
  const F f;
  const bool turned = bx < ax || (bx == ax && by < ay);
  if (turned) std::swap(ax, bx), std::swap(ay, by);
  return {ax, ay, bx - ax, by - ay, hn::FirstN(f, turned ? hn::Lanes(f) : 0)};
}

// Are masked stores cheaper than a branch that is mispredicted every few times? With AVX-512 they
// are; with AVX2 they take tens of cycles on AMD.
constexpr bool kMaskedStores = HWY_TARGET <= HWY_AVX3;

// Stores what the mask keeps.
template <class D>
HWY_INLINE void store_masked(hn::Vec<D> v, hn::Mask<D> keep, D d, hn::TFromD<D>* to) {
  if constexpr (kMaskedStores)
    hn::BlendedStore(v, keep, d, to);
  else
    hn::StoreU(hn::IfThenElse(keep, v, hn::LoadU(d, to)), d, to);
}

// Between which places of a row can a triangle cover samples? The bounds of one that is long and
// oblique are mostly empty.
struct RowSpan {
  // Of each edge: a line that no sample of the triangle lies beyond, as the edge's signs are
  // rounded, and the side on which the triangle is: -1 left of it, 1 right, 0 either.
  float x[3], y[3], x_per_y[3], slack[3], side[3];

  // Corners are counter-clockwise, rows at most `rows`.
  void set(const float (&corner_x)[3], const float (&corner_y)[3], float rows) {
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const float along_x = corner_x[next] - corner_x[k], along_y = corner_y[next] - corner_y[k];
      x[k] = corner_x[k], y[k] = corner_y[k];
      side[k] = along_y > 0 ? -1.0f : along_y < 0 ? 1.0f : 0.0f;
      x_per_y[k] = along_y != 0 ? along_x / along_y : 0;
      // Ten times what single precision rounds.
      slack[k] = 1 + 1e-6f * (std::max(std::abs(x[k]), std::abs(corner_x[next])) +
                              std::abs(x_per_y[k]) *
                                  (std::max(std::abs(y[k]), std::abs(corner_y[next])) + rows));
    }
  }

  // Makes it narrower where the triangle does not reach; not finite places leave it as it is.
  HWY_INLINE void cut(int row, float& left, float& right) const {
    for (int k = 0; k < 3; ++k) {
      const float low = x[k] + x_per_y[k] * (float(row) - y[k]), high = low + x_per_y[k];
      if (side[k] < 0) right = std::min(right, std::max(low, high) + slack[k]);
      if (side[k] > 0) left = std::max(left, std::min(low, high) - slack[k]);
    }
  }
};

// A triangle with holes, ready to be asked for its alpha at samples: attributes over w and 1 / w
// are affine over the raster, and so are the edges, each of which weighs the corner opposite.
struct MaskedTriangle {
  const RasterMask* mask;
  float x[3], y[3], per_w[3], alpha[3];
  glm::vec2 uv[3];
};

MaskedTriangle masked_triangle(const Triangles& in, std::uint32_t t,
                               const RasterInstance& instance) {
  const auto get = [&](int field) { return in.field[field][t]; };
  const RasterMask& mask = *instance.mask;
  const std::uint32_t* at = instance.indices + 3 * std::size_t(in.index[t]);
  const bool exchanged = get(Triangles::exchanged) > 0;
  MaskedTriangle out;
  out.mask = &mask;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t vertex = at[exchanged && k > 0 ? 3 - k : k];
    out.x[k] = get(Triangles::x0 + 2 * k), out.y[k] = get(Triangles::y0 + 2 * k);
    out.per_w[k] = get(Triangles::per_w0 + k);
    out.alpha[k] = mask.colors ? mask.alpha * mask.colors[vertex].a : mask.alpha;
    out.uv[k] = mask.uv ? mask.uv[vertex] : glm::vec2(0.0f);
  }
  return out;
}

// Which of the samples at (x, y) are no holes?
Mask alpha_passes(const MaskedTriangle& t, vfloat x, vfloat y) {
  Weights<vfloat> w;
  vfloat sum = 0.0f, sum_per_x = 0.0f, sum_per_y = 0.0f;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const float along_x = t.x[j] - t.x[i], along_y = t.y[j] - t.y[i];
    const vfloat per_w = t.per_w[k];
    w.at[k] = per_w * max(along_x * (y - t.y[i]) - along_y * (x - t.x[i]), 0.0f);
    w.per_x[k] = 0.0f - per_w * along_y, w.per_y[k] = per_w * along_x;
    sum = sum + w.at[k], sum_per_x = sum_per_x + w.per_x[k], sum_per_y = sum_per_y + w.per_y[k];
  }
  const vfloat per_sum = 1.0f / max(sum, 1e-30f);
  for (int k = 0; k < 3; ++k) {
    w.at[k] = per_sum * w.at[k];
    w.per_x[k] = per_sum * (w.per_x[k] - w.at[k] * sum_per_x);
    w.per_y[k] = per_sum * (w.per_y[k] - w.at[k] * sum_per_y);
  }
  vfloat alpha = w.at[0] * t.alpha[0] + w.at[1] * t.alpha[1] + w.at[2] * t.alpha[2];
  if (const SurfaceTexture* texture = t.mask->texture) {
    Vec2<vfloat> uv[3];
    for (int k = 0; k < 3; ++k) uv[k] = {t.uv[k].x, t.uv[k].y};
    alpha = alpha * sample_alpha(*texture, footprint(w, uv));
  }
  return hn::Ge(alpha.v, hn::Set(F(), t.mask->cutoff));
}

// Which of the samples at (x, y) lie in texels whose hash is in the instance's cross-fade range?
Mask in_share(const RasterInstance& instance, vfloat x, vfloat y) {
  const auto fract = [](vfloat a) { return a - vfloat(hn::Floor(a.v)); };
  const vfloat column(hn::Floor(x.v)), row(hn::Floor(y.v));
  const vfloat hash = fract(52.9829189f * fract(column * 0.06711056f + row * 0.00583715f));
  return hn::And(hn::Ge(hash.v, hn::Set(F(), instance.share_from)),
                 hn::Lt(hash.v, hn::Set(F(), instance.share_to)));
}

// Which of the triangles [place, place + count) have any of the rows [low, high)? Ascending;
// returns how many they are. Most strips have few of a piece's triangles, or none.
std::uint32_t find_in_rows(const Triangles& in, std::uint32_t place, std::uint32_t count, int low,
                           int high, std::uint32_t* found) {
  const I i;
  const U u;
  const auto lanes = std::uint32_t(hn::Lanes(i));
  std::uint32_t size = 0;
  for (std::uint32_t t = 0; t < count; t += lanes) {
    const auto first = hn::LoadU(i, &in.low[place + t]), last = hn::LoadU(i, &in.high[place + t]);
    auto meets = hn::And(hn::Lt(first, hn::Set(i, high)), hn::Gt(last, hn::Set(i, low - 1)));
    if (count - t < lanes) meets = hn::And(meets, hn::FirstN(i, count - t));
    store_compressed(lane_numbers(u, place + t), hn::RebindMask(u, meets), u, found + size);
    size += std::uint32_t(hn::CountTrue(i, meets));
  }
  return size;
}

// Rows [low, high) of what the triangles [place, place + count) of the instance cover; returns how
// many have any. Without holes and cross-fades a loop of its own: it has no register to spare.
template <bool kMasked>
std::uint32_t fill_rows(const Triangles& in, std::uint32_t place, std::uint32_t count,
                        const RasterInstance& instance, int low, int high, SampleBuffer& out) {
  const F f;
  const U u;
  const int samples = out.samples, width = out.width;
  const std::size_t stride = out.stride;
  float* const depths = out.depth.data();
  std::uint32_t* const triangles = out.triangle.data();
  const int lanes = int(hn::Lanes(f)), parts = std::max(1, samples / lanes);
  Pattern patterns[kMaxParts];
  for (int part = 0; part < parts; ++part) patterns[part] = make_pattern(part, out, lanes);
  // A vector holds one texel, a part of one, or several: a power of two.
  const int texels = std::max(1, lanes / samples);
  const int shift = std::countr_zero(unsigned(texels));
  std::uint32_t found[SampleRaster::kPiece + kMaxLanes];
  const std::uint32_t size = find_in_rows(in, place, count, low, high, found);
  const std::int32_t begin = std::int32_t(out.row(low)), end = std::int32_t(out.row(high));
  for (std::uint32_t n = 0; n < size; ++n) {
    const std::uint32_t t = found[n];
    const std::uint32_t number =
        instance.numbers ? instance.numbers[in.index[t]] : instance.first_triangle + in.index[t];
    if (!kMasked && in.sample[0][t] != Triangles::kLarge) {
      for (int k = 0; k < Triangles::kSmallSamples; ++k) {
        const std::int32_t at = in.sample[k][t];
        const float z = in.sample_z[k][t];
        if (at < begin || at >= end || !(z < depths[at])) continue;
        depths[at] = z, triangles[at] = number;
      }
      continue;
    }
    const int from = std::max(in.low[t], low), to = std::min(in.high[t], high - 1);
    const auto get = [&](Triangles::Field field) { return in.field[field][t]; };
    const float x0 = get(Triangles::x0), y0 = get(Triangles::y0);
    const float x1 = get(Triangles::x1), y1 = get(Triangles::y1);
    const float x2 = get(Triangles::x2), y2 = get(Triangles::y2);
    const Edge edges[3] = {make_edge(x0, y0, x1, y1), make_edge(x1, y1, x2, y2),
                           make_edge(x2, y2, x0, y0)};
    const vfloat z0 = get(Triangles::z0), z_min = get(Triangles::z_min),
                 z_max = get(Triangles::z_max);
    const vfloat z_per_x = get(Triangles::z_per_x), z_per_y = get(Triangles::z_per_y);
    const auto triangle = hn::Set(u, number);
    [[maybe_unused]] MaskedTriangle masked;
    if constexpr (kMasked)
      if (instance.mask) masked = masked_triangle(in, t, instance);
    const float left = std::max(std::min(std::min(x0, x1), x2), 0.0f);
    const float right = std::min(std::max(std::max(x0, x1), x2), float(width) - 0.5f);
    // Groups of a row that are `texels` wide.
    const int first_of_all = int(left) >> shift, last_of_all = int(right) >> shift;
    constexpr int kManyGroups = 4;
    const bool many = last_of_all - first_of_all >= kManyGroups;
    RowSpan span{};
    if (many) span.set({x0, x1, x2}, {y0, y1, y2}, float(out.height));
    for (int part = 0; part < parts; ++part) {
      const vfloat pattern_x(hn::LoadU(f, patterns[part].x)),
          pattern_y(hn::LoadU(f, patterns[part].y));
      for (int row = from; row <= to; ++row) {
        const vfloat row_x = pattern_x + beside_pattern(out, row);
        vfloat y = 0.0f, z_row = 0.0f, across[3] = {0.0f, 0.0f, 0.0f};
        const auto set_y = [&](vfloat in_row) {
          y = in_row + float(row), z_row = z0 + z_per_y * (y - y0);
          for (int k = 0; k < 3; ++k) across[k] = edges[k].along_x * (y - edges[k].y);
        };
        set_y(pattern_y);
        int first = first_of_all, last = last_of_all;
        if (many) {
          float from_x = left, to_x = right;
          span.cut(row, from_x, to_x);
          if (!(from_x <= to_x)) continue;
          first = int(from_x) >> shift, last = int(to_x) >> shift;
        }
        for (int group = first; group <= last; ++group) {
          const vfloat x = row_x + float(group << shift);
          if constexpr (kOneLane)
            if (out.staggered) set_y(height_in_row(group));
          const auto inside = [&](int k) {
            const vfloat e = across[k] - edges[k].along_y * (x - edges[k].x);
            return hn::Xor(hn::Ge(e.v, hn::Zero(f)), edges[k].turned);
          };
          Mask covered = hn::And(hn::And(inside(0), inside(1)), inside(2));
          const vfloat z = min(max(z_row + z_per_x * (x - x0), z_min), z_max);
          const std::size_t at =
              std::size_t(row) * stride + std::size_t((group * parts + part) * lanes);
          const auto nearest = hn::LoadU(f, depths + at);
          covered = hn::And(covered, hn::Lt(z.v, nearest));
          if ((kMasked || !kMaskedStores) && hn::AllFalse(f, covered)) continue;
          if constexpr (kMasked) {
            if (instance.mask) covered = hn::And(covered, alpha_passes(masked, x, y));
            covered = hn::And(covered, in_share(instance, x, y));
            if (hn::AllFalse(f, covered)) continue;
          }
          store_masked(z.v, covered, f, depths + at);
          store_masked(triangle, hn::RebindMask(u, covered), u, triangles + at);
        }
      }
    }
  }
  return size;
}

#include "rilievo/render/raster/stroke_fill.inl"

std::uint32_t set_up_any(const RasterInstance& instance, std::uint32_t first, std::uint32_t count,
                         const SampleBuffer& seen, const FarthestBlocks& farthest, Triangles& out,
                         std::uint32_t place) {
  switch (instance.primitive) {
    case Primitive::points:
      return set_up_strokes<1>(instance, first, count, seen, farthest, out, place);
    case Primitive::lines:
      return set_up_strokes<2>(instance, first, count, seen, farthest, out, place);
    case Primitive::triangles:
      break;
  }
  return set_up(instance, first, count, seen, farthest, out, place);
}

std::uint32_t fill(const Triangles& in, std::uint32_t place, std::uint32_t count,
                   const RasterInstance& instance, int low, int high, SampleBuffer& out) {
  if (instance.primitive == Primitive::points)
    return fill_strokes<LaneDiscs>(in, place, count, instance, low, high, out);
  if (instance.primitive == Primitive::lines)
    return fill_strokes<LaneLines>(in, place, count, instance, low, high, out);
  return is_masked(instance) ? fill_rows<true>(in, place, count, instance, low, high, out)
                             : fill_rows<false>(in, place, count, instance, low, high, out);
}

// The farthest depths of the blocks in rows [low, high) of texels.
void find_farthest(const SampleBuffer& seen, int low, int high, FarthestBlocks::Level& small) {
  constexpr int kSmall = FarthestBlocks::kSmall;
  const hn::CappedTag<float, kSmall> d;
  const int lanes = int(hn::Lanes(d)), row_samples = kSmall * seen.samples;
  // Blocks that reach beyond the picture stay as they are: infinite.
  for (int y = low; y + kSmall <= high; y += kSmall)
    for (int x = 0; x + kSmall <= seen.width; x += kSmall) {
      auto farthest = hn::Zero(d);
      for (int row = y; row < y + kSmall; ++row) {
        const float* depths = seen.depths(row) + std::ptrdiff_t(x) * seen.samples;
        for (int k = 0; k < row_samples; k += lanes)
          farthest = hn::Max(farthest, hn::LoadU(d, depths + k));
      }
      small.depth[std::size_t(y / kSmall * small.columns + x / kSmall)] =
          hn::GetLane(hn::MaxOfLanes(d, farthest));
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(set_up_any);
HWY_EXPORT(fill);
HWY_EXPORT(find_farthest);

RasterMask mask_of(const Mesh& mesh, const SurfaceMaterial& material) {
  RasterMask mask;
  mask.alpha = material.base_color.a;
  mask.cutoff = material.alpha_cutoff;
  if (!mesh.colors.empty()) mask.colors = mesh.colors.data();
  if (material.base) {
    mask.texture = &*material.base;
    const std::vector<glm::vec2>& uv = mesh.uv[material.base->uv_set];
    if (!uv.empty()) mask.uv = uv.data();
  }
  return mask;
}

std::size_t SampleRaster::bytes(int size, int samples) {
  return SampleBuffer::bytes(size, samples) +
         kCapacity *
             ((Triangles::kFields + Triangles::kSmallSamples) * sizeof(float) +
              sizeof(std::uint32_t) + (2 + Triangles::kSmallSamples) * sizeof(std::int32_t));
}

void SampleRaster::begin(int width, int height, int samples, bool staggered) {
  RILIEVO_EXPECTS(width <= kMaxSize && height <= kMaxSize);
  seen_.begin(width, height, samples, staggered);
  farthest_.begin(width, height);
  waiting_.assign(std::size_t(height + kStrip - 1) / kStrip, 0);
  if (!triangles_.index.empty()) return;
  for (std::vector<float>& field : triangles_.field) field.resize(kCapacity);
  triangles_.index.resize(kCapacity);
  triangles_.low.resize(kCapacity);
  triangles_.high.resize(kCapacity);
  for (std::vector<std::int32_t>& places : triangles_.sample) places.resize(kCapacity);
  for (std::vector<float>& depths : triangles_.sample_z) depths.resize(kCapacity);
}

void SampleRaster::draw(std::span<const RasterInstance> instances) {
  pieces_.clear();
  work_.assign(instances.size(), {});
  std::uint32_t place = 0;
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    const RasterInstance& instance = instances[i];
    RILIEVO_EXPECTS(instance.boxes.empty() ||
                    instance.boxes.size() == (instance.triangles + kPiece - 1) / kPiece);
    for (std::uint32_t first = 0, box = 0; first < instance.triangles; ++box) {
      const std::uint32_t begin = first, count = std::min(kPiece, instance.triangles - first);
      first += count;
      if (box < instance.boxes.size() && !can_be_seen(instance, instance.boxes[box], farthest_))
        continue;
      pieces_.push_back({i, begin, count, place, 0, 0, -1});
      // Some processors store whole vectors: no piece may reach into the next one, which another
      // thread fills.
      place += count + kMaxLanes;
      if (place < kRound) continue;
      draw_round(instances);
      pieces_.clear();
      place = 0;
    }
  }
  if (!pieces_.empty()) draw_round(instances);
}

void SampleRaster::draw_round(std::span<const RasterInstance> instances) {
  parallel_for(std::size_t(0), pieces_.size(), [&](std::size_t i) {
    Piece& piece = pieces_[i];
    piece.kept =
        HWY_DYNAMIC_DISPATCH(set_up_any)(instances[piece.instance], piece.first, piece.count, seen_,
                                         farthest_, triangles_, piece.place);
    const auto at = [&](const std::vector<std::int32_t>& rows) {
      return std::span(rows).subspan(piece.place, piece.kept);
    };
    const bool any = piece.kept > 0;
    piece.low = any ? *std::min_element(at(triangles_.low).begin(), at(triangles_.low).end()) : 0;
    piece.high =
        any ? *std::max_element(at(triangles_.high).begin(), at(triangles_.high).end()) : -1;
  });
  for (const Piece& piece : pieces_) {
    MeshWork& work = work_[piece.instance];
    work.projected += piece.count, work.filled += piece.kept;
  }
  // An update reads each sample of a strip, sixteen at a time: as much work as a triangle or two.
  const std::uint64_t worth_an_update = std::uint64_t(kStrip) * seen_.stride / 32;
  parallel_for(std::size_t(0), waiting_.size(), [&](std::size_t strip) {
    const int low = int(strip) * kStrip, high = std::min(low + kStrip, seen_.height);
    for (const Piece& piece : pieces_)
      if (piece.low < high && piece.high >= low)
        waiting_[strip] += HWY_DYNAMIC_DISPATCH(fill)(triangles_, piece.place, piece.kept,
                                                      instances[piece.instance], low, high, seen_);
    if (waiting_[strip] < worth_an_update) return;
    waiting_[strip] = 0;
    HWY_DYNAMIC_DISPATCH(find_farthest)(seen_, low, high, farthest_.small);
    farthest_.update_large(int(strip));
  });
  farthest_.update_any();
}

}  // namespace rilievo
#endif
