// Which surface do the texels of a picture with depth stand for, and where does a ray meet it?
//
// Over each covered texel lies a piece of surface through the texel's sample, tilted towards the
// neighbours it is linked to (texel_links) and flat or continued where there is none. In raster
// position and disparity (u, v, q = 1 / eye_z) a plane of the world is a plane and a ray is a
// line, so that nothing here divides by depth: the piece is q0 + slope . (offset from the texel's
// centre), with a slope for each half of the texel in u and in v; across linked texels the pieces
// meet halfway.
//
// A ray hits a piece where it passes from the side that the picture's rays come from to beyond it:
// for an ordinary picture from nearer to farther, for a back-perspective one from farther to
// nearer. Where it passes behind the edge of a piece, between texels that are not linked, it goes
// on; what it meets there may be hidden by something that the picture does not show.
//
// Perspective and back-perspective pictures. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "rilievo/core/depth_image.h"
#include "rilievo/warp/texel_links.h"

namespace rilievo {

struct SurfaceTexel {
  float q = 0;  // 1 / eye_z at the centre; 0: nothing
  std::uint8_t links = 0;
  // Change of q over one texel to the right, down, left, up (all outwards).
  std::array<float, 4> slope{};
  // eye_z down to which the space behind it is seen to be empty by no picture (find_inside); 0: not
  // known, or none is.
  float inside = 0;
};

struct TexelSurface {
  Camera camera;
  Image<SurfaceTexel> texels;
};

// Requires a perspective or back-perspective camera.
[[nodiscard]] TexelSurface make_texel_surface(const DepthImage& picture,
                                              const LinkOptions& options = {});

// The eye_z between which the piece over a texel lies. Requires texel.q != 0.
struct DepthInterval {
  float front = 0, back = 0;
};
[[nodiscard]] DepthInterval depth_interval(const SurfaceTexel& texel);

// q of the piece over texel (x, y) at raster position `at`, inside or at the edge of the texel.
[[nodiscard]] double surface_q(const SurfaceTexel& texel, const glm::dvec2& center,
                               const glm::dvec2& at);

// A line in (u, v, q).
struct DisparitySegment {
  glm::dvec3 from, to;
};
// The part of a world-space segment that lies in the camera's frustum; nothing if none does.
[[nodiscard]] std::optional<DisparitySegment> disparity_segment(const Camera& camera,
                                                                const glm::dvec3& from,
                                                                const glm::dvec3& to);

// What became of a ray on its way. If it neither hit nor passed behind, what it looked for is not
// there: all of its way was seen to be empty.
struct SurfaceWalk {
  bool hit = false;
  bool passed_behind = false;   // did it pass behind an edge (before it hit)?
  bool passed_outline = false;  // ... behind one next to which the picture shows nothing?
  double t = 0;                 // of the hit, along the segment; without one, of the last edge
  glm::dvec3 at{0.0};           // u, v, q there
  glm::ivec2 texel{0};          // of the surface that was hit; without a hit, that beyond the edge
};

// Walks the texels under the segment.
[[nodiscard]] SurfaceWalk intersect(const TexelSurface& surface, const DisparitySegment& segment);

}  // namespace rilievo
