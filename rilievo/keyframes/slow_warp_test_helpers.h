// The slow twin of keyframes/warp_keyframes.h, for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "rilievo/keyframes/warp_keyframes.h"

namespace rilievo {

inline constexpr std::uint32_t kOpaque = 0xff000000u;

inline float apply(const float (&row)[4], float x, float y, float w) {
  return row[0] * x + (row[1] * y + row[2]) + row[3] * w;
}

// The definition of warp_keyframes(), pixel by pixel: no strips, no vectors, no ranges.
struct SlowWarp {
  struct Lookup {
    float r = 0, g = 0, b = 0, weight = 0, cover = 0, front = 0, own = 0;
    bool too_near = false;
  };
  std::span<const WarpedKeyframe> keys;
  Camera frame;
  const WarpCover* cover;
  bool closes_cracks = true;
  Image<float> depth;  // with a border of one pixel

  float& at(int x, int y) { return depth(x + 1, y + 1); }
  static float scale(const Camera& frame, const Camera& key) {
    const auto per_tangent = [](const Camera& c) {
      return c.width / (c.window.right - c.window.left);
    };
    return float(per_tangent(frame) / per_tangent(key));
  }

  void splat(const Keyframe& key) {
    const RasterMap map = raster_map(frame, key.camera);
    const float texel = scale(frame, key.camera);
    struct Place {
      float x, y, z, w;

      [[nodiscard]] float farther(const Place& from) const {
        return std::max(std::abs(x - from.x), std::abs(y - from.y));
      }
    };
    const auto place = [&](int x, int y, float w) {
      const float px = float(x) + 0.5f, py = float(y) + 0.5f, z = apply(map.z, px, py, w);
      const float per_z = 1 / std::max(z, 1e-6f);
      return Place{apply(map.x, px, py, w) * per_z - 0.5f, apply(map.y, px, py, w) * per_z - 0.5f,
                   z, w * per_z};
    };
    for (int y = 0; y < key.camera.height; ++y)
      for (int x = 0; x < key.camera.width; ++x) {
        const float w = key.inverse_z(x, y);
        const Place here = place(x, y, w);
        if (!(w > 0) || !(here.z > 1e-6f) || here.w > float(1 / frame.z_near)) continue;
        const float half = kHalfSquare * std::min(std::max(1 / here.z * texel, 1.0f),
                                                  kLargestSquare * std::max(1.0f, texel));
        // Rows above and below the frame count as neighbours, columns beside it do not.
        const int top = std::max(-1, int(std::clamp(here.y - half, -2.0f, 1e6f))),
                  left = std::max(0, int(std::clamp(here.x - half, -2.0f, 1e6f)));
        for (int row = top; row <= std::min(float(frame.height), here.y + half); ++row)
          for (int column = left; column <= std::min(float(frame.width - 1), here.x + half);
               ++column)
            if (float(row) >= here.y - half && float(row) <= here.y + half &&
                float(column) >= here.x - half && float(column) <= here.x + half)
              at(column, row) = std::max(at(column, row), here.w);
        if (!closes_cracks || here.farther(place(x, y, 0)) <= kCrackParallax) continue;
        for (const auto& [nx, ny] : {std::pair{x + 1, y}, std::pair{x, y + 1}}) {
          if (nx >= key.camera.width || ny >= key.camera.height) continue;
          const float depth_there = key.inverse_z(nx, ny);
          const Place next = place(nx, ny, depth_there);
          const float apart = next.farther(here);
          const float deeper = std::abs(depth_there - w);
          if (!(depth_there > 0) || deeper <= kLeastSlant * w || deeper > kSameSurfaceDepth * w ||
              !(next.z > 1e-6f) || next.w > float(1 / frame.z_near) || apart <= 2 * half ||
              apart > kWidestCrack)
            continue;
          const bool across = std::abs(next.x - here.x) >= std::abs(next.y - here.y);
          for (int row = -1; row <= frame.height; ++row)
            for (int column = 0; column < frame.width; ++column) {
              const float along = float(across ? column : row),
                          aside = float(across ? row : column);
              const float begin = across ? here.x : here.y,
                          step = across ? next.x - here.x : next.y - here.y,
                          beside = across ? here.y : here.x,
                          step_beside = across ? next.y - here.y : next.x - here.x;
              if (along < std::min(begin, begin + step) || along > std::max(begin, begin + step))
                continue;
              const float way = std::clamp((along - begin) / step, 0.0f, 1.0f);
              const float middle = beside + way * step_beside;
              if (aside < middle - half || aside > middle + half) continue;
              at(column, row) = std::max(at(column, row), here.w + way * (next.w - here.w));
            }
        }
      }
  }

  bool seen_until(float px, float py, float w) const {
    return std::ranges::any_of(keys, [&](const WarpedKeyframe& one) {
      const Camera& camera = one.keyframe->camera;
      const RasterMap map = raster_map(camera, frame);
      const float z = apply(map.z, px, py, w), per_z = 1 / std::max(z, 1e-6f);
      const float x = apply(map.x, px, py, w) * per_z, y = apply(map.y, px, py, w) * per_z;
      if (!(z > 1e-6f && x >= 0 && y >= 0 && x < float(camera.width) && y < float(camera.height)))
        return false;
      return std::abs(one.keyframe->inverse_z(int(x), int(y))) <=
             w * per_z * (1 + kSameSurfaceDepth);
    });
  }

  Lookup find(float px, float py, float w, bool mixes) const {
    Lookup found;
    for (const bool spare : {false, true})
      for (const WarpedKeyframe& one : keys) {
        if (one.spare != spare || (spare && found.cover >= kAllShown)) continue;
        const Keyframe& key = *one.keyframe;
        const RasterMap map = raster_map(key.camera, frame);
        const float z = apply(map.z, px, py, w);
        const float per_z = 1 / std::max(z, 1e-6f);
        const int finer = key.quarters() ? 2 : 1;
        const float qx = apply(map.x, px, py, w) * (per_z * float(finer)) - 0.5f,
                    qy = apply(map.y, px, py, w) * (per_z * float(finer)) - 0.5f;
        if (!(z > 1e-6f && qx >= 0 && qy >= 0 && qx < float(finer * key.camera.width - 1) &&
              qy < float(finer * key.camera.height - 1)))
          continue;
        if (z > kMostMagnified) {
          found.too_near = true;
          continue;
        }
        const int ix = int(qx), iy = int(qy);
        const float ax = qx - float(ix), ay = qy - float(iy), there = w * per_z;
        int shown = 0, sure = 0, known = 0, front = 0, r = 0, g = 0, b = 0;
        for (int i = 0; i < 4; ++i) {
          const int x = ix + i % 2, y = iy + i / 2;
          const float across = (i % 2 ? ax : 1 - ax) * float(kTexelWeights);
          const int all = int(across * (i / 2 ? ay : 1 - ay));
          const std::uint32_t color = key.color(x, y);
          const auto shows = Quarter(color >> 30);
          const float depth = key.inverse_z(x / finer, y / finer),
                      slack = kSameSurfaceDepth * there;
          if (depth < 0) continue;  // hidden
          const bool same = std::abs(depth - there) <= slack, before = depth < there - slack;
          if ((same && shows == Quarter::own) || (before && shows == Quarter::nearer))
            front += all * int(2 + (color >> 27 & 7));
          else if ((same || before) && shows != Quarter::nearer)
            front += all * int(color >> 24 & 7);
          if (!same) continue;
          const bool mixed = mixes && std::max(z * scale(frame, key.camera), 1.0f) < kMostMixed;
          const int weight = shows == Quarter::own ? all : mixed ? all >> kOtherQuarterShift : 0;
          shown += all, sure += weight, known += shows == Quarter::own ? all : 0;
          r += weight * int(color & 255), g += weight * int(color >> 8 & 255);
          b += weight * int(color >> 16 & 255);
        }
        found.cover = std::max(found.cover, float(shown));
        found.own = std::max(found.own, float(known));
        if (sure == 0) continue;
        const float magnified = std::max(z * scale(frame, key.camera), 1.0f);
        const float counts = one.weight / (magnified * magnified);
        found.r += counts * float(r), found.g += counts * float(g), found.b += counts * float(b);
        const float counted = counts * float(sure);
        found.weight += counted, found.front += counted * float(front);
      }
    return found;
  }

  void draw(Image<std::uint32_t>& color, Image<float>& inverse_z) {
    depth = Image<float>(frame.width + 2, frame.height + 2);
    for (const WarpedKeyframe& one : keys) splat(*one.keyframe);
    color = Image<std::uint32_t>(frame.width, frame.height);
    inverse_z = Image<float>(frame.width, frame.height);
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x) {
        const float px = float(x) + 0.5f, py = float(y) + 0.5f;
        const float around[4] = {at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)};
        const float own = at(x, y), times = 1 + kSameSurfaceDepth;
        const float hides = cover ? (*cover->inverse_z)(x, y) : 0;
        if (hides > own) {
          if (hides > cover->nearest || seen_until(px, py, hides)) color(x, y) = kCoveredPixel;
          continue;
        }
        const float nearest = *std::max_element(around, around + 4),
                    farthest = *std::min_element(around, around + 4);
        const bool is_behind = nearest > own * times;
        const bool edge = is_behind || own > farthest * times;
        const float front = is_behind ? nearest : own, back = is_behind ? own : farthest;
        const Lookup nearer = find(px, py, front, edge || front > 0);
        Lookup farther;
        if (edge) farther = find(px, py, back, true);
        const bool known = nearer.cover > kLeastShown && nearer.weight > 0;
        const bool left_behind = nearer.too_near && !known;
        const bool behind = !left_behind && farther.cover > kLeastShown && farther.weight > 0;
        if (!behind && !(known && (edge || nearer.own > 0))) continue;
        const float covers = nearer.front / (nearer.weight > 0 ? nearer.weight : 1);
        const float part = behind ? std::min(covers * (1.0f / (6 * kTexelWeights)), 1.0f) : 1.0f;
        const auto byte = [&](float of_nearer, float of_farther) {
          const auto share = [](const Lookup& of, float sum, float part) {
            return sum * (part / (of.weight > 0 ? of.weight : 1));
          };
          const float value =
              share(farther, of_farther, behind ? 1 - part : 0) + share(nearer, of_nearer, part);
          return std::uint32_t(std::min(value + 0.5f, 255.0f));
        };
        color(x, y) = kOpaque | byte(nearer.r, farther.r) | byte(nearer.g, farther.g) << 8 |
                      byte(nearer.b, farther.b) << 16;
        inverse_z(x, y) = behind && part < 0.5f ? back : front;
      }
  }
};

}  // namespace rilievo
