// Points go in one by one: the triangle (or the edge) around a point is split, and edges that are
// no longer Delaunay are flipped, spreading from there [Lawson 1977]. A constraint goes in by
// flipping the edges that it crosses until none does [Sloan 1993].
#include "rilievo/environment_nodes/delaunay.h"

#include <deque>

#include "rilievo/core/expects.h"

namespace rilievo {

// With all points relative to p, and s = x^2 + y^2: the determinant of rows (x, y, s) of a, b, c.
// Differences have up to 14 bits, so s has 29, each product 57, and the sum of six 60.
std::int64_t in_circle(const glm::ivec2& a, const glm::ivec2& b, const glm::ivec2& c,
                       const glm::ivec2& p) {
  const std::int64_t ax = a.x - p.x, ay = a.y - p.y, bx = b.x - p.x, by = b.y - p.y;
  const std::int64_t cx = c.x - p.x, cy = c.y - p.y;
  const std::int64_t as = ax * ax + ay * ay, bs = bx * bx + by * by, cs = cx * cx + cy * cy;
  return as * (bx * cy - by * cx) + bs * (cx * ay - cy * ax) + cs * (ax * by - ay * bx);
}

Delaunay::Delaunay(int size) {
  RILIEVO_EXPECTS(size >= 1 && size <= kMaxSize);
  points_ = {{0, 0}, {size, 0}, {size, size}, {0, size}};
  at_ = {0, 0, 0, 1};
  triangles_.resize(2);
  is_changed_.resize(2);
  write(0, {{0, 1, 2}, {kNone, 1, kNone}, 0});
  write(1, {{0, 2, 3}, {kNone, kNone, 0}, 0});
}

void Delaunay::write(std::uint32_t triangle, const Triangle& value) {
  triangles_[triangle] = value;
  for (const std::uint32_t v : value.v) at_[v] = triangle;
  if (!is_changed_[triangle]) {
    is_changed_[triangle] = 1;
    changed_.push_back(triangle);
  }
}

void Delaunay::clear_changed() {
  for (const std::uint32_t t : changed_) is_changed_[t] = 0;
  changed_.clear();
}

void Delaunay::relink(std::uint32_t triangle, std::uint32_t old_next, std::uint32_t new_next) {
  if (triangle == kNone) return;
  for (std::uint32_t& next : triangles_[triangle].next)
    if (next == old_next) {
      next = new_next;
      return;
    }
}

//        b                    b
//      / | \                /   \        t = (p, a, b), n = (q, b, a), the edge a-b between them,
//     p t|n q      ->      p --- q       become t = (p, a, q), n = (p, q, b).
//      \ | /                \   /
//        a                    a
void Delaunay::flip(std::uint32_t triangle, int side) {
  const Triangle t = triangles_[triangle];
  const int i = side, i1 = (i + 1) % 3, i2 = (i + 2) % 3;
  const std::uint32_t other = t.next[i];
  const Triangle n = triangles_[other];
  int j = 0;
  while (n.next[j] != triangle) ++j;
  const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
  const auto bit = [](const Triangle& of, int k) { return (of.fixed >> k) & 1; };
  const std::uint32_t p = t.v[i], a = t.v[i1], b = t.v[i2], q = n.v[j];
  write(triangle,
        {{p, a, q}, {n.next[j1], other, t.next[i2]}, std::uint8_t(bit(n, j1) | bit(t, i2) << 2)});
  write(
      other,
      {{p, q, b}, {n.next[j2], t.next[i1], triangle}, std::uint8_t(bit(n, j2) | bit(t, i1) << 1)});
  relink(n.next[j1], other, triangle);
  relink(t.next[i1], triangle, other);
}

void Delaunay::legalize() {
  while (!pending_.empty()) {
    const std::uint32_t index = pending_.back();
    pending_.pop_back();
    const Triangle& t = triangles_[index];
    const std::uint32_t other = t.next[0];
    if (other == kNone || (t.fixed & 1)) continue;
    const Triangle& n = triangles_[other];
    int j = 0;
    while (n.next[j] != index) ++j;
    if (in_circle(points_[t.v[0]], points_[t.v[1]], points_[t.v[2]], points_[n.v[j]]) <= 0)
      continue;
    flip(index, 0);
    pending_.push_back(index);
    pending_.push_back(other);
  }
}

void Delaunay::split_triangle(std::uint32_t triangle, std::uint32_t point) {
  const Triangle t = triangles_[triangle];
  const std::uint32_t second = std::uint32_t(triangles_.size()), third = second + 1;
  triangles_.resize(triangles_.size() + 2);
  is_changed_.resize(triangles_.size());
  const auto bit = [&](int k) { return std::uint8_t((t.fixed >> k) & 1); };
  write(triangle, {{point, t.v[0], t.v[1]}, {t.next[2], second, third}, bit(2)});
  write(second, {{point, t.v[1], t.v[2]}, {t.next[0], third, triangle}, bit(0)});
  write(third, {{point, t.v[2], t.v[0]}, {t.next[1], triangle, second}, bit(1)});
  relink(t.next[0], triangle, second);
  relink(t.next[1], triangle, third);
  pending_.insert(pending_.end(), {triangle, second, third});
}

// The edge a-b of t = (c, a, b) and, if there is one, n = (d, b, a).
void Delaunay::split_edge(std::uint32_t triangle, int side, std::uint32_t point) {
  const Triangle t = triangles_[triangle];
  const int i1 = (side + 1) % 3, i2 = (side + 2) % 3;
  const std::uint32_t c = t.v[side], a = t.v[i1], b = t.v[i2], other = t.next[side];
  const std::uint32_t second = std::uint32_t(triangles_.size());
  const std::uint32_t fourth = other == kNone ? kNone : second + 1;
  triangles_.resize(triangles_.size() + (other == kNone ? 1 : 2));
  is_changed_.resize(triangles_.size());
  const auto bit = [](const Triangle& of, int k, int to) {
    return std::uint8_t(((of.fixed >> k) & 1) << to);
  };
  const std::uint8_t along = bit(t, side, 0);
  // t = (point, c, a), second = (point, b, c); the edge itself lies opposite of c.
  write(triangle, {{point, c, a},
                   {t.next[i2], fourth == kNone ? kNone : other, second},
                   std::uint8_t(bit(t, i2, 0) | along << 1)});
  write(second,
        {{point, b, c}, {t.next[i1], triangle, fourth}, std::uint8_t(bit(t, i1, 0) | along << 2)});
  relink(t.next[i1], triangle, second);
  pending_.insert(pending_.end(), {triangle, second});
  if (other == kNone) return;
  const Triangle n = triangles_[other];
  int j = 0;
  while (n.next[j] != triangle) ++j;
  const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
  const std::uint32_t d = n.v[j];
  // other = (point, a, d), fourth = (point, d, b).
  write(other,
        {{point, a, d}, {n.next[j1], fourth, triangle}, std::uint8_t(bit(n, j1, 0) | along << 2)});
  write(fourth,
        {{point, d, b}, {n.next[j2], second, other}, std::uint8_t(bit(n, j2, 0) | along << 1)});
  relink(n.next[j2], other, fourth);
  pending_.insert(pending_.end(), {other, fourth});
}

std::uint32_t Delaunay::locate(const glm::ivec2& place, std::uint32_t hint) const {
  std::uint32_t at = hint < triangles_.size() ? hint : 0, from = kNone;
  // A walk through constrained triangles may go in circles; then every triangle is asked.
  for (std::size_t step = 0; step < triangles_.size() + 3; ++step) {
    const Triangle& t = triangles_[at];
    std::uint32_t onwards = kNone;
    for (int i = 0; i < 3 && onwards == kNone; ++i)
      if (t.next[i] != from &&
          orientation(points_[t.v[(i + 1) % 3]], points_[t.v[(i + 2) % 3]], place) < 0)
        onwards = t.next[i];
    if (onwards == kNone) break;
    from = at;
    at = onwards;
  }
  const auto holds = [&](const Triangle& t) {
    return orientation(points_[t.v[0]], points_[t.v[1]], place) >= 0 &&
           orientation(points_[t.v[1]], points_[t.v[2]], place) >= 0 &&
           orientation(points_[t.v[2]], points_[t.v[0]], place) >= 0;
  };
  if (holds(triangles_[at])) return at;
  for (std::uint32_t i = 0; i < triangles_.size(); ++i)
    if (holds(triangles_[i])) return i;
  return kNone;
}

std::uint32_t Delaunay::insert(const glm::ivec2& place, std::uint32_t hint) {
  const std::uint32_t triangle = locate(place, hint);
  RILIEVO_EXPECTS(triangle != kNone);
  const Triangle& t = triangles_[triangle];
  int on = -1;
  for (int i = 0; i < 3; ++i) {
    if (points_[t.v[i]] == place) return t.v[i];
    if (orientation(points_[t.v[(i + 1) % 3]], points_[t.v[(i + 2) % 3]], place) == 0) on = i;
  }
  const std::uint32_t point = std::uint32_t(points_.size());
  points_.push_back(place);
  at_.push_back(kNone);
  if (on < 0)
    split_triangle(triangle, point);
  else
    split_edge(triangle, on, point);
  legalize();
  return point;
}

// Calls visit(triangle, i) for every triangle with v[i] == point until it returns true.
template <class Visit>
bool Delaunay::around(std::uint32_t point, Visit&& visit) const {
  const std::uint32_t start = at_[point];
  const auto corner = [&](std::uint32_t t) {
    int i = 0;
    while (triangles_[t].v[i] != point) ++i;
    return i;
  };
  std::uint32_t at = start;
  do {
    const int i = corner(at);
    if (visit(at, i)) return true;
    at = triangles_[at].next[(i + 1) % 3];
  } while (at != start && at != kNone);
  if (at == start) return false;
  // On the square's border: the other way around, too.
  at = triangles_[start].next[(corner(start) + 2) % 3];
  while (at != kNone) {
    const int i = corner(at);
    if (visit(at, i)) return true;
    at = triangles_[at].next[(i + 2) % 3];
  }
  return false;
}

Delaunay::Edge Delaunay::find_edge(std::uint32_t from, std::uint32_t to) const {
  Edge found;
  around(from, [&](std::uint32_t t, int i) {
    if (triangles_[t].v[(i + 1) % 3] != to) return false;
    found = {t, (i + 2) % 3};
    return true;
  });
  return found;
}

void Delaunay::fix(const Edge& edge) {
  Triangle& t = triangles_[edge.triangle];
  t.fixed = std::uint8_t(t.fixed | 1u << edge.side);
  if (t.next[edge.side] == kNone) return;
  Triangle& n = triangles_[t.next[edge.side]];
  for (int j = 0; j < 3; ++j)
    if (n.next[j] == edge.triangle) n.fixed = std::uint8_t(n.fixed | 1u << j);
}

// The edges that the line from `from` towards `to` crosses before it reaches a point. False if one
// of them is a constraint.
bool Delaunay::cut(std::uint32_t from, std::uint32_t to, std::vector<Loose>& crossed,
                   std::uint32_t& reached) const {
  const glm::ivec2 a = points_[from], b = points_[to];
  std::uint32_t at = kNone;
  int side = 0;
  reached = kNone;
  const auto ahead = [&](const glm::ivec2& p) {
    return std::int64_t(p.x - a.x) * (b.x - a.x) + std::int64_t(p.y - a.y) * (b.y - a.y) > 0;
  };
  around(from, [&](std::uint32_t t, int i) {
    const std::uint32_t u = triangles_[t].v[(i + 1) % 3], w = triangles_[t].v[(i + 2) % 3];
    const std::int64_t of_u = orientation(a, b, points_[u]), of_w = orientation(a, b, points_[w]);
    if (of_u == 0 && ahead(points_[u])) reached = u;
    if (of_w == 0 && ahead(points_[w])) reached = w;
    if (reached != kNone) return true;
    if (of_u >= 0 || of_w <= 0) return false;
    at = t, side = i;
    return true;
  });
  if (reached != kNone) return true;
  for (;;) {
    const Triangle& t = triangles_[at];
    if ((t.fixed >> side) & 1) return false;
    crossed.push_back({t.v[(side + 1) % 3], t.v[(side + 2) % 3]});
    const std::uint32_t other = t.next[side];
    const Triangle& n = triangles_[other];
    int j = 0;
    while (n.next[j] != at) ++j;
    const std::int64_t of_q = orientation(a, b, points_[n.v[j]]);
    if (of_q == 0) {
      reached = n.v[j];
      return true;
    }
    // n = (q, w, u) as seen from t = (., u, w): on along q-u or q-w.
    at = other;
    side = of_q > 0 ? (j + 1) % 3 : (j + 2) % 3;
  }
}

bool Delaunay::constrain(std::uint32_t from, std::uint32_t to) {
  while (from != to) {
    std::vector<Loose> crossed;
    std::uint32_t reached = kNone;
    if (!cut(from, to, crossed, reached)) return false;
    const glm::ivec2 a = points_[from], b = points_[reached];
    std::deque<Loose> queue(crossed.begin(), crossed.end());
    std::vector<Loose> made;
    while (!queue.empty()) {
      const Loose edge = queue.front();
      queue.pop_front();
      const Edge found = find_edge(edge.from, edge.to);
      const Triangle& t = triangles_[found.triangle];
      const Triangle& n = triangles_[t.next[found.side]];
      int j = 0;
      while (n.next[j] != found.triangle) ++j;
      const std::uint32_t p = t.v[found.side], q = n.v[j];
      const std::int64_t of_u = orientation(points_[p], points_[q], points_[edge.from]);
      const std::int64_t of_w = orientation(points_[p], points_[q], points_[edge.to]);
      if (!((of_u < 0 && of_w > 0) || (of_u > 0 && of_w < 0))) {
        queue.push_back(edge);  // not convex; it will be
        continue;
      }
      flip(found.triangle, found.side);
      const std::int64_t of_p = orientation(a, b, points_[p]), of_q = orientation(a, b, points_[q]);
      if ((of_p < 0 && of_q > 0) || (of_p > 0 && of_q < 0))
        queue.push_back({p, q});
      else
        made.push_back({p, q});
    }
    Edge along = find_edge(from, reached);
    if (along.triangle == kNone) along = find_edge(reached, from);
    fix(along);
    // The edges made are Delaunay again when no flip helps any of them.
    for (bool flipped = true; flipped;) {
      flipped = false;
      for (Loose& edge : made) {
        const Edge found = find_edge(edge.from, edge.to);
        if (found.triangle == kNone) continue;
        const Triangle& t = triangles_[found.triangle];
        if (t.next[found.side] == kNone || ((t.fixed >> found.side) & 1)) continue;
        const Triangle& n = triangles_[t.next[found.side]];
        int j = 0;
        while (n.next[j] != found.triangle) ++j;
        const std::uint32_t p = t.v[found.side], q = n.v[j];
        if (in_circle(points_[t.v[0]], points_[t.v[1]], points_[t.v[2]], points_[q]) <= 0) continue;
        flip(found.triangle, found.side);
        edge = {p, q};
        flipped = true;
      }
    }
    from = reached;
  }
  return true;
}

}  // namespace rilievo
