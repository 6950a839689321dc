// Which points on a shared cube edge do both faces use, and which surfaces are there?
//
// The points are chosen once for both faces, so that the faces join without cracks: first where
// silhouettes end and where the edge itself begins or ceases to be a silhouette, then wherever the
// line between two points has the largest error on either side.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/environment_nodes/face_mesh.h"

namespace rilievo {

// The points on the twelve edges.
class CubeEdges {
 public:
  explicit CubeEdges(const CubeGrid& grid);

  // The points that both faces need: the cube's corners and the ends of silhouettes, each once, as
  // seen from this face.
  [[nodiscard]] std::vector<BorderPoint> required(int face) const;

  // Chooses points until no texel corner on an edge has an error above `error` (disparity, 1/m),
  // and adds them to the faces' meshes.
  void refine(float error, std::array<FaceMesh*, 6> faces);

  // The number of points that refine() would add.
  [[nodiscard]] std::size_t count(float error) const;

 private:
  // Of a corner on an edge, 0 ... n: the disparity on the side of each face, before and after it
  // (alike, if nothing ends there), and which of the corner's surfaces that is.
  struct Place {
    float before[2], after[2];
    std::uint8_t copy_before[2], copy_after[2];
  };
  struct CubeEdge {
    SideTexel side[2];      // of both faces; `along` unused
    bool reversed = false;  // the second face counts the other way
    std::vector<Place> places;
    std::vector<int> chosen;  // ascending
  };

  void measure(CubeEdge& edge);
  void mend_corners();
  [[nodiscard]] BorderPoint seen_by(const CubeEdge& edge, int which, int place) const;
  void choose(const CubeEdge& edge, int from, int to, float error, std::vector<int>& added) const;

  const CubeGrid& grid_;
  std::vector<CubeEdge> edges_;
};

}  // namespace rilievo
