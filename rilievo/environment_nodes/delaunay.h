// Which triangles join given points, so that given edges are among them?
//
// A constrained Delaunay triangulation of a square: no point that a triangle sees lies inside the
// circle around it. Coordinates are whole numbers and the tests are exact, so that no input is too
// degenerate, and the triangles depend on the order of the insertions alone. x to the right, y
// up or down: "counter-clockwise" means orientation() > 0. Not thread-safe; each thread one of its
// own.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace rilievo {

// Twice the area of a, b, c: > 0 if they run counter-clockwise. Coordinates up to 2^29.
[[nodiscard]] inline std::int64_t orientation(const glm::ivec2& a, const glm::ivec2& b,
                                              const glm::ivec2& c) {
  return std::int64_t(b.x - a.x) * (c.y - a.y) - std::int64_t(b.y - a.y) * (c.x - a.x);
}

// > 0 if p lies inside the circle through the counter-clockwise a, b, c; 0 on it.
[[nodiscard]] std::int64_t in_circle(const glm::ivec2& a, const glm::ivec2& b, const glm::ivec2& c,
                                     const glm::ivec2& p);

class Delaunay {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  static constexpr int kMostSize = 16384;  // in_circle fits into 64 bits

  struct Triangle {
    std::uint32_t v[3];      // points, counter-clockwise
    std::uint32_t next[3];   // the triangle across the edge opposite of v[i]; kNone outside
    std::uint8_t fixed = 0;  // bit i: that edge is a constraint
  };
  struct Edge {
    std::uint32_t triangle = kNone;
    int side = 0;  // opposite of v[side]
  };

  // The square [0, size]^2 in two triangles; its corners are points 0 (0, 0), 1 (size, 0),
  // 2 (size, size), 3 (0, size). Requires 1 <= size <= kMostSize.
  explicit Delaunay(int size);

  // The point's index; the old one if it was there. Requires a place inside the square that is not
  // on a constraint (but may be on the square's sides). `hint`: a triangle nearby.
  std::uint32_t insert(const glm::ivec2& place, std::uint32_t hint = 0);

  // Makes the line between two points an edge (or edges, where it passes through points) that
  // stays. False, and only some of it is there, if it would cross another constraint.
  [[nodiscard]] bool constrain(std::uint32_t from, std::uint32_t to);

  [[nodiscard]] const std::vector<glm::ivec2>& points() const { return points_; }
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  // A triangle that holds the place, on its border or inside.
  [[nodiscard]] std::uint32_t locate(const glm::ivec2& place, std::uint32_t hint = 0) const;
  // The triangle with v[side + 1] == from and v[side + 2] == to; kNone if there is none.
  [[nodiscard]] Edge find_edge(std::uint32_t from, std::uint32_t to) const;

  // Triangles that insert() and constrain() have made or changed since the last call of
  // clear_changed(); each once.
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
