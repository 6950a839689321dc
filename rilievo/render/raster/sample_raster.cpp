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
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

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

using Triangles = SampleRaster::Triangles;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using Mask = hn::Mask<F>;

constexpr std::uint32_t kMostLanes = SampleRaster::kMostLanes;

struct Corner {
  N x, y, z, w;
};

N dot(const glm::vec4& row, const N3& p) {
  return row.x * p.x + N(row.y) * p.y + (row.z * p.z + N(row.w));
}

// Of one index a lane.
Corner project(const RasterInstance& instance, hn::Vec<U> index) {
  const F f;
  const float* positions = &instance.positions[0].x;
  const auto offset = hn::BitCast(I(), hn::Add(hn::Add(index, index), index));  // three floats each
  const N3 p(hn::GatherIndex(f, positions, offset), hn::GatherIndex(f, positions + 1, offset),
             hn::GatherIndex(f, positions + 2, offset));
  const N w = dot(instance.row_w, p), per_w = 1.0f / w;
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
    std::uint32_t padded[3 * kMostLanes];
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
    const N bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
    const N area = bx * cy - cx * by;
    const Mask turned = hn::Lt(area.v, hn::Zero(f));
    const auto above = [&](N x, float low) { return hn::Gt(x.v, hn::Set(f, low)); };
    Mask keep = hn::And(above(a.w, 0), hn::And(above(b.w, 0), above(c.w, 0)));
    const N sized = instance.back ? instance.front ? N(hn::Abs(area.v)) : 0.0f - area : area;
    constexpr float kTooLarge = 1e30f;
    keep = hn::And(keep, hn::And(above(sized, 0), above(kTooLarge - sized, 0)));

    // Is there a column and a row of samples in its box? A row of texels has as many rows of
    // samples as samples, the first one half a step from its edge.
    const auto first_in = [&](N low) {
      return max(N(hn::Ceil((low * float(samples) - 0.5f).v)), 0.0f);
    };
    const auto last_in = [&](N high, float count) {
      return N(hn::Floor((min(high * float(samples), count - 0.5f) - 0.5f).v));
    };
    const N first_column = first_in(min(min(a.x, b.x), c.x));
    const N last_column = last_in(max(max(a.x, b.x), c.x), columns);
    const N first_row = first_in(min(min(a.y, b.y), c.y));
    const N last_row = last_in(max(max(a.y, b.y), c.y), rows);
    keep = hn::And(keep,
                   hn::And(hn::Le(first_column.v, last_column.v), hn::Le(first_row.v, last_row.v)));
    if (hn::AllFalse(f, keep)) continue;

    const auto store = [&](Triangles::Field field, N x) {
      hn::CompressBlendedStore(x.v, keep, f, &out.field[field][kept]);
    };
    // Counter-clockwise from here on.
    const auto other = [&](N yes, N no) { return N(hn::IfThenElse(turned, yes.v, no.v)); };
    store(Triangles::x0, a.x), store(Triangles::y0, a.y);
    store(Triangles::x1, other(c.x, b.x)), store(Triangles::y1, other(c.y, b.y));
    store(Triangles::x2, other(b.x, c.x)), store(Triangles::y2, other(b.y, c.y));
    // Depth is affine over the raster.
    const N bz = b.z - a.z, cz = c.z - a.z, per_area = 1.0f / area;
    store(Triangles::z0, a.z);
    store(Triangles::z_per_x, (bz * cy - cz * by) * per_area);
    store(Triangles::z_per_y, (cz * bx - bz * cx) * per_area);
    store(Triangles::z_min, max(min(min(a.z, b.z), c.z), 0.0f));
    store(Triangles::z_max, max(max(max(a.z, b.z), c.z), 0.0f));
    const auto texels = [&](N row) {
      return hn::ConvertTo(i, hn::Floor((row * (1.0f / float(samples))).v));
    };
    const auto whole = hn::RebindMask(i, keep);
    hn::CompressBlendedStore(texels(first_row), whole, i, &out.low[kept]);
    hn::CompressBlendedStore(texels(last_row), whole, i, &out.high[kept]);
    const auto names = hn::Add(hn::Iota(u, 0), hn::Set(u, instance.first_name + first + t));
    kept +=
        std::uint32_t(hn::CompressBlendedStore(names, hn::RebindMask(u, keep), u, &out.name[kept]));
  }
  return kept - place;
}

// Where the samples of a vector lie, from the left edge of its first texel on.
struct Pattern {
  float x[kMostLanes], y[kMostLanes];
};

// Vectors that hold a texel's samples, where a vector is too short for all of them.
constexpr int kMostParts = 4;

Pattern make_pattern(int part, int samples, int lanes) {
  Pattern pattern;
  for (int k = 0; k < lanes; ++k) {
    const int sample = part * lanes + k;
    const glm::vec2 p = SampleRaster::sample_position(sample % samples, samples);
    pattern.x[k] = float(sample / samples) + p.x, pattern.y[k] = p.y;
  }
  return pattern;
}

struct Edge {
  N x, y, along_x, along_y;  // from its smaller end to its larger one
  Mask turned;               // the triangle runs along it the other way
};

Edge make_edge(float ax, float ay, float bx, float by) {
  const F f;
  const bool turned = bx < ax || (bx == ax && by < ay);
  if (turned) std::swap(ax, bx), std::swap(ay, by);
  return {ax, ay, bx - ax, by - ay, hn::FirstN(f, turned ? hn::Lanes(f) : 0)};
}

// Rows [low, high) of what the triangles [place, place + count) cover.
void fill(const Triangles& in, std::uint32_t place, std::uint32_t count, int low, int high,
          int width, int samples, std::size_t stride, float* depths, std::uint32_t* names) {
  const F f;
  const U u;
  const int lanes = int(hn::Lanes(f)), parts = std::max(1, samples / lanes);
  Pattern patterns[kMostParts];
  for (int part = 0; part < parts; ++part) patterns[part] = make_pattern(part, samples, lanes);
  for (std::uint32_t t = place; t < place + count; ++t) {
    const int from = std::max(in.low[t], low), to = std::min(in.high[t], high - 1);
    if (from > to) continue;
    const auto get = [&](Triangles::Field field) { return in.field[field][t]; };
    const float x0 = get(Triangles::x0), y0 = get(Triangles::y0);
    const float x1 = get(Triangles::x1), y1 = get(Triangles::y1);
    const float x2 = get(Triangles::x2), y2 = get(Triangles::y2);
    const Edge edges[3] = {make_edge(x0, y0, x1, y1), make_edge(x1, y1, x2, y2),
                           make_edge(x2, y2, x0, y0)};
    const N z0 = get(Triangles::z0), z_min = get(Triangles::z_min), z_max = get(Triangles::z_max);
    const N z_per_x = get(Triangles::z_per_x), z_per_y = get(Triangles::z_per_y);
    const auto name = hn::Set(u, in.name[t]);
    const float left = std::max(std::min(std::min(x0, x1), x2), 0.0f);
    const float right = std::min(std::max(std::max(x0, x1), x2), float(width) - 0.5f);
    // Vectors of a row.
    const int first = int(left) * samples / lanes, last = ((int(right) + 1) * samples - 1) / lanes;
    for (int part = 0; part < parts; ++part) {
      const N pattern_x(hn::LoadU(f, patterns[part].x)), pattern_y(hn::LoadU(f, patterns[part].y));
      for (int row = from; row <= to; ++row) {
        const N y = pattern_y + float(row);
        const N z_row = z0 + z_per_y * (y - y0);
        N across[3] = {0.0f, 0.0f, 0.0f};
        for (int k = 0; k < 3; ++k) across[k] = edges[k].along_x * (y - edges[k].y);
        for (int vector = first + part; vector <= last; vector += parts) {
          const N x = pattern_x + float((vector - part) * lanes / samples);
          const auto inside = [&](int k) {
            const N e = across[k] - edges[k].along_y * (x - edges[k].x);
            return hn::Xor(hn::Ge(e.v, hn::Zero(f)), edges[k].turned);
          };
          Mask covered = hn::And(hn::And(inside(0), inside(1)), inside(2));
          const N z = min(max(z_row + z_per_x * (x - x0), z_min), z_max);
          const std::size_t at = std::size_t(row) * stride + std::size_t(vector * lanes);
          const auto nearest = hn::LoadU(f, depths + at);
          covered = hn::And(covered, hn::Lt(z.v, nearest));
          if (hn::AllFalse(f, covered)) continue;
          hn::StoreU(hn::IfThenElse(covered, z.v, nearest), f, depths + at);
          const auto seen = hn::LoadU(u, names + at);
          hn::StoreU(hn::IfThenElse(hn::RebindMask(u, covered), name, seen), u, names + at);
        }
      }
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(set_up);
HWY_EXPORT(fill);

glm::vec2 SampleRaster::sample_position(int sample, int samples) {
  if (samples == 1) return {0.5f, 0.5f};
  constexpr glm::vec2 kFour[] = {
      {0.375f, 0.125f}, {0.875f, 0.375f}, {0.125f, 0.625f}, {0.625f, 0.875f}};
  return kFour[sample];
}

std::size_t SampleRaster::bytes(int size, int samples) {
  return std::size_t(size) * std::size_t(size) * std::size_t(samples) *
             (sizeof(float) + sizeof(std::uint32_t)) +
         kPlaces * (Triangles::kFields * sizeof(float) + sizeof(std::uint32_t) +
                    2 * sizeof(std::int32_t));
}

void SampleRaster::begin(int width, int height, int samples) {
  RILIEVO_EXPECTS(0 < width && width <= kMaxSize && 0 < height && height <= kMaxSize);
  RILIEVO_EXPECTS(samples == 1 || samples == 4);
  width_ = width, height_ = height, samples_ = samples;
  stride_ = (std::size_t(width) * std::size_t(samples) + kMostLanes - 1) / kMostLanes * kMostLanes;
  const std::size_t size = stride_ * std::size_t(height);
  if (depth_.size() < size) depth_.resize(size), name_.resize(size);
  parallel_for(0, (height + 63) / 64, [&](int i) {
    const int end = std::min(height, 64 * (i + 1));
    std::fill(depth_.begin() + std::ptrdiff_t(row(64 * i)),
              depth_.begin() + std::ptrdiff_t(row(end)), 1.0f);
  });
  if (!triangles_.name.empty()) return;
  for (std::vector<float>& field : triangles_.field) field.resize(kPlaces);
  triangles_.name.resize(kPlaces);
  triangles_.low.resize(kPlaces);
  triangles_.high.resize(kPlaces);
}

void SampleRaster::draw(std::span<const RasterInstance> instances) {
  pieces_.clear();
  std::uint32_t place = 0;
  for (std::uint32_t i = 0; i < instances.size(); ++i)
    for (std::uint32_t first = 0; first < instances[i].triangles;) {
      const std::uint32_t count = std::min(kPiece, instances[i].triangles - first);
      pieces_.push_back({i, first, count, place, 0});
      first += count;
      // Some processors store whole vectors: no piece may reach into the next one, which another
      // thread fills.
      place += count + kMostLanes;
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
                                              width_, height_, samples_, triangles_, piece.place);
  });
  constexpr int kRows = 32;
  parallel_for(0, (height_ + kRows - 1) / kRows, [&](int strip) {
    for (const Piece& piece : pieces_) HWY_DYNAMIC_DISPATCH(fill)
    (triangles_, piece.place, piece.kept, strip * kRows, std::min((strip + 1) * kRows, height_),
     width_, samples_, stride_, depth_.data(), name_.data());
  });
}

}  // namespace rilievo
#endif
