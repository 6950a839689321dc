// How much of an object's surface do its pictures hold, and how densely?
//
// The paper leaves open how to ensure that an object is completely represented by its pictures;
// this measures it. Points are spread over the scene's surface, evenly by area, on both sides of
// what is double-sided. A point counts if it is visible from outside: in a straight line from one
// of many viewpoints around the object. A picture samples it if its camera's ray through it keeps
// it: nothing nearer for an ordinary camera, nothing farther for a back-perspective one, the
// surface turned the right way. Points between texels count as sampled: how far apart the texels
// lie on the surface is the spacing. No picture is needed, only the cameras.
//
// World space, metres. Same result for any number of threads and on any machine.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

struct CoverageOptions {
  int points = 20000;          // on the surface, before those that nobody sees are left out
  int viewpoints = 256;        // around the object
  double viewpoint_radii = 4;  // their distance from its centre, in radii of its ball
  std::uint64_t seed = 1;
};

struct SurfacePoint {
  glm::vec3 position{0.0f};
  glm::vec3 normal{0.0f};  // unit, of the side that counts
};

struct Coverage {
  double radius = 0;               // of the ball around the scene, metres
  double visible_share = 0;        // of the surface's area, visible from outside
  double covered_share = 0;        // of what is visible: sampled by at least one picture
  double covered_twice_share = 0;  // ... by at least two
  // The same with every point counted as often as viewpoints see it: what one sees on average from
  // there. A cavity that shows through a crack counts little.
  double covered_seen_share = 0;
  // Of what is visible: distance between the texels of the picture that samples it best, metres;
  // infinite where none does. One a visible point, ascending.
  std::vector<float> spacing;
  std::vector<SurfacePoint> missed;  // visible points that no picture samples
};

// Cameras are perspective or back-perspective.
[[nodiscard]] Coverage analyze_coverage(const RayScene& scene, std::span<const Camera> cameras,
                                        const CoverageOptions& options = {});

// The share of visible surface with texels no farther apart than `spacing` metres.
[[nodiscard]] double share_within(const Coverage& coverage, double spacing);

// The steps of analyze_coverage. Points spread evenly over the surface; texels cut out by a mask
// are no surface.
[[nodiscard]] std::vector<SurfacePoint> spread_points(const RayScene& scene,
                                                      const CoverageOptions& options);
// Directions of `count` points spread evenly over the unit sphere (a Fibonacci lattice).
[[nodiscard]] std::vector<glm::dvec3> spread_directions(int count);
// Distance between the camera's texels on the surface around the point, if it samples the point;
// else infinite.
[[nodiscard]] double sample_spacing(const RayScene& scene, const Camera& camera,
                                    const SurfacePoint& point);

}  // namespace rilievo
