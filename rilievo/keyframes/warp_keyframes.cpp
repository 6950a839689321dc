#include "rilievo/keyframes/warp_keyframes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/large_buffer.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/keyframes/warp_rows.h"

namespace rilievo {
namespace {

// Rows and columns that something can cover, in pixels. Not rounded.
struct Reach {
  float x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
  bool may_crack = false;  // some of it may have a parallax of more than kCrackParallax

  [[nodiscard]] bool meets(float low_y, float high_y, float width) const {
    return y1 >= low_y && y0 <= high_y && x1 >= 0 && x0 <= width;
  }
};

// Less than kCrackParallax: between corners there may be a little more.
constexpr float kNearlyCrackParallax = 0.75f * kCrackParallax;

// May a texel between those corners have a parallax of more than kCrackParallax? It is the largest
// with the nearest depth.
bool may_crack_between(const WarpSource& source, float from_x, float to_x, float from_y, float to_y,
                       float nearest) {
  const RasterMap& map = source.to_frame;
  for (int i = 0; i < 4; ++i) {
    const float x = i & 1 ? to_x : from_x, y = i & 2 ? to_y : from_y;
    const auto row = [&](const float(&r)[4]) { return r[0] * x + r[1] * y + r[2]; };
    const float far_z = row(map.z), z = far_z + map.z[3] * nearest;
    if (!(far_z > 1e-6f && z > 1e-6f)) return true;
    const auto moved = [&](const float(&r)[4]) {
      return std::abs((row(r) + r[3] * nearest) / z - row(r) / far_z);
    };
    if (moved(map.x) > kNearlyCrackParallax || moved(map.y) > kNearlyCrackParallax) return true;
  }
  return false;
}

// Where texels of columns [from_x, to_x] and rows [from_y, to_y] go with depths of a range: x' and
// y' are ratios of affine functions, so that their extremes are at corners; and so is the largest
// square, half of which is added, and rounding; or half of one that closes the widest crack, and
// that crack.
Reach reach_of(const WarpSource& source, float from_x, float to_x, float from_y, float to_y,
               const InverseRange& range, bool may_crack) {
  const RasterMap& map = source.to_frame;
  Reach out;
  float least_z = INFINITY;
  for (int i = 0; i < (from_y == to_y ? 4 : 8); ++i) {
    const float x = i & 1 ? to_x : from_x, y = i & 4 ? to_y : from_y;
    const float w = i & 2 ? range.nearest : range.farthest;
    const auto row = [&](const float(&r)[4]) { return r[0] * x + r[1] * y + r[2] + r[3] * w; };
    const float z = row(map.z);
    if (!(z > 1e-6f)) return {-INFINITY, INFINITY, -INFINITY, INFINITY, may_crack};
    const float at_x = row(map.x) / z, at_y = row(map.y) / z;
    out.x0 = std::min(out.x0, at_x), out.x1 = std::max(out.x1, at_x);
    out.y0 = std::min(out.y0, at_y), out.y1 = std::max(out.y1, at_y);
    least_z = std::min(least_z, z);
  }
  const float magnified =
      std::min(std::max(source.pixels_per_texel / least_z, 1.0f), largest_square(source));
  // Squares of a crack are no wider than it.
  const float half = kHalfSquare * magnified;
  const float slack =
      (may_crack ? std::max(half, std::min(half, kWidestCrack / 2) + kWidestCrack) : half) + 1;
  return {out.x0 - slack, out.x1 + slack, out.y0 - slack, out.y1 + slack, may_crack};
}

// The reach of each block.
void find_reaches(const WarpSource& source, std::vector<Reach>& reaches) {
  const Keyframe& key = *source.keyframe;
  reaches.clear();
  for (int by = 0; by < key.blocks.height(); ++by)
    for (int bx = 0; bx < key.blocks.width(); ++bx) {
      const InverseRange& range = key.blocks(bx, by);
      const int from = bx * Keyframe::kColumns, top = by * Keyframe::kRows;
      const int to = std::min(from + Keyframe::kColumns, key.camera.width),
                bottom = std::min(top + Keyframe::kRows, key.camera.height);
      if (range.empty()) {
        reaches.emplace_back();
        continue;
      }
      const bool may_crack = may_crack_between(source, float(from), float(to), float(top),
                                               float(bottom), range.nearest);
      reaches.push_back(
          reach_of(source, float(from), float(to), float(top), float(bottom), range, may_crack));
    }
}

void splat_strip(const WarpSource& source, std::span<const Reach> reaches, float near,
                 const DepthStrip& strip) {
  const Keyframe& key = *source.keyframe;
  const float low = float(strip.first - 1), high = float(strip.first + strip.rows + 1);
  const int width = key.camera.width, height = key.camera.height;
  for (int by = 0; by < key.blocks.height(); ++by)
    for (int bx = 0; bx < key.blocks.width(); ++bx) {
      const Reach& reach = reaches[std::size_t(by * key.blocks.width() + bx)];
      if (!reach.meets(low, high, float(strip.width))) continue;
      const int from = bx * Keyframe::kColumns, to = std::min(from + Keyframe::kColumns, width);
      const int top = by * Keyframe::kRows, bottom = std::min(top + Keyframe::kRows, height);
      const bool inside = reach.y0 >= low && reach.y1 <= high;
      for (int y = top; y < bottom; ++y) {
        const InverseRange& of_row = key.segments(bx, y);
        if (of_row.empty()) continue;
        const float at = float(y) + 0.5f;
        if (inside || reach_of(source, float(from), float(to), at, at, of_row, reach.may_crack)
                          .meets(low, high, float(strip.width)))
          splat_row(source, y, from, to, near, reach.may_crack, strip);
      }
    }
}

template <class T>
void fit(Image<T>& image, int width, int height) {
  if (image.width() != width || image.height() != height) image = Image<T>(width, height);
}

// Kept by the thread that draws frames, until its next call.
std::span<const WarpSource> sources_of(std::span<const WarpedKeyframe> keyframes,
                                       const Camera& frame) {
  static thread_local std::vector<WarpSource> sources;
  find_warp_sources(keyframes, frame, sources);
  return sources;
}

// A row of pixels that are texels: the mean of the four quarters, whatever these show, as samples
// of a pixel.
void copy_row(const Keyframe& key, int left, int y, std::span<std::uint32_t> color,
              std::span<float> inverse_z) {
  std::copy_n(key.inverse_z.row(y).data() + left, inverse_z.size(), inverse_z.data());
  const std::uint32_t* upper = key.color.row(2 * y).data() + 2 * std::ptrdiff_t(left);
  const std::uint32_t* lower = key.color.row(2 * y + 1).data() + 2 * std::ptrdiff_t(left);
  for (std::size_t x = 0; x < color.size(); ++x, upper += 2, lower += 2) {
    // Two bytes at a time.
    const std::uint32_t quarters[] = {upper[0], upper[1], lower[0], lower[1]};
    std::uint32_t even = 0x00020002u, odd = 2;
    for (const std::uint32_t quarter : quarters)
      even += quarter & 0x00ff00ffu, odd += quarter >> 8 & 0xffu;
    color[x] = 0xff000000u | (even >> 2 & 0x00ff00ffu) | odd >> 2 << 8;
  }
}

}  // namespace

void WarpedFrame::resize(int width, int height) {
  fit(color, width, height);
  fit(inverse_z, width, height);
  fit(holes_in_strip, strips(height), 1);
}

std::size_t WarpedFrame::holes() const {
  const std::span<const std::uint32_t> of = holes_in_strip.texels();
  return std::accumulate(of.begin(), of.end(), std::size_t(0));
}

void warp_keyframes(std::span<const WarpedKeyframe> keyframes, const Camera& frame,
                    WarpedFrame& out, const WarpCover* cover, bool leaves_sky) {
  RILIEVO_EXPECTS(!cover || (cover->inverse_z->width() == frame.width &&
                             cover->inverse_z->height() == frame.height));
  const std::span<const WarpSource> sources = sources_of(keyframes, frame);
  const int count = int(sources.size());
  const int strips = WarpedFrame::strips(frame.height);
  out.resize(frame.width, frame.height);
  if (const auto same = cover ? std::nullopt : find_same_pixels(sources, frame)) {
    std::ranges::fill(out.holes_in_strip.texels(), 0u);
    const Keyframe& key = *sources[same->source].keyframe;
    parallel_for(0, frame.height, [&](int y) {
      copy_row(key, same->left, same->top + y, out.color.row(y), out.inverse_z.row(y));
    });
    return;
  }
  const float near = float(1 / frame.z_near);
  // Kept by the thread that draws frames.
  static thread_local std::vector<std::vector<Reach>> memory_of_reaches;
  std::vector<std::vector<Reach>>& reaches = memory_of_reaches;
  if (reaches.size() < sources.size()) reaches.resize(sources.size());
  for (int k = 0; k < count; ++k) find_reaches(sources[std::size_t(k)], reaches[std::size_t(k)]);
  parallel_for(0, strips, [&](int i) {
    static thread_local LargeBuffer<float> memory;
    DepthStrip strip;
    strip.first = i * WarpedFrame::kStrip;
    strip.rows = std::min(WarpedFrame::kStrip, frame.height - strip.first);
    strip.width = frame.width;
    strip.stride = std::size_t((frame.width + 15) / 16 * 16 + 2 * DepthStrip::kBorder);
    const std::size_t size = strip.stride * std::size_t(strip.rows + 2);
    memory.require(size);
    strip.inverse_z = memory.data();
    std::fill_n(strip.inverse_z, size, 0.0f);
    for (int k = 0; k < count; ++k)
      splat_strip(sources[std::size_t(k)], reaches[std::size_t(k)], near, strip);
    if (leaves_sky) {
      static thread_local std::vector<std::uint8_t> plain_sky;
      plain_sky.resize(std::size_t(plain_sky_cells(strip.width)));
      find_plain_sky(sources, strip.first, strip.rows, strip.width, plain_sky.data());
      strip.plain_sky = plain_sky.data();
    }
    std::uint32_t holes = 0;
    for (int y = strip.first; y < strip.first + strip.rows; ++y)
      holes += shade_row(
          sources.data(), count, strip, y, cover ? cover->inverse_z->row(y).data() : nullptr,
          cover ? cover->nearest : 0, out.inverse_z.row(y).data(), out.color.row(y).data());
    out.holes_in_strip(i, 0) = holes;
  });
}

void warp_objects(std::span<const WarpedKeyframe> keyframes, const Camera& frame,
                  const WarpedFrame& warped, Image<std::uint32_t>& objects) {
  const std::span<const WarpSource> sources = sources_of(keyframes, frame);
  const int count = int(sources.size());
  fit(objects, frame.width, frame.height);
  parallel_for(0, frame.height, [&](int y) {
    for (int x = 0; x < frame.width; ++x) {
      std::uint32_t& object = objects(x, y);
      object = kNoObject;
      const float w = warped.inverse_z(x, y);
      if (w <= 0 || warped.hole(x, y)) continue;
      // The texel of the surface with the most weight in the colour.
      float most = 0;
      for (int k = 0; k < count; ++k) {
        const WarpSource& source = sources[std::size_t(k)];
        const Keyframe& key = *source.keyframe;
        const float px = float(x) + 0.5f, py = float(y) + 0.5f;
        const auto row = [&](const float(&r)[4]) {
          return r[0] * px + r[1] * py + r[2] + r[3] * w;
        };
        const float z = row(source.from_frame.z);
        if (!(z > 0)) continue;
        const float qx = row(source.from_frame.x) / z - 0.5f,
                    qy = row(source.from_frame.y) / z - 0.5f;
        if (!(qx >= 0 && qy >= 0 && qx < float(key.camera.width - 1) &&
              qy < float(key.camera.height - 1)))
          continue;
        const int ix = int(qx), iy = int(qy);
        for (int i = 0; i < 4; ++i) {
          const float at = key.inverse_z(ix + i % 2, iy + i / 2), there = w / z;
          if (!(std::abs(at - there) <= kSameSurfaceDepth * there)) continue;
          const float ax = qx - float(ix), ay = qy - float(iy);
          const float weight =
              source.weight * (i % 2 ? ax : 1 - ax) * (i / 2 ? ay : 1 - ay) + 1e-6f;
          if (weight > most) most = weight, object = key.object(ix + i % 2, iy + i / 2);
        }
      }
    }
  });
}

}  // namespace rilievo
