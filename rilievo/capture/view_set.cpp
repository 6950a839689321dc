// Cf. [Schaufler 1998], sections 3.4 and 3.5: views on a Platonic solid, and the triangle of views
// around the current direction (figure 6, right).
//
// How we differ: the paper's solid is closed; a hemisphere and a ring leave directions that no
// triangle holds, which are served by the triangle or edge that comes closest.

#include "rilievo/capture/view_set.h"

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

// `view` first, then the nearer one; weights clamped to the triangle.
ViewPick sorted_pick(const ViewSet& set, int view, ViewPick pick, const glm::dvec3& direction) {
  const auto before = [&](int a, int b) {
    if (a < 0 || b < 0) return b < 0 && a >= 0;
    if (a == view || b == view) return a == view && b != view;
    return glm::dot(set.directions[a], direction) > glm::dot(set.directions[b], direction);
  };
  for (int pass = 0; pass < 2; ++pass)
    for (int i = 0; i < 2; ++i)
      if (before(pick.views[i + 1], pick.views[i])) {
        std::swap(pick.views[i], pick.views[i + 1]);
        std::swap(pick.weights[i], pick.weights[i + 1]);
      }
  double sum = 0;
  for (double& w : pick.weights) sum += w = std::max(w, 0.0);
  for (double& w : pick.weights) w /= sum > 0 ? sum : 1.0;
  if (sum == 0) pick.weights[0] = 1;
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
  int nearest = 0;
  nearest_views(set, towards_viewer, {&nearest, 1});
  return pick_views_around(set, nearest, towards_viewer);
}

ViewPick pick_views_around(const ViewSet& set, int view, const glm::dvec3& towards_viewer) {
  const double length = glm::length(towards_viewer);
  const glm::dvec3 direction = length > 0 ? towards_viewer / length : set.directions[view];
  // Of the triangles at the view, that which holds the direction, or comes closest.
  double best = -1e300;
  ViewPick pick;
  for (const auto& t : set.triangles) {
    if (t[0] != view && t[1] != view && t[2] != view) continue;
    const glm::dvec3 w =
        barycentric(set.directions[t[0]], set.directions[t[1]], set.directions[t[2]], direction);
    const double inside = std::min({w.x, w.y, w.z});
    if (inside <= best) continue;
    best = inside;
    pick = {{t[0], t[1], t[2]}, {w.x, w.y, w.z}};
  }
  if (pick.views[0] >= 0) return sorted_pick(set, view, pick, direction);

  // No triangle: the better of the edges at the view, weighted by the angle across it.
  double closest = -1e300;
  int other = -1;
  for (const auto& e : set.edges) {
    if (e[0] != view && e[1] != view) continue;
    const int end = e[0] == view ? e[1] : e[0];
    const double near_end = glm::dot(set.directions[end], direction);
    if (near_end > closest) closest = near_end, other = end;
  }
  if (other < 0) return {{view, -1, -1}, {1, 0, 0}};
  const double to_it = std::acos(std::clamp(glm::dot(set.directions[view], direction), -1.0, 1.0));
  const double to_other = std::acos(std::clamp(closest, -1.0, 1.0));
  return sorted_pick(set, view, {{view, other, -1}, {to_other, to_it, 0}}, direction);
}

int nearest_views(const ViewSet& set, const glm::dvec3& towards_viewer, std::span<int> out) {
  std::size_t found = 0;
  for (int i = 0; i < int(set.directions.size()); ++i) {
    const double near = glm::dot(set.directions[i], towards_viewer);
    // Insertion into the few that are nearest so far; the first of equals stays first.
    std::size_t at = found;
    while (at > 0 && glm::dot(set.directions[out[at - 1]], towards_viewer) < near) --at;
    if (at == out.size()) continue;
    found = std::min(found + 1, out.size());
    for (std::size_t k = found - 1; k > at; --k) out[k] = out[k - 1];
    out[at] = i;
  }
  return int(found);
}

void handover_weights(const ViewSet& set, const glm::dvec3& towards_viewer, double zone,
                      std::span<const int> views, std::span<float> weights) {
  RILIEVO_EXPECTS(!views.empty() && weights.size() >= views.size());
  const glm::dvec3 direction = glm::normalize(towards_viewer);
  const auto angle = [&](int view) {
    return std::acos(std::clamp(glm::dot(set.directions[view], direction), -1.0, 1.0));
  };
  const double nearest = angle(views[0]);
  double sum = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double farther = angle(views[i]) - nearest;
    const double weight = i == 0 ? 1.0 : zone > 0 ? std::max(0.0, 1.0 - farther / zone) : 0.0;
    weights[i] = float(weight);
    sum += weight;
  }
  for (std::size_t i = 0; i < views.size(); ++i) weights[i] = float(weights[i] / sum);
}

double mean_spacing(const ViewSet& set) {
  double sum = 0;
  for (const auto& e : set.edges)
    sum += std::acos(std::clamp(glm::dot(set.directions[e[0]], set.directions[e[1]]), -1.0, 1.0));
  return set.edges.empty() ? 0.0 : sum / double(set.edges.size());
}

double covering_angle(const ViewSet& set) {
  // Closed, every edge has a triangle on either side. What is farthest from the corners of a
  // triangle of the convex hull, which no other corner is nearer to, is its pole.
  if (set.triangles.empty() || 3 * set.triangles.size() != 2 * set.edges.size())
    return std::numbers::pi;
  double farthest = 0;
  for (const auto& t : set.triangles) {
    const glm::dvec3 &a = set.directions[t[0]], &b = set.directions[t[1]],
                     &c = set.directions[t[2]];
    const double near = glm::dot(glm::normalize(glm::cross(b - a, c - a)), a);
    farthest = std::max(farthest, std::acos(std::clamp(near, -1.0, 1.0)));
  }
  return farthest;
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
