// The ray's side of a piece is the sign of
//
//   s(t) = sigma (q_ray(t) - q_piece(u(t), v(t))),   sigma = +1 ordinary, -1 back-perspective
//
// which is positive in front of the surface, where the picture's rays came through empty space.
// Walking from texel to texel, a hit is where s turns from positive to not positive: inside a
// texel, or on the border of two linked texels, whose pieces may differ there by the twist of the
// surface. Where they differ by more, as beside an end, a ray between them passes behind an edge.
// Over texels that show nothing the ray is in front.
//
// Samples S of the texel and its linked neighbours, at offsets f_u and f_v from its centre: the
// plane through three of them is S + f_u (S_u - S) + f_v (S_v - S), and so is the patch, but for a
// little where q changes much over a texel. A fourth, across a closed corner, makes that bilinear,
// so that colours are continuous there, and the place between the four lies a quarter of the twist
// from the patch at most.

#include "rilievo/warp/texel_surface.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Slots of SurfaceTexel::slope in kLinkSteps.
constexpr std::array<int, 4> kSlopeLink{0, 2, 4, 6};
// Depth per lateral distance, where the surface ends: more would draw spikes far from any sample.
constexpr float kEndSlope = 2.0f;
// Depth by which a sample may be off the plane of three others around a closed corner, in texels:
// so patches nearly meet there, as far from the samples as they do.
constexpr float kTwist = 2 * float(kPatchGap);

// The sides of a texel where eye_z = 1, and the smaller one.
glm::dvec2 texel_size(const Camera& camera) {
  const auto& [l, r, b, t] = camera.window;
  return {(r - l) / camera.width, (t - b) / camera.height};
}
double smaller_side(const Camera& camera) {
  const glm::dvec2 size = texel_size(camera);
  return std::min(size.x, size.y);
}

// Which corners are closed? Those around which all four texels are linked to those beside them and
// have samples almost in one plane.
void close_corners(TexelSurface& surface) {
  const auto texel = float(smaller_side(surface.camera));
  Image<SurfaceTexel>& texels = surface.texels;
  for (SurfaceTexel& t : texels.texels()) t.links &= 0b01010101;
  for (int y = 0; y + 1 < texels.height(); ++y)
    for (int x = 0; x + 1 < texels.width(); ++x) {
      SurfaceTexel &a = texels(x, y), &b = texels(x + 1, y), &c = texels(x, y + 1),
                   &d = texels(x + 1, y + 1);
      const bool linked =
          (a.links & 1) && (a.links >> 2 & 1) && (d.links >> 4 & 1) && (d.links >> 6 & 1);
      if (!linked || !(std::abs(a.q + d.q - b.q - c.q) <= kTwist * texel * a.q)) continue;
      a.links |= 1 << 1, b.links |= 1 << 3, d.links |= 1 << 5, c.links |= 1 << 7;
    }
}

// The bit of the link from a texel to the neighbour at `step`; -1 if that is not a neighbour.
int link_of(const glm::ivec2& step) {
  for (int k = 0; k < 8; ++k)
    if (kLinkSteps[k] == step) return k;
  return -1;
}

// A ray over a surface.
struct TexelMarch {
  const TexelSurface& surface;
  const DisparitySegment& segment;
  double sigma;

  [[nodiscard]] glm::dvec3 at(double t) const { return glm::mix(segment.from, segment.to, t); }
  // Positive in front of the texel's patch.
  [[nodiscard]] double side(const glm::ivec2& texel, double t) const {
    const SurfaceTexel& piece = surface.texels(texel.x, texel.y);
    if (piece.q == 0) return 1;
    const glm::dvec3 p = at(t);
    return sigma * (p.z - surface_q(piece, glm::dvec2(texel) + 0.5, glm::dvec2(p)));
  }
  [[nodiscard]] bool linked(const glm::ivec2& last, const glm::ivec2& texel) const {
    return surface.texels(last.x, last.y).links >> link_of(texel - last) & 1;
  }
  // Crossing the border to a texel at t, from in front of the patch of the one at `last` to behind
  // the other's: do the two pass for one surface there? They are linked, and nearly meet.
  [[nodiscard]] bool meets(const glm::ivec2& last, const glm::ivec2& texel, double t) const {
    return linked(last, texel) && side(last, t) - side(texel, t) <= patch_gap(surface, last);
  }
  // The intersection with the patch between t0 (in front) and t1 (not in front): a line meets a
  // plane in each interval between the texel's middle lines.
  [[nodiscard]] double root(const glm::ivec2& texel, double t0, double t1) const {
    std::array<double, 2> middle;
    for (int a = 0; a < 2; ++a)
      middle[a] = std::clamp((texel[a] + 0.5 - segment.from[a]) / (segment.to[a] - segment.from[a]),
                             t0, t1);
    double s0 = side(texel, t0);
    for (double t : {std::min(middle[0], middle[1]), std::max(middle[0], middle[1]), t1}) {
      if (!(t > t0)) continue;  // also where the segment does not move in u or in v
      const double s = side(texel, t);
      if (s <= 0) return t0 + (t - t0) * s0 / (s0 - s);
      t0 = t, s0 = s;
    }
    return t1;
  }
};

}  // namespace

DepthInterval depth_interval(const SurfaceTexel& texel) {
  RILIEVO_EXPECTS(texel.q != 0);
  // A sum of a part in u and a part in v, each 0 at the centre and linear to either side.
  const auto& [right, down, left, up] = texel.slope;
  const float low = std::min({0.0f, right, left}) + std::min({0.0f, down, up});
  const float high = std::max({0.0f, right, left}) + std::max({0.0f, down, up});
  return {1 / (texel.q + 0.5f * high), 1 / (texel.q + 0.5f * low)};
}

double patch_gap_per_q(const Camera& camera) { return kPatchGap * smaller_side(camera); }

double patch_gap(const TexelSurface& surface, const glm::ivec2& texel) {
  return patch_gap_per_q(surface.camera) * double(surface.texels(texel.x, texel.y).q);
}

SampleWeights sample_weights(const SurfaceTexel& texel, const glm::dvec2& offset) {
  SampleWeights weights;
  weights.side = {offset.x >= 0 ? 1 : -1, offset.y >= 0 ? 1 : -1};
  const int u = weights.side.x > 0 ? 0 : 4, v = weights.side.y > 0 ? 2 : 6;
  const int uv = u == 0 ? (v == 2 ? 1 : 7) : (v == 2 ? 3 : 5);  // in kLinkSteps
  const auto linked = [&](int k) { return (texel.links >> k & 1) != 0; };
  const auto f = glm::vec2(glm::min(glm::abs(offset), 0.5));
  weights.u = linked(u) ? f.x : 0.0f;
  weights.v = linked(v) ? f.y : 0.0f;
  if (linked(uv)) {
    weights.uv = weights.u * weights.v;
    weights.u -= weights.uv;
    weights.v -= weights.uv;
  }
  weights.own = 1 - weights.u - weights.v - weights.uv;
  return weights;
}

TexelSurface make_texel_surface(const DepthImage& picture, const LinkOptions& options) {
  RILIEVO_EXPECTS(picture.camera.projection != Projection::parallel);
  const Image<float> eye_z = eye_z_of(picture);
  const Image<std::uint8_t> links = texel_links(picture, options);
  const int w = eye_z.width(), h = eye_z.height();
  const glm::vec2 size(texel_size(picture.camera));
  TexelSurface surface{picture.camera, Image<SurfaceTexel>(w, h)};
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      if (eye_z(x, y) == kNoDepth) continue;
      SurfaceTexel& texel = surface.texels(x, y);
      texel.q = 1.0f / eye_z(x, y);
      texel.links = links(x, y);
      std::array<bool, 4> linked{};
      for (int side = 0; side < 4; ++side) {
        const int k = kSlopeLink[side];
        linked[side] = texel.links >> k & 1;
        if (linked[side])
          texel.slope[side] = 1.0f / eye_z(x + kLinkSteps[k].x, y + kLinkSteps[k].y) - texel.q;
      }
      // Where the surface ends it goes on straight to the texel's edge.
      for (int side = 0; side < 4; ++side) {
        if (linked[side] || !linked[(side + 2) % 4]) continue;
        const float steepest = kEndSlope * size[side % 2] * texel.q;
        texel.slope[side] = std::clamp(-texel.slope[(side + 2) % 4], -steepest, steepest);
      }
    }
  close_corners(surface);
  return surface;
}

std::optional<DisparitySegment> disparity_segment(const Camera& camera, const glm::dvec3& from,
                                                  const glm::dvec3& to) {
  RILIEVO_EXPECTS(camera.projection != Projection::parallel);
  const glm::dmat4 eye_from = eye_from_world(camera);
  const ImageWindow& window = camera.window;
  const auto homogeneous = [&](const glm::dvec3& world) {
    const glm::dvec3 eye(eye_from * glm::dvec4(world, 1));
    const double w = -eye.z;
    return glm::dvec3((eye.x - window.left * w) / (window.right - window.left) * camera.width,
                      (window.top * w - eye.y) / (window.top - window.bottom) * camera.height, w);
  };
  return disparity_segment_between(camera, homogeneous(from), homogeneous(to));
}

std::optional<DisparitySegment> disparity_segment_between(const Camera& camera, const glm::dvec3& p,
                                                          const glm::dvec3& q) {
  // All is linear in homogeneous coordinates.
  double t0 = 0, t1 = 1;
  const auto clip = [&](double at_from, double at_to) {  // keeps where the value is >= 0
    if (at_from < 0 && at_to < 0) t1 = -1;
    if (at_from < 0 && at_to >= 0) t0 = std::max(t0, at_from / (at_from - at_to));
    if (at_from >= 0 && at_to < 0) t1 = std::min(t1, at_from / (at_from - at_to));
  };
  clip(p.z - camera.z_near, q.z - camera.z_near);
  clip(camera.z_far - p.z, camera.z_far - q.z);
  clip(p.x, q.x);
  clip(p.y, q.y);
  clip(camera.width * p.z - p.x, camera.width * q.z - q.x);
  clip(camera.height * p.z - p.y, camera.height * q.z - q.y);
  if (!(t0 < t1)) return std::nullopt;
  const glm::dvec3 a = glm::mix(p, q, t0), c = glm::mix(p, q, t1);
  return DisparitySegment{{a.x / a.z, a.y / a.z, 1 / a.z}, {c.x / c.z, c.y / c.z, 1 / c.z}};
}

SurfaceHit intersect(const TexelSurface& surface, const DisparitySegment& segment) {
  const TexelMarch walker{surface, segment, surface.camera.keeps_farthest() ? -1.0 : 1.0};
  const glm::dvec2 from(segment.from), step(segment.to - segment.from);
  const glm::ivec2 size{surface.texels.width(), surface.texels.height()};
  glm::ivec2 texel = glm::clamp(glm::ivec2(glm::floor(from)), glm::ivec2(0), size - 1);

  // t of the next border in u and in v, and between borders.
  glm::dvec2 next, spacing;
  glm::ivec2 forward;
  for (int a = 0; a < 2; ++a) {
    forward[a] = step[a] >= 0 ? 1 : -1;
    const bool moves = std::abs(step[a]) > 1e-12;
    spacing[a] = moves ? 1 / std::abs(step[a]) : 1e300;
    next[a] = moves ? (texel[a] + (step[a] >= 0) - from[a]) / step[a] : 1e300;
  }

  SurfaceHit march;
  double t = 0, side = walker.side(texel, 0);
  march.passed_behind = march.passed_end = march.passed_outline = side <= 0;
  bool behind = side <= 0;
  const auto stop = [&](const glm::ivec2& where, double when) {
    march.t = when;
    march.at = walker.at(when);
    march.texel = where;
  };
  for (;;) {
    const double end = std::min({next.x, next.y, 1.0});
    const double side_end = walker.side(texel, end);
    if (behind && (side > 0 || side_end > 0)) march.behind_to = side > 0 ? t : end, behind = false;
    if (side > 0 && side_end <= 0) {
      march.hit = true;
      stop(texel, walker.root(texel, t, end));
      return march;
    }
    if (end >= 1) break;
    const glm::ivec2 before = texel;
    const int axis = next.x <= next.y ? 0 : 1;
    texel[axis] += forward[axis];
    next[axis] += spacing[axis];
    t = end;
    if (texel[axis] < 0 || texel[axis] >= size[axis]) break;
    side = walker.side(texel, t);
    if (side_end > 0 && side <= 0) {
      const SurfaceTexel& beyond = surface.texels(before.x, before.y);
      march.hit = walker.meets(before, texel, t);
      stop(march.hit ? texel : before, t);
      if (march.hit) return march;
      if (!march.passed_behind) march.behind_from = t;
      march.passed_behind = behind = true;
      march.passed_end = march.passed_end || !walker.linked(before, texel);
      march.passed_outline = march.passed_outline || beyond.q == 0;
    }
  }
  if (behind) march.behind_to = 1;
  return march;
}

}  // namespace rilievo
