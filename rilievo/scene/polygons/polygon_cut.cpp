// Cutting polygons into triangles by clipping ears [Meisters 1975]: a corner may be cut off if it
// is convex and no other corner lies in its triangle; every simple polygon has two such ears.
//
// Of the corners that lie in a triangle, the one that is farthest from its base is not convex: only
// such corners are looked for, in strips. An ear that is cut off makes ears of its two neighbours
// at most [O'Rourke 1998, section 1.6]: only they are looked at again, 3 n looks for n corners.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

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
  p.reserve(polygon.size());
  for (const Corner& c : polygon)
    p.push_back(soup.positions[c.position] - soup.positions[polygon[0].position]);
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
  flat.reserve(p.size());
  for (const glm::dvec3& q : p) flat.push_back({q[u], q[v]});
  return flat;
}

bool is_convex(const std::vector<glm::dvec2>& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i)
    if (area(p[i], p[(i + 1) % n], p[(i + 2) % n]) < 0) return false;
  return true;
}

// A polygon of which ears are cut off.
struct Outline {
  const std::vector<glm::dvec2>& p;
  std::vector<std::uint32_t> before, after;  // each corner's neighbours
  std::vector<char> bent;                    // is the corner left, and not convex?

  // Corners that were not convex at first, by x in strips of `strip` corners, by y in each; and the
  // x where each strip begins.
  std::vector<std::uint32_t> blockers;
  std::vector<double> strip_x;
  std::size_t strip = 1;

  void update(std::uint32_t i) { bent[i] = area(p[before[i]], p[i], p[after[i]]) <= 0; }
};

Outline outline_of(const std::vector<glm::dvec2>& p) {
  const std::size_t n = p.size();
  Outline o{p, std::vector<std::uint32_t>(n), std::vector<std::uint32_t>(n), std::vector<char>(n)};
  for (std::size_t i = 0; i < n; ++i) {
    o.before[i] = std::uint32_t((i + n - 1) % n), o.after[i] = std::uint32_t((i + 1) % n);
    o.update(std::uint32_t(i));
    if (o.bent[i]) o.blockers.push_back(std::uint32_t(i));
  }
  const auto by = [&](int axis) {
    return [&p, axis](std::uint32_t i, std::uint32_t k) { return p[i][axis] < p[k][axis]; };
  };
  std::sort(o.blockers.begin(), o.blockers.end(), by(0));
  o.strip = std::size_t(std::ceil(std::sqrt(double(o.blockers.size()))));
  for (std::size_t k = 0; k < o.blockers.size(); k += o.strip) {
    const std::span<std::uint32_t> strip = std::span(o.blockers).subspan(k);
    o.strip_x.push_back(p[strip[0]].x);
    std::sort(strip.begin(), strip.begin() + std::min(o.strip, strip.size()), by(1));
  }
  return o;
}

struct Heights {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

// How low and how high a triangle reaches between two x, with a little room for rounding.
Heights heights(const std::array<glm::dvec2, 3>& triangle, double left, double right) {
  Heights out;
  for (std::size_t k = 0; k < 3; ++k) {
    glm::dvec2 from = triangle[k], to = triangle[(k + 1) % 3];
    if (from.x > to.x) std::swap(from, to);
    // An upright edge ends where the others end.
    if (from.x == to.x || to.x < left || from.x > right) continue;
    const glm::dvec2 slope = (to - from) / (to.x - from.x);
    for (const double x : {std::max(left, from.x), std::min(right, to.x)}) {
      const double y = from.y + (x - from.x) * slope.y;
      const double room = 1e-12 * (std::abs(from.y) + std::abs(to.y));
      out = {std::min(out.low, y - room), std::max(out.high, y + room)};
    }
  }
  return out;
}

// May corner `ib` be cut off? Takes from `work` what that costs to find out.
bool is_ear(const Outline& o, std::uint32_t ib, std::int64_t& work) {
  constexpr int kSearchCost = 8;  // of a binary search, in looks at a corner
  const glm::dvec2 &a = o.p[o.before[ib]], &b = o.p[ib], &c = o.p[o.after[ib]];
  --work;
  if (a == b || b == c) return true;  // a corner that is there twice
  if (o.bent[ib]) return false;
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  const auto first = std::lower_bound(o.strip_x.begin(), o.strip_x.end(), left);
  // The strip before has corners up to there, too.
  for (auto s = first - (first != o.strip_x.begin()); s != o.strip_x.end() && *s <= right; ++s) {
    const Heights reach = heights({a, b, c}, *s, s + 1 == o.strip_x.end() ? right : s[1]);
    const auto begin = o.blockers.begin() + (s - o.strip_x.begin()) * std::ptrdiff_t(o.strip);
    const auto end = begin + std::min(std::ptrdiff_t(o.strip), o.blockers.end() - begin);
    auto i = std::lower_bound(begin, end, reach.low,
                              [&](std::uint32_t k, double y) { return o.p[k].y < y; });
    work -= kSearchCost;
    for (; i != end && o.p[*i].y <= reach.high; ++i) {
      const glm::dvec2& q = o.p[*i];
      --work;
      // Corners that coincide with those of the ear are how holes are cut open: they do not block.
      if (!o.bent[*i] || q == a || q == b || q == c) continue;
      if (area(a, b, q) >= 0 && area(b, c, q) >= 0 && area(c, a, q) >= 0) return false;
    }
  }
  return true;
}

// Calls emit(a, b, c) for the triangles of a polygon given by its corners in the plane. When `work`
// is used up, the rest is one fan.
template <class Emit>
void clip_ears(const std::vector<glm::dvec2>& p, std::int64_t& work, Emit&& emit) {
  Outline o = outline_of(p);
  // Corners to look at in this round, and in the next.
  std::vector<std::uint32_t> now(p.size()), again;
  std::iota(now.begin(), now.end(), 0u);
  bool all = true;  // is every corner that is left in `now`?
  std::size_t left = p.size();
  std::uint32_t at = 0;  // a corner that is left
  const auto cut_off = [&](std::uint32_t b) {
    const std::uint32_t a = o.before[b], c = o.after[b];
    emit(a, b, c);
    o.after[a] = c, o.before[c] = a, o.bent[b] = false;
    o.update(a), o.update(c);
    again.insert(again.end(), {a, c});
    at = c, --left;
  };
  while (left > 3 && work > 0) {
    for (const std::uint32_t b : now) {
      if (left == 3 || work <= 0) break;
      // Its neighbours do not know a corner that has been cut off.
      if (o.after[o.before[b]] == b && is_ear(o, b, work)) cut_off(b);
    }
    const bool stuck = again.empty();
    if (stuck) {
      // No ear anywhere: not a simple polygon. Cut off what comes.
      if (all) cut_off(at);
      again.assign(1, at);
      for (std::uint32_t i = o.after[at]; i != at; i = o.after[i]) again.push_back(i);
    }
    all = stuck;
    now.swap(again);
    again.clear();
  }
  for (std::uint32_t b = o.after[at]; o.after[b] != at; b = o.after[b]) emit(at, b, o.after[b]);
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
  if (!is_convex(flat)) {
    soup.work_left = std::max<std::int64_t>(soup.work_left, 0) + 256 * std::int64_t(flat.size());
    clip_ears(flat, soup.work_left, emit);
    soup.cut_short = soup.cut_short || soup.work_left <= 0;
    return;
  }
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) emit(0, i, i + 1);
}

}  // namespace rilievo
