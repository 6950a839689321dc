// The share of an object's surface that its pictures sample, and the spacing of the samples.
//
// The paper leaves open how to ensure that an object is completely represented by its pictures;
// this measures it. Points are distributed over the scene's surface, evenly by area, on both sides
// of double-sided surfaces. A point counts if it is visible in a straight line from one of many
// viewpoints around the object. A picture samples a point if its camera's ray through the point
// keeps it: nothing is nearer (for a back-perspective camera: farther), and the surface faces the
// camera. Points between texels count as sampled; the distance of the texels on the surface is the
// spacing. Only the cameras are needed, not their pictures.
//
// World space, metres. The result does not depend on the number of threads or the machine.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo::bench {

// The number of samples of the measurement.
struct CoverageOptions {
  int points = 20000;          // on the surface, before invisible ones are removed
  int viewpoints = 256;        // around the object
  double viewpoint_radii = 4;  // distance from its centre, in radii of its ball
  std::uint64_t seed = 1;
};

// A point of the surface and the side that counts.
struct SurfacePoint {
  glm::vec3 position{0.0f};
  glm::vec3 normal{0.0f};  // unit
};

// The result. Shares are between 0 and 1.
struct Coverage {
  double radius = 0;               // of the ball around the scene, metres
  double visible_share = 0;        // of the surface's area: visible from outside
  double covered_share = 0;        // of the visible surface: sampled by at least one picture
  double covered_twice_share = 0;  // ... by at least two pictures
  // The same with each point weighted by the number of viewpoints that see it: the average over
  // views. A cavity that shows through a crack has little weight.
  double covered_seen_share = 0;
  // Of each visible point: the distance between the texels of the picture that samples it best, in
  // metres, infinite if none does. Ascending.
  std::vector<float> spacing;
  std::vector<SurfacePoint> missed;  // visible points that no picture samples
};

// Measures the pictures of these cameras, which are perspective or back-perspective.
[[nodiscard]] Coverage analyze_coverage(const RayScene& scene, std::span<const Camera> cameras,
                                        const CoverageOptions& options = {});

// The share of the visible surface whose texels lie at most `spacing` metres apart.
[[nodiscard]] double share_within(const Coverage& coverage, double spacing);

// The steps of analyze_coverage, exposed for tests. First: points distributed evenly over the
// surface, except where a mask cuts texels out.
[[nodiscard]] std::vector<SurfacePoint> spread_points(const RayScene& scene,
                                                      const CoverageOptions& options);
// The directions of `count` points distributed evenly over the unit sphere (a Fibonacci lattice).
[[nodiscard]] std::vector<glm::dvec3> spread_directions(int count);
// The distance between the camera's texels on the surface around the point, metres; infinite if the
// camera does not sample the point.
[[nodiscard]] double sample_spacing(const RayScene& scene, const Camera& camera,
                                    const SurfacePoint& point);

}  // namespace rilievo::bench
