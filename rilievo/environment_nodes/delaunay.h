// Which triangles connect given points and contain given edges?
//
// A constrained Delaunay triangulation of a square: the circle around a triangle contains no point
// that is visible from the triangle. Coordinates are integers and all tests are exact, so that no
// input is too degenerate, and the triangles depend only on the order of insertion. x points right,
// y up or down: "counter-clockwise" means orientation() > 0. Not thread-safe; use one object per
// thread.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace rilievo {

// Twice the signed area of a, b, c: positive if counter-clockwise. Coordinates up to 2^29.
[[nodiscard]] inline std::int64_t orientation(const glm::ivec2& a, const glm::ivec2& b,
                                              const glm::ivec2& c) {
  return std::int64_t(b.x - a.x) * (c.y - a.y) - std::int64_t(b.y - a.y) * (c.x - a.x);
}

// Positive if p lies inside the circle through the counter-clockwise a, b, c; 0 if on it.
[[nodiscard]] std::int64_t in_circle(const glm::ivec2& a, const glm::ivec2& b, const glm::ivec2& c,
                                     const glm::ivec2& p);

// A triangulation that grows by points and constraints.
class Delaunay {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  static constexpr int kMaxSize = 16384;  // in_circle fits into 64 bits

  // A triangle and its neighbours.
  struct Triangle {
    std::uint32_t v[3];      // points, counter-clockwise
    std::uint32_t next[3];   // the triangle across the edge opposite v[i]; kNone outside
    std::uint8_t fixed = 0;  // bit i: the edge opposite v[i] is a constraint
  };
  // A triangle's edge.
  struct Edge {
    std::uint32_t triangle = kNone;
    int side = 0;  // the edge opposite v[side]
  };

  // The square [0, size]^2 as two triangles. Its corners are points 0 (0, 0), 1 (size, 0),
  // 2 (size, size), 3 (0, size). Requires 1 <= size <= kMaxSize.
  explicit Delaunay(int size);

  // Inserts a point and returns its index; returns the existing index if it is there already.
  // Requires a place inside the square, not on a constraint (but the square's sides are allowed).
  // `hint`: a triangle nearby.
  std::uint32_t insert(const glm::ivec2& place, std::uint32_t hint = 0);

  // Makes the line between two points an edge that stays (or several, where it passes through
  // points). Returns false, with only a part of it inserted, if it would cross another constraint.
  [[nodiscard]] bool constrain(std::uint32_t from, std::uint32_t to);

  [[nodiscard]] const std::vector<glm::ivec2>& points() const { return points_; }
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  // A triangle that contains the place, inside or on its border.
  [[nodiscard]] std::uint32_t locate(const glm::ivec2& place, std::uint32_t hint = 0) const;
  // The triangle with v[side + 1] == from and v[side + 2] == to; kNone if there is none.
  [[nodiscard]] Edge find_edge(std::uint32_t from, std::uint32_t to) const;

  // The triangles that insert() and constrain() have made or changed since the last
  // clear_changed(), each once.
  [[nodiscard]] const std::vector<std::uint32_t>& changed() const { return changed_; }
  void clear_changed();

 private:
  struct Loose {
    std::uint32_t from, to;
  };
  void write(std::uint32_t triangle, const Triangle& value);
  void relink(std::uint32_t triangle, std::uint32_t old_next, std::uint32_t new_next);
  void flip(std::uint32_t triangle, int side);
  void legalize();
  void split_triangle(std::uint32_t triangle, std::uint32_t point);
  void split_edge(std::uint32_t triangle, int side, std::uint32_t point);
  template <class Visit>
  bool around(std::uint32_t point, Visit&& visit) const;
  bool cut(std::uint32_t from, std::uint32_t to, std::vector<Loose>& crossed,
           std::uint32_t& reached) const;
  void fix(const Edge& edge);

  std::vector<glm::ivec2> points_;
  std::vector<std::uint32_t> at_;  // by point: a triangle that has it
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> changed_;
  std::vector<std::uint8_t> is_changed_;
  std::vector<std::uint32_t> pending_;  // triangles whose edge opposite of v[0] may be wrong
};

}  // namespace rilievo
