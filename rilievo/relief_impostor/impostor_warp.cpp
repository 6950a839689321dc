// Cf. [Clua, Feijo, Dreux, Fonseca 2005, sections 2 and 5] and [Oliveira, Bishop, McAllister 2000].
// How we differ: the picture is perspective; the tables map levels to codes that are linear along
// straight lines of the result, so that interpolated depths are exact on planes; signs as with
// depths measured away from the eye.
//
// The formula of the header: with heights h0 and h above the plane, a sample at depth s h0 along
// the ray through p lies at c + s (p - c), at height h0 (1 - s). Its depth from the new eye is
// h - h0 + s h0, so B = 1 / (alpha + beta s), and p' = e + B (c + s (p - c) - e). As B beta s =
// 1 - alpha B, this is affine in B.
#include "rilievo/relief_impostor/impostor_warp.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

PlaneAxis plane_axis(double c, double e, double alpha, double beta) {
  return {e - c / beta, 1 / beta, (c - e) + c * alpha / beta, -alpha / beta};
}

// The interval of an axis that is covered by samples in [from, to] with nearness in [low, high].
struct Interval {
  double min = 1e300, max = -1e300;
};
Interval covered(const PlaneAxis& axis, double from, double to, double low, double high) {
  Interval all;
  for (const double p : {from, to})
    for (const double nearness : {low, high}) {
      const double at = axis.moved(p, nearness);
      all = {std::min(all.min, at), std::max(all.max, at)};
    }
  return all;
}

// In texels of the result, from `offset`; positions of indices, whose centres lie half a texel
// beyond; codes in the place of B.
AxisWarp axis_warp(const PlaneAxis& axis, double resolution, double offset, double m0, double m1,
                   int count) {
  const double b0 = axis.b0 + 0.5 * axis.b1, a0 = axis.a0 + 0.5 * axis.a1;
  AxisWarp k;
  k.a0 = float(resolution * (a0 - b0 * m0 / m1) - offset);
  k.a1 = float(resolution * (axis.a1 - axis.b1 * m0 / m1));
  k.b0 = float(resolution * b0 / m1), k.b1 = float(resolution * axis.b1 / m1);
  k.reach = float(0.5 * std::max(1.0, resolution));
  // Nearer surfaces move in the direction of b0 + b1 i. Where that is downwards, they are met later
  // on the way upwards.
  if (axis.b1 == 0) {
    k.ranges[0] = {0, count, b0 < 0};
    k.ranges[1] = {0, 0, true};
    return k;
  }
  // The first index beyond the epipole. The piece before it begins on this side and is the nearest
  // to the epipole: last if surfaces are drawn towards it, else first.
  const int split = int(std::clamp(std::ceil(-b0 / axis.b1), 0.0, double(count)));
  if (axis.b1 > 0) {
    k.ranges[0] = {split, count, false};
    k.ranges[1] = {0, split, true};
  } else {
    k.ranges[0] = {0, split, false};
    k.ranges[1] = {split, count, true};
  }
  return k;
}

// Rows of the first pass that are one piece of work.
constexpr int kRowsAtOnce = 32;

// Vectors that begin there lie in one line of the processor's cache.
constexpr std::size_t kAlignment = 64;
template <class T>
T* aligned(T* at) {
  const auto address = reinterpret_cast<std::uintptr_t>(at);
  return at + (kAlignment - address % kAlignment) % kAlignment / sizeof(T);
}

}  // namespace

std::optional<PlaneWarp> plane_warp(const PictureGeometry& picture, const glm::dvec3& eye) {
  const Camera& camera = picture.capture;
  const glm::dvec3 at(eye_from_world(camera) * glm::dvec4(eye, 1));
  PlaneWarp warp;
  warp.height = picture.plane_z + at.z;
  if (!(warp.height > 1e-9 * picture.plane_z)) return std::nullopt;
  warp.beta = picture.plane_z / warp.height;
  warp.alpha = 1 - warp.beta;
  const ImageWindow& w = camera.window;
  const double across = camera.width / (w.right - w.left),
               down = camera.height / (w.top - w.bottom);
  warp.x = plane_axis(-w.left * across, (at.x / picture.plane_z - w.left) * across, warp.alpha,
                      warp.beta);
  warp.y = plane_axis(w.top * down, (w.top - at.y / picture.plane_z) * down, warp.alpha, warp.beta);
  return warp;
}

namespace {

// The largest and the smallest B of the picture; none if an eye is too near.
std::optional<Interval> nearness_of(const PictureGeometry& picture, const PlaneWarp& warp) {
  const DepthSlab& slab = picture.slab;
  const double plane = picture.plane_z;
  const double front = warp.alpha + warp.beta * slab.front / plane,
               back = warp.alpha + warp.beta * slab.back / plane;
  if (!(front > 0)) return std::nullopt;
  const Interval nearness{1 / back, 1 / front};
  for (const PlaneAxis& axis : {warp.x, warp.y})
    if (!(axis.a1 + nearness.max * axis.b1 <= kMaxImpostorMagnification)) return std::nullopt;
  return nearness;
}

}  // namespace

double largest_move(const PictureGeometry& picture, const PlaneWarp& warp) {
  const std::optional<Interval> nearness = nearness_of(picture, warp);
  if (!nearness) return std::numeric_limits<double>::infinity();
  double most = 0;
  const auto look = [&](const PlaneAxis& axis, int size) {
    for (const double p : {0.0, double(size)})
      for (const double b : {nearness->min, nearness->max})
        most = std::max(most, std::abs(axis.moved(p, b) - p));
  };
  look(warp.x, picture.capture.width);
  look(warp.y, picture.capture.height);
  return most;
}

std::optional<WarpedTexels> warp_impostor(const ImpostorPicture& picture, const glm::dvec3& eye,
                                          const ImpostorWarpOptions& options,
                                          ImpostorWarpScratch& scratch, Prewarped& result) {
  RILIEVO_EXPECTS(options.resolution > 0 && options.max_size >= 16);
  if (picture.empty()) return std::nullopt;
  const std::optional<PlaneWarp> warp = plane_warp(picture.geometry, eye);
  if (!warp) return std::nullopt;
  const std::optional<Interval> nearness = nearness_of(picture.geometry, *warp);
  if (!nearness) return std::nullopt;
  // The grid of the result stands still on the plane: texel k begins at k / resolution. Silhouettes
  // fade over half a sample beyond their texels, which is cut off rather than all made coarser.
  double resolution = options.resolution;
  glm::dvec2 low(0), high(0);
  const auto fits = [&](double beyond, bool with_room) {
    const Interval x = covered(warp->x, picture.min.x - beyond, picture.max.x + beyond,
                               nearness->min, nearness->max);
    const Interval y = covered(warp->y, picture.min.y - beyond, picture.max.y + beyond,
                               nearness->min, nearness->max);
    glm::dvec2 first(x.min, y.min), last(x.max, y.max);
    if (with_room) {
      first = glm::min(first, glm::dvec2(options.room->x, options.room->y));
      last = glm::max(last, glm::dvec2(options.room->z, options.room->w));
    }
    low = glm::floor(resolution * first + 1e-4);
    high = glm::ceil(resolution * last - 1e-4);
    high = glm::max(high, low + 1.0);
    return std::max(high.x - low.x, high.y - low.y) <= options.max_size;
  };
  while (!(options.room && fits(0.5, true)) && !fits(0.5, false) && !fits(0, false))
    resolution /= 2;
  const int width = int(high.x - low.x), height = int(high.y - low.y);

  // The result's camera. Its depths are a little wider than the samples', so that no code is out of
  // range, and never without extent.
  const PictureGeometry& from = picture.geometry;
  PictureGeometry& to = result.geometry;
  to = from;
  to.plane_z = warp->height;
  to.slab = {warp->height / nearness->max * (1 - 1e-5), warp->height / nearness->min * (1 + 1e-5)};
  to.capture.z_near = to.slab.front, to.capture.z_far = to.slab.back;
  to.delta_bits = 16;
  to.capture.width = width, to.capture.height = height;
  to.capture.world_from_eye[3] = glm::dvec4(eye, 1);
  {
    const ImageWindow& w = from.capture.window;
    const glm::dvec3 at(eye_from_world(from.capture) * glm::dvec4(eye, 1));
    // Metres on the plane, over the eye's height.
    const auto across = [&](double k) {
      const double p = k / resolution;
      const double metres = from.plane_z * (w.left + p * (w.right - w.left) / from.capture.width);
      return (metres - at.x) / warp->height;
    };
    const auto down = [&](double k) {
      const double p = k / resolution;
      const double metres = from.plane_z * (w.top - p * (w.top - w.bottom) / from.capture.height);
      return (metres - at.y) / warp->height;
    };
    to.capture.window = {across(low.x), across(high.x), down(high.y), down(low.y)};
  }

  // code = m0 + m1 B, by the definition of window_z.
  const double n = to.slab.front, f = to.slab.back, steps = delta_steps(16);
  const double m0 = steps * f / (f - n), m1 = -steps * f * n / ((f - n) * warp->height);
  // 1 / depth is affine in the level: Delta = (far / (far - near)) (1 - near / depth).
  const double n0 = from.capture.z_near, f0 = from.capture.z_far;
  const double r0 = from.plane_z / n0,
               r1 = -from.plane_z * (f0 - n0) / (f0 * n0) / delta_steps(kLevelBits);
  const LevelCodes codes{
      float(r0), float(r1), float(warp->beta + warp->alpha * r0), float(warp->alpha * r1),
      float(m0), float(m1)};
  scratch.table.resize(kEmptyLevel + 1);
  level_table(codes, scratch.table.data());

  // Only the rows and columns that show something are read.
  const int columns = picture.max.x - picture.min.x, rows = picture.max.y - picture.min.y;
  const PlaneAxis x_axis{warp->x.a0 + warp->x.a1 * picture.min.x, warp->x.a1,
                         warp->x.b0 + warp->x.b1 * picture.min.x, warp->x.b1};
  const PlaneAxis y_axis{warp->y.a0 + warp->y.a1 * picture.min.y, warp->y.a1,
                         warp->y.b0 + warp->y.b1 * picture.min.y, warp->y.b1};
  const AxisWarp across = axis_warp(x_axis, resolution, low.x, m0, m1, columns);
  const AxisWarp down = axis_warp(y_axis, resolution, low.y, m0, m1, rows);

  const std::size_t texels = std::size_t(width) * std::size_t(height);
  const std::size_t block = warp_block(rows), blocks = std::size_t(width + 15) / 16;
  scratch.between.resize(blocks * block + kAlignment / 4);
  std::uint32_t* between = aligned(scratch.between.data());
  for (std::size_t i = 0; i < blocks; ++i)
    std::fill_n(between + i * block + std::size_t(rows) * 32, 32, kEmptyWarped);
  result.color.resize(texels);
  result.delta.resize(texels);
  scratch.flags.resize(texels);
  const WarpPlanes planes{reinterpret_cast<std::uint32_t*>(result.color.data()),
                          result.delta.data(), scratch.flags.data(), std::size_t(width)};
  const int bands = (rows + kRowsAtOnce - 1) / kRowsAtOnce,
            strips = (width + kWarpStrip - 1) / kWarpStrip;
  const std::size_t row_bytes = (row_pass_scratch(columns, width) + 63) / 64 * 64,
                    column_bytes = (column_pass_scratch(rows, height) + 63) / 64 * 64;
  const std::size_t parts = options.parallel ? std::size_t(std::max(bands, strips)) : 1;
  scratch.bytes.resize(parts * std::max(row_bytes, column_bytes) + kAlignment);
  std::byte* bytes = aligned(scratch.bytes.data());
  scratch.counts.assign(std::size_t(strips), {});
  const auto bytes_of = [&](int part, std::size_t each) {
    return bytes + (options.parallel ? std::size_t(part) * each : 0);
  };
  const auto do_band = [&](int band) {
    const int end = std::min((band + 1) * kRowsAtOnce, rows);
    for (int row = band * kRowsAtOnce; row < end; ++row)
      row_pass(across, codes, scratch.table.data(), &picture.at(picture.min.x, picture.min.y + row),
               columns, between + std::size_t(row) * 32, block, width, bytes_of(band, row_bytes));
  };
  const auto do_strip = [&](int strip) {
    const int first = strip * kWarpStrip;
    scratch.counts[std::size_t(strip)] =
        column_pass(down, between, block, rows, first, std::min(kWarpStrip, width - first), planes,
                    height, bytes_of(strip, column_bytes));
  };
  if (options.parallel) {
    parallel_for(0, bands, do_band);
    parallel_for(0, strips, do_strip);
  } else {
    for (int band = 0; band < bands; ++band) do_band(band);
    for (int strip = 0; strip < strips; ++strip) do_strip(strip);
  }
  WarpedTexels sum;
  for (const WarpedTexels& part : scratch.counts) {
    sum.covered += part.covered;
    sum.interpolated += part.interpolated;
  }
  return sum;
}

}  // namespace rilievo
