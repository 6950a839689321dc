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

struct Corner {
  vfloat x, y, z, w;
};

vfloat dot(const glm::vec4& row, const Vec3<vfloat>& p) {
  return row.x * p.x + vfloat(row.y) * p.y + (row.z * p.z + vfloat(row.w));
}

// Of one index a lane.
Corner project(const RasterInstance& instance, hn::Vec<U> index) {
  const F f;
  const float* positions = &instance.positions[0].x;
  const auto offset = hn::BitCast(I(), hn::Add(hn::Add(index, index), index));  // three floats each
  const Vec3<vfloat> p(hn::GatherIndex(f, positions, offset),
                       hn::GatherIndex(f, positions + 1, offset),
                       hn::GatherIndex(f, positions + 2, offset));
  const vfloat w = dot(instance.row_w, p), per_w = 1.0f / w;
  return {per_w * dot(instance.row_x, p), per_w * dot(instance.row_y, p),
          per_w * dot(instance.row_z, p), w};
}

// Sets up triangles [first, first + count) of the instance, those that can be seen from `place` on;
// returns how many they are.
std::uint32_t set_up(const RasterInstance& instance, std::uint32_t first, std::uint32_t count,
                     int width, int height, int samples, Triangles& out, std::uint32_t place) {
  const F f;
  const I i;
  const U u;
  const auto lanes = std::uint32_t(hn::Lanes(f));
  const float columns = float(width * samples), rows = float(height * samples);
  std::uint32_t kept = place;
  for (std::uint32_t t = 0; t < count; t += lanes) {
    const std::uint32_t* at = instance.indices + 3 * std::size_t(first + t);
    std::uint32_t padded[3 * kMaxLanes];
    if (count - t < lanes) {
      // Its first corner over and over: triangles without an area.
      std::fill(std::begin(padded), std::end(padded), at[0]);
      std::copy(at, at + 3 * std::size_t(count - t), padded);
      at = padded;
    }
    hn::Vec<U> index[3];
    hn::LoadInterleaved3(u, at, index[0], index[1], index[2]);
    const Corner a = project(instance, index[0]), b = project(instance, index[1]),
                 c = project(instance, index[2]);

    // Which way round? Nothing that is behind, flat, or not a number.
    const vfloat bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
    const vfloat area = bx * cy - cx * by;
    const Mask turned = hn::Lt(area.v, hn::Zero(f));
    const auto above = [&](vfloat x, float low) { return hn::Gt(x.v, hn::Set(f, low)); };
    const float min_w = instance.min_w;
    Mask keep = hn::And(above(a.w, min_w), hn::And(above(b.w, min_w), above(c.w, min_w)));
    const vfloat sized =
        instance.back ? instance.front ? vfloat(hn::Abs(area.v)) : 0.0f - area : area;
    constexpr float kTooLarge = 1e30f;
    keep = hn::And(keep, hn::And(above(sized, 0), above(kTooLarge - sized, 0)));

    // Is there a column and a row of samples in its box? A row of texels has as many rows of
    // samples as samples, the first one half a step from its edge.
    const auto first_in = [&](vfloat low) {
      return max(vfloat(hn::Ceil((low * float(samples) - 0.5f).v)), 0.0f);
    };
    const auto last_in = [&](vfloat high, float count) {
      return vfloat(hn::Floor((min(high * float(samples), count - 0.5f) - 0.5f).v));
    };
    const vfloat first_column = first_in(min(min(a.x, b.x), c.x));
    const vfloat last_column = last_in(max(max(a.x, b.x), c.x), columns);
    const vfloat first_row = first_in(min(min(a.y, b.y), c.y));
    const vfloat last_row = last_in(max(max(a.y, b.y), c.y), rows);
    keep = hn::And(keep,
                   hn::And(hn::Le(first_column.v, last_column.v), hn::Le(first_row.v, last_row.v)));
    if (hn::AllFalse(f, keep)) continue;

    const auto store = [&](Triangles::Field field, vfloat x) {
      hn::CompressBlendedStore(x.v, keep, f, &out.field[field][kept]);
    };
    // Counter-clockwise from here on.
    const auto other = [&](vfloat yes, vfloat no) {
      return vfloat(hn::IfThenElse(turned, yes.v, no.v));
    };
    store(Triangles::x0, a.x), store(Triangles::y0, a.y);
    store(Triangles::x1, other(c.x, b.x)), store(Triangles::y1, other(c.y, b.y));
    store(Triangles::x2, other(b.x, c.x)), store(Triangles::y2, other(b.y, c.y));
    // Depth is affine over the raster.
    const vfloat bz = b.z - a.z, cz = c.z - a.z, per_area = 1.0f / area;
    store(Triangles::z0, a.z);
    store(Triangles::z_per_x, (bz * cy - cz * by) * per_area);
    store(Triangles::z_per_y, (cz * bx - bz * cx) * per_area);
    store(Triangles::z_min, max(min(min(a.z, b.z), c.z), 0.0f));
    store(Triangles::z_max, max(max(max(a.z, b.z), c.z), 0.0f));
    if (instance.mask) {
      store(Triangles::per_w0, 1.0f / a.w);
      store(Triangles::per_w1, other(1.0f / c.w, 1.0f / b.w));
      store(Triangles::per_w2, other(1.0f / b.w, 1.0f / c.w));
      store(Triangles::exchanged, other(1.0f, 0.0f));
    }
    const auto texels = [&](vfloat row) {
      return hn::ConvertTo(i, hn::Floor((row * (1.0f / float(samples))).v));
    };
    const auto whole = hn::RebindMask(i, keep);
    hn::CompressBlendedStore(texels(first_row), whole, i, &out.low[kept]);
    hn::CompressBlendedStore(texels(last_row), whole, i, &out.high[kept]);
    kept += std::uint32_t(hn::CompressBlendedStore(hn::Iota(u, first + t), hn::RebindMask(u, keep),
                                                   u, &out.index[kept]));
  }
  return kept - place;
}

// Where the samples of a vector lie, from the left edge of its first texel on.
struct Pattern {
  float x[kMaxLanes], y[kMaxLanes];
};

// Vectors that hold a texel's samples, where a vector is too short for all of them.
constexpr int kMaxParts = 4;

Pattern make_pattern(int part, int samples, int lanes) {
  Pattern pattern;
  for (int k = 0; k < lanes; ++k) {
    const int sample = part * lanes + k;
    const glm::vec2 p = sample_position(sample % samples, samples);
    pattern.x[k] = float(sample / samples) + p.x, pattern.y[k] = p.y;
  }
  return pattern;
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
    size += std::uint32_t(
        hn::CompressStore(hn::Iota(u, place + t), hn::RebindMask(u, meets), u, found + size));
  }
  return size;
}

// Rows [low, high) of what the triangles [place, place + count) of the instance cover. Without
// holes and cross-fades a loop of its own: it has no register to spare.
template <bool kMasked>
void fill_rows(const Triangles& in, std::uint32_t place, std::uint32_t count,
               const RasterInstance& instance, int low, int high, SampleBuffer& out) {
  const F f;
  const U u;
  const int samples = out.samples, width = out.width;
  const std::size_t stride = out.stride;
  float* const depths = out.depth.data();
  std::uint32_t* const triangles = out.triangle.data();
  const int lanes = int(hn::Lanes(f)), parts = std::max(1, samples / lanes);
  Pattern patterns[kMaxParts];
  for (int part = 0; part < parts; ++part) patterns[part] = make_pattern(part, samples, lanes);
  // A vector holds one texel, a part of one, or several: a power of two.
  const int texels = std::max(1, lanes / samples);
  const int shift = std::countr_zero(unsigned(texels));
  std::uint32_t found[SampleRaster::kPiece + kMaxLanes];
  const std::uint32_t size = find_in_rows(in, place, count, low, high, found);
  for (std::uint32_t n = 0; n < size; ++n) {
    const std::uint32_t t = found[n];
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
    const auto triangle = hn::Set(u, instance.numbers ? instance.numbers[in.index[t]]
                                                      : instance.first_triangle + in.index[t]);
    [[maybe_unused]] MaskedTriangle masked;
    if constexpr (kMasked)
      if (instance.mask) masked = masked_triangle(in, t, instance);
    const float left = std::max(std::min(std::min(x0, x1), x2), 0.0f);
    const float right = std::min(std::max(std::max(x0, x1), x2), float(width) - 0.5f);
    // Groups of a row that are `texels` wide.
    const int first = int(left) >> shift, last = int(right) >> shift;
    for (int part = 0; part < parts; ++part) {
      const vfloat pattern_x(hn::LoadU(f, patterns[part].x)),
          pattern_y(hn::LoadU(f, patterns[part].y));
      for (int row = from; row <= to; ++row) {
        const vfloat y = pattern_y + float(row);
        const vfloat z_row = z0 + z_per_y * (y - y0);
        vfloat across[3] = {0.0f, 0.0f, 0.0f};
        for (int k = 0; k < 3; ++k) across[k] = edges[k].along_x * (y - edges[k].y);
        for (int group = first; group <= last; ++group) {
          const vfloat x = pattern_x + float(group << shift);
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
          if (hn::AllFalse(f, covered)) continue;
          if constexpr (kMasked) {
            if (instance.mask) covered = hn::And(covered, alpha_passes(masked, x, y));
            covered = hn::And(covered, in_share(instance, x, y));
            if (hn::AllFalse(f, covered)) continue;
          }
          hn::StoreU(hn::IfThenElse(covered, z.v, nearest), f, depths + at);
          const auto seen = hn::LoadU(u, triangles + at);
          hn::StoreU(hn::IfThenElse(hn::RebindMask(u, covered), triangle, seen), u, triangles + at);
        }
      }
    }
  }
}

void fill(const Triangles& in, std::uint32_t place, std::uint32_t count,
          const RasterInstance& instance, int low, int high, SampleBuffer& out) {
  if (instance.mask || instance.share_from > 0 || instance.share_to < 1)
    fill_rows<true>(in, place, count, instance, low, high, out);
  else
    fill_rows<false>(in, place, count, instance, low, high, out);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(set_up);
HWY_EXPORT(fill);

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
         kCapacity * (Triangles::kFields * sizeof(float) + sizeof(std::uint32_t) +
                      2 * sizeof(std::int32_t));
}

void SampleRaster::begin(int width, int height, int samples) {
  RILIEVO_EXPECTS(width <= kMaxSize && height <= kMaxSize);
  seen_.begin(width, height, samples);
  if (!triangles_.index.empty()) return;
  for (std::vector<float>& field : triangles_.field) field.resize(kCapacity);
  triangles_.index.resize(kCapacity);
  triangles_.low.resize(kCapacity);
  triangles_.high.resize(kCapacity);
}

void SampleRaster::draw(std::span<const RasterInstance> instances) {
  pieces_.clear();
  std::uint32_t place = 0;
  for (std::uint32_t i = 0; i < instances.size(); ++i)
    for (std::uint32_t first = 0; first < instances[i].triangles;) {
      const std::uint32_t count = std::min(kPiece, instances[i].triangles - first);
      pieces_.push_back({i, first, count, place, 0, 0, -1});
      first += count;
      // Some processors store whole vectors: no piece may reach into the next one, which another
      // thread fills.
      place += count + kMaxLanes;
      if (place < kRound) continue;
      draw_round(instances);
      pieces_.clear();
      place = 0;
    }
  if (!pieces_.empty()) draw_round(instances);
}

void SampleRaster::draw_round(std::span<const RasterInstance> instances) {
  parallel_for(std::size_t(0), pieces_.size(), [&](std::size_t i) {
    Piece& piece = pieces_[i];
    piece.kept = HWY_DYNAMIC_DISPATCH(set_up)(instances[piece.instance], piece.first, piece.count,
                                              seen_.width, seen_.height, seen_.samples, triangles_,
                                              piece.place);
    const auto at = [&](const std::vector<std::int32_t>& rows) {
      return std::span(rows).subspan(piece.place, piece.kept);
    };
    const bool any = piece.kept > 0;
    piece.low = any ? *std::min_element(at(triangles_.low).begin(), at(triangles_.low).end()) : 0;
    piece.high =
        any ? *std::max_element(at(triangles_.high).begin(), at(triangles_.high).end()) : -1;
  });
  constexpr int kRows = 32;
  parallel_for(0, (seen_.height + kRows - 1) / kRows, [&](int strip) {
    const int low = strip * kRows, high = std::min(low + kRows, seen_.height);
    for (const Piece& piece : pieces_)
      if (piece.low < high && piece.high >= low) HWY_DYNAMIC_DISPATCH(fill)
    (triangles_, piece.place, piece.kept, instances[piece.instance], low, high, seen_);
  });
}

}  // namespace rilievo
#endif
