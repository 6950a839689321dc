// A plane is affine in disparity q = 1 / eye_z over a perspective picture (in eye_z itself over a
// parallel one), however steep it lies: its steps in q repeat exactly from texel to texel. So
// between texels A and B with their outer neighbours A' and B' on the same line
//
//     A' -- A -- B -- B'        step s = q_B - q_A
//
// a large step s is a steep surface if a step beside it, q_A - q_A' or q_B' - q_B, goes the same
// way and is at least s / growth; otherwise it is a jump to another surface.

#include "rilievo/warp/texel_links.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

struct Grid {
  const Image<float>& eye_z;
  bool parallel;

  [[nodiscard]] bool covered(glm::ivec2 p) const {
    return p.x >= 0 && p.y >= 0 && p.x < eye_z.width() && p.y < eye_z.height() &&
           eye_z(p.x, p.y) != kNoDepth;
  }
  [[nodiscard]] float disparity(glm::ivec2 p) const {
    return parallel ? eye_z(p.x, p.y) : 1.0f / eye_z(p.x, p.y);
  }
};

// Both texels are covered. `lateral` is their distance on the image plane of eye_z = 1 (of any
// eye_z for a parallel camera).
bool linked(const Grid& grid, glm::ivec2 a, glm::ivec2 b, float lateral,
            const LinkOptions& options) {
  const float za = grid.eye_z(a.x, a.y), zb = grid.eye_z(b.x, b.y);
  const float width = grid.parallel ? lateral : lateral * std::min(za, zb);
  const float slope = std::abs(zb - za) / width;
  if (slope <= options.gentle) return true;
  if (slope > options.steepest) return false;
  const float step = grid.disparity(b) - grid.disparity(a);
  const glm::ivec2 before = a - (b - a), after = b + (b - a);
  const float sign = step < 0 ? -1.0f : 1.0f;
  float beside = 0.0f;
  if (grid.covered(before))
    beside = std::max(beside, sign * (grid.disparity(a) - grid.disparity(before)));
  if (grid.covered(after))
    beside = std::max(beside, sign * (grid.disparity(after) - grid.disparity(b)));
  return sign * step <= options.growth * beside;
}

}  // namespace

Image<float> eye_z_of(const DepthImage& picture) {
  const int w = picture.depth.width(), h = picture.depth.height();
  if (picture.depth_kind == DepthKind::eye_z) return picture.depth;
  Image<float> eye_z(w, h, kNoDepth);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (picture.covered(x, y))
        eye_z(x, y) = float(eye_z_from(picture.depth_kind, picture.depth(x, y), picture.camera,
                                       {x + 0.5, y + 0.5}));
  return eye_z;
}

Image<std::uint8_t> texel_links(const DepthImage& picture, const LinkOptions& options) {
  const Camera& camera = picture.camera;
  const Image<float> eye_z = eye_z_of(picture);
  const Grid grid{eye_z, camera.projection == Projection::parallel};
  const float du = float((camera.window.right - camera.window.left) / camera.width);
  const float dv = float((camera.window.top - camera.window.bottom) / camera.height);
  const int w = eye_z.width(), h = eye_z.height();
  Image<std::uint8_t> links(w, h, 0);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const glm::ivec2 a{x, y};
      if (!grid.covered(a)) continue;
      for (int k = 0; k < 4; ++k) {
        const glm::ivec2 b = a + kLinkSteps[k];
        if (!grid.covered(b)) continue;
        const float lateral = std::hypot(du * float(kLinkSteps[k].x), dv * float(kLinkSteps[k].y));
        if (!linked(grid, a, b, lateral, options)) continue;
        links(a.x, a.y) = std::uint8_t(links(a.x, a.y) | 1u << k);
        links(b.x, b.y) = std::uint8_t(links(b.x, b.y) | 1u << (k + 4));
      }
    }
  return links;
}

}  // namespace rilievo
