// From which directions is an object captured, and which of its pictures are drawn for an eye?
//
// A direction is a unit vector from the object's centre towards the viewer whom the picture serves
// best. Directions come from a dodecahedron (S2.2): its 12 face normals, its 20 vertices, or both.
// Neighbours are the corners of the spherical triangles between them (S2.6). Pure; doubles; world
// space.
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

// How the directions are distributed.
enum class ViewSpread {
  faces_12,     // normals of the dodecahedron's faces
  vertices_20,  // directions of its vertices
  both_32,
  ring,  // evenly around `up`, perpendicular to it
};

// Which directions a view set has.
struct ViewSetOptions {
  ViewSpread spread = ViewSpread::both_32;
  bool hemisphere = false;  // only directions at or above the horizon; not for a ring
  int ring = 8;             // views of a ring, 3 to 1024
  glm::dvec3 up{0, 1, 0};   // the axis of hemisphere and ring
};

// Directions with their neighbours.
struct ViewSet {
  std::vector<glm::dvec3> directions;  // unit
  // Spherical triangles, counter-clockwise seen from outside. They cover the sphere, or the part to
  // which the options restrict it. Empty for a ring, whose neighbours are `edges`.
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> edges;  // each once, smaller index first, ascending
};

// The view set of these options. Requires a non-zero `up` and 3 <= ring <= 1024.
[[nodiscard]] ViewSet make_view_set(const ViewSetOptions& options);

// The view set of any directions, for instance of those read from a file: the triangles are those
// of the convex hull. If all directions lie in a half space, it stays open at the bottom. Requires
// at least one direction; all unit and distinct.
[[nodiscard]] ViewSet view_set_from_directions(std::vector<glm::dvec3> directions);

// The pictures for one viewer. views[0] is the nearest; then come the two others of the triangle
// that contains the direction, nearer first, or of the closest triangle or edge; -1 where there is
// none. weights are barycentric in that triangle, not negative, and sum to 1.
struct ViewPick {
  std::array<int, 3> views{-1, -1, -1};
  std::array<double, 3> weights{0, 0, 0};
};
// The pictures for a viewer in direction `towards_viewer`.
[[nodiscard]] ViewPick pick_views(const ViewSet& set, const glm::dvec3& towards_viewer);
// The same with `view` as views[0], and the two others from a triangle that contains it.
[[nodiscard]] ViewPick pick_views_around(const ViewSet& set, int view,
                                         const glm::dvec3& towards_viewer);

// Writes the views nearest to the direction into `out`, nearest first, as many as fit. Returns
// their number. Does not allocate.
int nearest_views(const ViewSet& set, const glm::dvec3& towards_viewer, std::span<int> out);

// Weights of the views found by nearest_views(), which change continuously when another view
// becomes the nearest. A weight falls linearly with the angle by which its view is farther than the
// nearest one, to 0 at `zone` radians. The weights sum to 1; with zone 0, only the nearest has
// weight.
void handover_weights(const ViewSet& set, const glm::dvec3& towards_viewer, double zone,
                      std::span<const int> views, std::span<float> weights);

// The mean angle between neighbours, radians; 0 if there are none.
[[nodiscard]] double mean_spacing(const ViewSet& set);

// The covering radius of the views: the largest angle from any direction to the nearest view,
// radians; pi if the triangles do not close around all directions.
[[nodiscard]] double covering_angle(const ViewSet& set);

// Projection and resolution of the cameras of a view set.
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
