// Cf. [Schaufler 1998], sections 3.4 and 3.5: views on a Platonic solid, and the triangle of views
// around the current direction (figure 6, right).
//
// How we differ: the paper's solid is closed; a hemisphere and a ring leave directions that no
// triangle holds, which are served by the triangle or edge that comes closest.

#include "rilievo/represent/view_set.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Heights and sines below this are rounding: directions may come from a file that holds floats.
constexpr double kFlat = 1e-6;

// The vertices of a dodecahedron are (+-1, +-1, +-1) and the cyclic permutations of
// (0, +-1/phi, +-phi); its face normals are the vertices of the dual icosahedron, the cyclic
// permutations of (0, +-1, +-phi) in the other order.
void add_cyclic(double a, double b, std::vector<glm::dvec3>& out) {
  for (int axis = 0; axis < 3; ++axis)
    for (double sa : {1.0, -1.0})
      for (double sb : {1.0, -1.0}) {
        glm::dvec3 v(0.0);
        v[(axis + 1) % 3] = sa * a;
        v[(axis + 2) % 3] = sb * b;
        out.push_back(glm::normalize(v));
      }
}

std::vector<glm::dvec3> dodecahedron(bool faces, bool vertices) {
  constexpr double phi = std::numbers::phi;
  std::vector<glm::dvec3> directions;
  if (faces) add_cyclic(phi, 1.0, directions);
  if (vertices) {
    for (int i = 0; i < 8; ++i)
      directions.push_back(
          glm::normalize(glm::dvec3(i & 1 ? -1 : 1, i & 2 ? -1 : 1, i & 4 ? -1 : 1)));
    add_cyclic(1.0 / phi, phi, directions);
  }
  return directions;
}

// Rotates +y onto `up`.
glm::dmat3 upright(const glm::dvec3& up) {
  const glm::dvec3 y = glm::normalize(up);
  if (y == glm::dvec3(0, 1, 0)) return glm::dmat3(1.0);
  const glm::dvec3 other = std::abs(y.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 z = glm::normalize(glm::cross(other, y));
  return {glm::cross(y, z), y, z};
}

// The plane through the origin that holds all directions, by its normal; zero if there is none.
// With fewer than three independent directions any of many will do.
glm::dvec3 common_plane(const std::vector<glm::dvec3>& directions) {
  glm::dvec3 normal(0.0);
  for (const glm::dvec3& d : directions) {
    const glm::dvec3 candidate = glm::cross(directions[0], d);
    if (glm::length(candidate) > glm::length(normal)) normal = candidate;
  }
  if (glm::length(normal) < kFlat) {
    const glm::dvec3& d = directions[0];
    normal = glm::cross(d, std::abs(d.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1));
  }
  normal = glm::normalize(normal);
  for (const glm::dvec3& d : directions)
    if (std::abs(glm::dot(d, normal)) > kFlat) return glm::dvec3(0.0);
  return normal;
}

// Indices in the order of their angle around `normal`, from that of points[indices[0]].
std::vector<int> ordered_around(const std::vector<glm::dvec3>& points, std::vector<int> indices,
                                const glm::dvec3& center, const glm::dvec3& normal) {
  glm::dvec3 x = points[indices[0]] - center;
  for (int p : indices)
    if (x == glm::dvec3(0.0)) x = points[p] - center;
  x = glm::normalize(x);
  const glm::dvec3 y = glm::cross(normal, x);
  std::vector<std::pair<double, int>> around;
  for (int p : indices) {
    const glm::dvec3 d = points[p] - center;
    const double angle = std::atan2(glm::dot(d, y), glm::dot(d, x));
    around.emplace_back(angle < -kFlat ? angle + 2 * std::numbers::pi : angle, p);
  }
  std::sort(around.begin(), around.end());
  for (std::size_t i = 0; i < around.size(); ++i) indices[i] = around[i].second;
  return indices;
}

// Triangles of the convex hull of points on the unit sphere, by definition: a plane through three
// points with no point outside it is a face; points on that plane make a polygon, cut into a fan
// from its smallest index. Most planes are given up after a few points: about O(n^3), for the few
// dozen directions of a view set.
std::vector<std::array<int, 3>> hull(const std::vector<glm::dvec3>& points) {
  const int n = int(points.size());
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k) {
        glm::dvec3 normal = glm::cross(points[j] - points[i], points[k] - points[i]);
        if (glm::length(normal) < kFlat) continue;
        normal = glm::normalize(normal);
        double highest = 0, lowest = 0;
        for (int p = 0; p < n && !(highest > kFlat && lowest < -kFlat); ++p) {
          const double height = glm::dot(normal, points[p] - points[i]);
          highest = std::max(highest, height);
          lowest = std::min(lowest, height);
        }
        if (highest > kFlat && lowest < -kFlat) continue;
        std::vector<int> face;
        for (int p = 0; p < n; ++p)
          if (std::abs(glm::dot(normal, points[p] - points[i])) <= kFlat) face.push_back(p);
        if (highest > kFlat) normal = -normal;
        // Each polygon comes up for every three of its corners: take it the first time.
        if (face[0] != i || face[1] != j || face[2] != k) continue;
        glm::dvec3 center(0.0);
        for (int p : face) center += points[p] / double(face.size());
        face = ordered_around(points, std::move(face), center, normal);
        for (std::size_t c = 1; c + 1 < face.size(); ++c)
          triangles.push_back({face[0], face[c], face[c + 1]});
      }
  return triangles;
}

// The edges of the triangles; of directions in one plane the edges between consecutive ones, but
// for the gap that half a turn or more leaves open.
void add_edges(const glm::dvec3& plane, ViewSet& set) {
  const auto add = [&](int a, int b) { set.edges.push_back({std::min(a, b), std::max(a, b)}); };
  for (const auto& t : set.triangles)
    for (int c = 0; c < 3; ++c) add(t[c], t[(c + 1) % 3]);
  const int n = int(set.directions.size());
  if (plane != glm::dvec3(0.0) && n > 1) {
    std::vector<int> all(n);
    for (int i = 0; i < n; ++i) all[i] = i;
    all = ordered_around(set.directions, std::move(all), glm::dvec3(0.0), plane);
    for (int i = 0; i < n; ++i) {
      const int a = all[i], b = all[(i + 1) % n];
      // sin(angle from a to b) > 0: less than half a turn.
      const glm::dvec3 turn = glm::cross(set.directions[a], set.directions[b]);
      if (n == 2 || glm::dot(turn, plane) > 0) add(a, b);
    }
  }
  std::sort(set.edges.begin(), set.edges.end());
  set.edges.erase(std::unique(set.edges.begin(), set.edges.end()), set.edges.end());
}

// `direction` as a combination of a, b, c scaled to sum to 1 in absolute value. The smallest of
// them is >= 0 exactly if the spherical triangle a b c holds the direction.
glm::dvec3 barycentric(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                       const glm::dvec3& direction) {
  const glm::dvec3 weights{glm::dot(direction, glm::cross(b, c)),
                           glm::dot(direction, glm::cross(c, a)),
                           glm::dot(direction, glm::cross(a, b))};
  const double sum = std::abs(weights.x) + std::abs(weights.y) + std::abs(weights.z);
  return sum > 0 ? weights / sum : glm::dvec3(-1.0);
}

// Nearest first; weights clamped to the triangle.
ViewPick sorted_pick(const ViewSet& set, std::vector<std::pair<int, double>> views,
                     const glm::dvec3& direction) {
  std::sort(views.begin(), views.end(), [&](const auto& a, const auto& b) {
    const double da = glm::dot(set.directions[a.first], direction);
    const double db = glm::dot(set.directions[b.first], direction);
    return da != db ? da > db : a.first < b.first;
  });
  ViewPick pick;
  double sum = 0;
  for (const auto& [view, weight] : views) sum += std::max(weight, 0.0);
  for (std::size_t i = 0; i < views.size(); ++i) {
    pick.views[i] = views[i].first;
    pick.weights[i] = sum > 0 ? std::max(views[i].second, 0.0) / sum : (i == 0 ? 1.0 : 0.0);
  }
  return pick;
}

}  // namespace

ViewSet view_set_from_directions(std::vector<glm::dvec3> directions) {
  RILIEVO_EXPECTS(!directions.empty());
  ViewSet set;
  const glm::dvec3 plane = common_plane(directions);
  if (plane == glm::dvec3(0.0)) {
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& d : directions) sum += d;
    // The direction opposite to the mean closes an open set; the triangles that touch it are a
    // lid over what the set does not show. In a set all around the sum is zero.
    std::vector<glm::dvec3> closed = directions;
    if (glm::length(sum) > kFlat * double(directions.size()))
      closed.push_back(-glm::normalize(sum));
    const int n = int(directions.size());
    for (const auto& t : hull(closed))
      if (t[0] < n && t[1] < n && t[2] < n) set.triangles.push_back(t);
  }
  set.directions = std::move(directions);
  add_edges(plane, set);
  return set;
}

ViewSet make_view_set(const ViewSetOptions& options) {
  RILIEVO_EXPECTS(glm::length(options.up) > 0);
  std::vector<glm::dvec3> directions;
  if (options.spread == ViewSpread::ring) {
    RILIEVO_EXPECTS(options.ring >= 3 && options.ring <= 1024);
    for (int i = 0; i < options.ring; ++i) {
      const double angle = 2 * std::numbers::pi * i / options.ring;
      directions.emplace_back(std::sin(angle), 0.0, std::cos(angle));
    }
  } else {
    directions = dodecahedron(options.spread != ViewSpread::vertices_20,
                              options.spread != ViewSpread::faces_12);
    if (options.hemisphere)
      std::erase_if(directions, [](const glm::dvec3& d) { return d.y < -kFlat; });
  }
  const glm::dmat3 world_from_solid = upright(options.up);
  for (glm::dvec3& d : directions) d = world_from_solid * d;
  return view_set_from_directions(std::move(directions));
}

ViewPick pick_views(const ViewSet& set, const glm::dvec3& towards_viewer) {
  RILIEVO_EXPECTS(!set.directions.empty());
  const double length = glm::length(towards_viewer);
  const glm::dvec3 direction = length > 0 ? towards_viewer / length : set.directions[0];
  int nearest = 0;
  for (int i = 1; i < int(set.directions.size()); ++i)
    if (glm::dot(set.directions[i], direction) > glm::dot(set.directions[nearest], direction))
      nearest = i;

  // Of the triangles at the nearest view, that which holds the direction, or comes closest.
  double best = -1e300;
  std::vector<std::pair<int, double>> views;
  for (const auto& t : set.triangles) {
    if (t[0] != nearest && t[1] != nearest && t[2] != nearest) continue;
    const glm::dvec3 w =
        barycentric(set.directions[t[0]], set.directions[t[1]], set.directions[t[2]], direction);
    const double inside = std::min({w.x, w.y, w.z});
    if (inside <= best) continue;
    best = inside;
    views = {{t[0], w.x}, {t[1], w.y}, {t[2], w.z}};
  }
  if (!views.empty()) return sorted_pick(set, std::move(views), direction);

  // No triangle: the better of the edges at the nearest view, weighted by the angle across it.
  double closest = -1e300;
  int other = -1;
  for (const auto& e : set.edges) {
    if (e[0] != nearest && e[1] != nearest) continue;
    const int end = e[0] == nearest ? e[1] : e[0];
    const double near_end = glm::dot(set.directions[end], direction);
    if (near_end > closest) closest = near_end, other = end;
  }
  if (other < 0) return sorted_pick(set, {{nearest, 1.0}}, direction);
  const double to_nearest =
      std::acos(std::clamp(glm::dot(set.directions[nearest], direction), -1.0, 1.0));
  const double to_other = std::acos(std::clamp(closest, -1.0, 1.0));
  return sorted_pick(set, {{nearest, to_other}, {other, to_nearest}}, direction);
}

std::vector<int> nearest_views(const ViewSet& set, const glm::dvec3& towards_viewer, int count) {
  std::vector<int> views(set.directions.size());
  for (int i = 0; i < int(views.size()); ++i) views[i] = i;
  std::stable_sort(views.begin(), views.end(), [&](int a, int b) {
    return glm::dot(set.directions[a], towards_viewer) >
           glm::dot(set.directions[b], towards_viewer);
  });
  if (count < int(views.size())) views.resize(std::max(count, 0));
  return views;
}

Result<Camera> view_camera(const Box& box, const glm::dvec3& direction,
                           const ViewCameraOptions& options) {
  RILIEVO_EXPECTS_GT(options.distance, 1.0);
  RILIEVO_EXPECTS_GE(options.size, 1);
  if (box.empty()) return Error{"view_camera", "the box is empty"};
  const double side = options.projection == Projection::back_perspective ? -1.0 : 1.0;
  // A box without extent still needs a place to stand.
  const double reach = std::max(double(box.radius()), 1e-6);
  const glm::dvec3 apex =
      glm::dvec3(box.center()) + glm::normalize(direction) * (side * options.distance * reach);
  Result<Camera> camera = tight_camera(options.projection, apex, {0, 1, 0}, box);
  if (!camera) return camera;
  camera->width = camera->height = options.size;
  return camera;
}

}  // namespace rilievo
