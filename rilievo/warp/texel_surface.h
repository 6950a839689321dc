// Which surface do the texels of a picture with depth stand for, and where does a ray hit it?
//
// Each covered texel has a patch of surface through its sample, tilted towards the neighbours that
// it is linked to (texel_links). Beside others it ends, at the texel's edge, flat or continued, but
// never steep: nothing is known of it there. In raster position and disparity (u, v, q = 1 /
// eye_z), a plane of the world is a plane and a ray is a line, so nothing here divides by depth. A
// patch is q0 + slope . (offset from the texel's centre), with a slope for each half of the texel
// in u and in v; patches of linked texels meet halfway.
//
// A ray hits a patch where it crosses it away from the picture's eye: for an ordinary picture from
// nearer to farther, for a back-perspective one from farther to nearer. A ray that passes behind
// the edge of a patch, between texels that are not linked, continues; what it hits next can be
// hidden by something that the picture does not show.
//
// Perspective and back-perspective pictures. Pure.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "rilievo/core/depth_image.h"
#include "rilievo/warp/texel_links.h"

namespace rilievo {

// The patch of one texel.
struct SurfaceTexel {
  float q = 0;  // 1 / eye_z at the centre; 0: the texel shows nothing
  // To the sides, as in texel_links. Diagonally: the corner is closed, so that the four texels
  // around it are linked to each other's sides, and their samples lie almost in one plane.
  std::uint8_t links = 0;
  // Change of q over one texel to the right, down, left, up (outwards).
  std::array<float, 4> slope{};
  // The eye_z down to which the space behind the patch is inside the visual hull, that is not
  // carved by any picture (find_visual_hulls); 0: unknown, or none.
  float inside = 0;
};

// The surface of a picture.
struct TexelSurface {
  Camera camera;
  Image<SurfaceTexel> texels;
};

// Builds the surface. Requires a perspective or back-perspective camera.
[[nodiscard]] TexelSurface make_texel_surface(const DepthImage& picture,
                                              const LinkOptions& options = {});

// The interval of eye_z that a patch covers.
struct DepthInterval {
  float front = 0, back = 0;
};
// The interval of a texel's patch. Requires texel.q != 0.
[[nodiscard]] DepthInterval depth_interval(const SurfaceTexel& texel);

// The disparity q of a texel's patch at raster position `at`, inside the texel or on its edge.
[[nodiscard]] inline double surface_q(const SurfaceTexel& texel, const glm::dvec2& center,
                                      const glm::dvec2& at) {
  const double dx = at.x - center.x, dy = at.y - center.y;
  return double(texel.q) + std::abs(dx) * double(texel.slope[dx >= 0 ? 0 : 2]) +
         std::abs(dy) * double(texel.slope[dy >= 0 ? 1 : 3]);
}

// The patch of a texel and that of a linked neighbour pass for one surface where they nearly meet
// on the border between them: up to this depth, in texels, and as a difference in q.
inline constexpr double kPatchGap = 0.25;
// The largest such difference in q: for a patch with q = 1 in pictures of the camera, and for the
// patch of a texel.
[[nodiscard]] double patch_gap_per_q(const Camera& camera);
[[nodiscard]] double patch_gap(const TexelSurface& surface, const glm::ivec2& texel);

// The weights by which samples are interpolated, at an offset from the texel's centre of at most
// half a texel; they sum to 1. The mean position of the samples is near that point of the patch.
struct SampleWeights {
  glm::ivec2 side{0};                   // -1 or 1 in u and in v: which neighbours
  float own = 1, u = 0, v = 0, uv = 0;  // the texel, (side.u, 0), (0, side.v), side
};
[[nodiscard]] SampleWeights sample_weights(const SurfaceTexel& texel, const glm::dvec2& offset);
// The mean of the samples' values by these weights; value(texel) is a glm vector.
template <class Value>
[[nodiscard]] auto interpolate(const SampleWeights& weights, const glm::ivec2& texel,
                               const Value& value) {
  using Vector = decltype(value(texel));
  using Number = typename Vector::value_type;
  Vector sum = Number(weights.own) * value(texel);
  // Where a weight is 0 there may be no sample.
  const auto add = [&](float weight, int u, int v) {
    if (weight > 0) sum += Number(weight) * value(texel + glm::ivec2(u, v));
  };
  add(weights.u, weights.side.x, 0);
  add(weights.v, 0, weights.side.y);
  add(weights.uv, weights.side.x, weights.side.y);
  return sum;
}

// A line segment in (u, v, q).
struct DisparitySegment {
  glm::dvec3 from, to;
};
// The part of a world-space segment that lies in the camera's frustum; none if it lies outside.
[[nodiscard]] std::optional<DisparitySegment> disparity_segment(const Camera& camera,
                                                                const glm::dvec3& from,
                                                                const glm::dvec3& to);
// The same for end points in homogeneous raster coordinates (u w, v w, w), where w = eye_z.
[[nodiscard]] std::optional<DisparitySegment> disparity_segment_between(const Camera& camera,
                                                                        const glm::dvec3& from,
                                                                        const glm::dvec3& to);

// The result of a height-field ray march. A ray that neither hit nor passed behind an edge crossed
// only free space.
struct SurfaceHit {
  bool hit = false;
  bool passed_behind = false;   // passed behind an edge (before the hit)
  bool passed_end = false;      // passed behind an edge between texels that are not linked
  bool passed_outline = false;  // passed behind an edge next to which the picture shows nothing
  double t = 0;                 // of the hit, along the segment; without a hit, of the last edge
  // Passed behind edges: t of the first one, and where it came out in front again after the last; 1
  // if it did not. Before and after it crossed free space.
  double behind_from = 0, behind_to = 0;
  glm::dvec3 at{0.0};   // u, v, q there
  glm::ivec2 texel{0};  // whose patch was hit; without a hit, the texel beyond the edge
};

// Marches through the texels along the segment to the first hit.
[[nodiscard]] SurfaceHit intersect(const TexelSurface& surface, const DisparitySegment& segment);

}  // namespace rilievo
