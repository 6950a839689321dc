// From which directions is an object pictured, and which pictures serve the direction it is now
// seen from?
//
// A direction is a unit vector from the object's centre towards the viewer whom the picture serves
// best. Directions are spread by a dodecahedron (S2.2): along its 12 face normals, through its 20
// vertices, or both. Neighbours are the corners of the spherical triangles between them (S2.6).
// Pure; doubles; world space.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"

namespace rilievo {

enum class ViewSpread {
  faces_12,     // normals of the dodecahedron's faces
  vertices_20,  // directions of its vertices
  both_32,
  ring,  // evenly around `up`, at right angles to it
};

struct ViewSetOptions {
  ViewSpread spread = ViewSpread::both_32;
  bool hemisphere = false;  // only directions at or above the horizon; not for a ring
  int ring = 8;             // views of a ring, 3 to 1024
  glm::dvec3 up{0, 1, 0};   // the axis of hemisphere and ring
};

struct ViewSet {
  std::vector<glm::dvec3> directions;  // unit
  // Counter-clockwise seen from outside; they cover the sphere, or what the restriction left of
  // it. Empty for a ring, whose neighbours are `edges`.
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> edges;  // each once, smaller index first, ascending
};

// Requires a non-zero `up` and 3 <= ring <= 1024.
[[nodiscard]] ViewSet make_view_set(const ViewSetOptions& options);

// The neighbourhood of any directions, for instance of those read from a file: triangles of the
// convex hull. Directions within half a sphere are closed off below, by no triangle. At least one
// direction; all unit and distinct.
[[nodiscard]] ViewSet view_set_from_directions(std::vector<glm::dvec3> directions);

// Which pictures serve a viewer in direction `towards_viewer`? views[0] is the nearest, then the
// two others of the triangle that holds the direction, nearer first, or of the triangle or edge
// closest to holding it; -1 where there is none. weights are barycentric in that triangle, not
// negative, and sum to 1.
struct ViewPick {
  std::array<int, 3> views{-1, -1, -1};
  std::array<double, 3> weights{0, 0, 0};
};
[[nodiscard]] ViewPick pick_views(const ViewSet& set, const glm::dvec3& towards_viewer);
// The same around any view: views[0] is `view`, of whose triangles one is chosen.
[[nodiscard]] ViewPick pick_views_around(const ViewSet& set, int view,
                                         const glm::dvec3& towards_viewer);

// The views nearest to the direction, nearest first, as many as `out` has room for; how many those
// are. Allocates nothing.
int nearest_views(const ViewSet& set, const glm::dvec3& towards_viewer, std::span<int> out);

// How much each of the views that nearest_views() gave shows, so that nothing jumps when another
// becomes the nearest: by how much farther than the nearest it lies, its weight falls linearly to
// nothing at `zone` radians. The weights sum to 1; zone 0 leaves the nearest alone.
void handover_weights(const ViewSet& set, const glm::dvec3& towards_viewer, double zone,
                      std::span<const int> views, std::span<float> weights);

// Mean angle between neighbours, radians; 0 if there are none.
[[nodiscard]] double mean_spacing(const ViewSet& set);

struct ViewCameraOptions {
  Projection projection = Projection::back_perspective;
  int size = 256;  // texels, square
  // From the centre of the box to the apex (or eye), in radii of the ball around the box. The ball
  // fills a cone of 2 asin(1 / distance): 60 degrees at 2. Must be above 1.
  double distance = 2.0;
};

// The camera that pictures `box` for viewers in `direction`: its apex lies behind the box, the eye
// of an ordinary perspective in front; its window is tight around the box, so that texels need not
// be square. Nothing if the box is empty or not finite.
[[nodiscard]] Result<Camera> view_camera(const Box& box, const glm::dvec3& direction,
                                         const ViewCameraOptions& options);

}  // namespace rilievo
