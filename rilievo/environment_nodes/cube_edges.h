// Which points on a shared cube edge do both faces use, and what lies there?
//
// Chosen once for both faces, so that they join without cracks: where silhouettes end or the edge
// itself begins or ends to be one, and then wherever the line between two points is wrong by most,
// on either side.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/environment_nodes/face_mesh.h"

namespace rilievo {

class CubeEdges {
 public:
  explicit CubeEdges(const CubeGrid& grid);

  // What both faces must have: the cube's corners and where something begins or ends. Each point
  // once, for the face's own view of it.
  [[nodiscard]] std::vector<BorderPoint> required(int face) const;

  // Chooses points until no corner of a texel on an edge is wrong by more than `error`, and adds
  // them to the faces' meshes.
  void refine(float error, std::array<FaceMesh*, 6> faces);

  // How many points refine() would add.
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
