// Which triangles approximate one face of a node?
//
// A constrained Delaunay triangulation of the face on the half-texel lattice (cube_grid.h).
// Silhouettes are constraints, and a point on one has a disparity for each side of it. The other
// points are texel centres with the texel's own disparity, inserted where the triangles have the
// largest error. The points on the face's border are given, so that neighbouring faces share them.
// Not thread-safe; use one object per thread. The triangles do not depend on threads.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/environment_nodes/delaunay.h"
#include "rilievo/environment_nodes/silhouettes.h"

namespace rilievo {

// A point of the face's border. If a silhouette ends there, it has two sides: left of `spoke`
// (orientation > 0) and right; otherwise both are equal.
struct BorderPoint {
  glm::ivec2 at{0};  // half texels
  float left = 0, right = 0;
  std::uint8_t left_copy = 0, right_copy = 0;  // index of the point's surface
};

// The triangulation of a face.
class FaceMesh {
 public:
  // `border` contains at least the face's corners and the ends of `silhouettes` on the border.
  // `grid` must outlive the object.
  FaceMesh(const CubeGrid& grid, int face, std::span<const Silhouette> silhouettes,
           std::span<const BorderPoint> border);

  void add_border(const BorderPoint& point);

  // Inserts texels until no texel's disparity has an error above `error` (1/m), or `most` of them
  // have been inserted. Appends the error of each inserted texel to `errors`, if given.
  void refine(float error, std::size_t most, std::vector<float>* errors = nullptr);

  // The largest error of a texel in any triangle, 1/m.
  [[nodiscard]] float worst_error() const;
  // The number of triangles that show something.
  [[nodiscard]] std::size_t count_triangles() const;
  [[nodiscard]] bool shows_something(std::uint32_t triangle) const { return shown_[triangle] != 0; }

  [[nodiscard]] const Delaunay& mesh() const { return mesh_; }
  // The surface at a triangle's corner: its disparity, its index among the point's surfaces, and
  // the place of the nearest texels that show it, in half texels.
  struct Corner {
    float disparity = 0;
    int copy = 0;
    glm::vec2 anchor{0.0f};
  };
  [[nodiscard]] Corner corner(std::uint32_t triangle, int i) const;
  // The number of surfaces that meet at a point.
  [[nodiscard]] int copies(std::uint32_t point) const;

 private:
  // A point on silhouettes or on the border: directions of its lines, counter-clockwise, and the
  // surfaces between each and the next.
  struct Joint {
    bool border = false;
    int spokes = 0;
    glm::ivec2 spoke[4];
    Corner sector[4];
  };
  struct Candidate {
    float error;
    std::uint32_t triangle, stamp;
    bool operator<(const Candidate& o) const {
      return error != o.error ? error < o.error : triangle > o.triangle;
    }
  };
  struct Worst {
    float error = 0;
    int x = 0, y = 0;
    std::uint32_t stamp = 0;
  };

  std::uint32_t add_joint(const glm::ivec2& at);
  void finish_joint(std::uint32_t point, const BorderPoint* border);
  [[nodiscard]] int sector_of(const Joint& joint, const glm::ivec2& towards) const;
  void scan(std::uint32_t triangle);
  void scan_changed();
  void set_value(std::uint32_t point, float disparity);

  const CubeGrid& grid_;
  int face_ = 0;
  Delaunay mesh_;
  std::vector<float> value_;            // by point
  std::vector<std::int32_t> joint_of_;  // by point; -1: a texel's centre
  std::vector<Joint> joints_;
  std::vector<Worst> worst_;         // by triangle
  std::vector<std::uint8_t> shown_;  // by triangle
  std::vector<Candidate> queue_;     // a heap
  std::size_t shown_count_ = 0;
};

}  // namespace rilievo
