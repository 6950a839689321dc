// Cutting polygons into triangles by clipping ears [Meisters 1975]: a corner may be cut off if it
// is convex and no other corner lies in its triangle; every simple polygon has two such ears.
#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/scene/polygons/polygon_mesh.h"

namespace rilievo {
namespace {

// Twice the signed area of a b c; positive if counter-clockwise.
double area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The corners in the plane that the polygon spans, so that it runs counter-clockwise. Newell's
// normal is right for every simple polygon, and insensitive to any one corner.
std::vector<glm::dvec2> flatten(const PolygonSoup& soup, std::span<const Corner> polygon) {
  std::vector<glm::dvec3> p;
  for (const Corner& c : polygon)
    p.push_back(glm::dvec3(soup.positions[c.position]) -
                glm::dvec3(soup.positions[polygon[0].position]));
  glm::dvec3 normal(0.0);
  for (std::size_t i = 0; i < p.size(); ++i) normal += glm::cross(p[i], p[(i + 1) % p.size()]);
  // Leave out the axis along which the polygon is thinnest; the order of the other two keeps the
  // sense of rotation.
  const glm::dvec3 size = glm::abs(normal);
  int drop = size.x > size.y ? 0 : 1;
  if (size.z > size[drop]) drop = 2;
  int u = (drop + 1) % 3, v = (drop + 2) % 3;
  if (normal[drop] < 0) std::swap(u, v);
  std::vector<glm::dvec2> flat;
  for (const glm::dvec3& q : p) flat.push_back({q[u], q[v]});
  return flat;
}

bool is_convex(const std::vector<glm::dvec2>& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i)
    if (area(p[i], p[(i + 1) % n], p[(i + 2) % n]) < 0) return false;
  return true;
}

// Calls emit(a, b, c) for the triangles of a polygon given by its corners in the plane.
template <class Emit>
void clip_ears(const std::vector<glm::dvec2>& p, Emit&& emit) {
  std::vector<std::size_t> left(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) left[i] = i;
  // Looking for an ear takes up to n^2 tests, all of them up to n^3: real polygons need far fewer.
  std::size_t tests = 64 * p.size() + 4'000'000;
  std::size_t at = 0, refused = 0;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    const std::size_t ia = left[(at + n - 1) % n], ib = left[at % n], ic = left[(at + 1) % n];
    const glm::dvec2 &a = p[ia], &b = p[ib], &c = p[ic];
    bool ear = area(a, b, c) > 0;
    for (std::size_t k = 0; ear && k < n && tests > 0; ++k, --tests) {
      const std::size_t i = left[k];
      // Corners that coincide with those of the ear are how holes are cut open: they do not block.
      if (p[i] == a || p[i] == b || p[i] == c) continue;
      ear = !(area(a, b, p[i]) >= 0 && area(b, c, p[i]) >= 0 && area(c, a, p[i]) >= 0);
    }
    // No ear anywhere: not a simple polygon. Cut off what comes.
    if (!ear && refused < n && tests > 0) {
      ++at, ++refused;
      continue;
    }
    emit(ia, ib, ic);
    left.erase(left.begin() + std::ptrdiff_t(at % n));
    // The next corner along, so that strips do not become fans of slivers.
    refused = 0;
    at = at % n;
  }
  emit(left[0], left[1], left[2]);
}

}  // namespace

void add_polygon(PolygonSoup& soup, std::span<const Corner> polygon, std::uint32_t part,
                 MemoryBudget& budget) {
  if (polygon.size() < 3) return;
  budget.take(polygon.size() - 2, 3 * sizeof(Corner) + sizeof(part));
  const auto emit = [&](std::size_t a, std::size_t b, std::size_t c) {
    const Corner &ca = polygon[a], &cb = polygon[b], &cc = polygon[c];
    // A triangle that names a vertex twice shows nothing.
    if (ca.position == cb.position || cb.position == cc.position || cc.position == ca.position)
      return;
    soup.triangles.insert(soup.triangles.end(), {ca, cb, cc});
    soup.parts.push_back(part);
  };
  if (polygon.size() == 3) return emit(0, 1, 2);
  const std::vector<glm::dvec2> flat = flatten(soup, polygon);
  if (!is_convex(flat)) return clip_ears(flat, emit);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) emit(0, i, i + 1);
}

}  // namespace rilievo
