// Which disparities do a node's six faces have, and where do surfaces end?
//
// Disparity is 1 / eye_z of the face. A plane is affine in it over a face (S3.2); along a shared
// cube edge both faces agree on it, because their eye_z agree; and parallax is proportional to it.
// The sky has disparity 0; a texel that shows nothing has kNothing.
//
// The half-texel lattice: raster positions in half texels over a face of n texels, (0, 0) to
// (2n, 2n), y down. Texel centres are odd, texel corners even. As a direction, a lattice point is
// an integer vector whose largest coordinate is n or -n, so that both faces name a point on their
// shared edge alike.
//
// A gate lies between two neighbouring texels. It is cut if they show different surfaces.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/core/depth_image.h"

namespace rilievo {

// The disparity of a texel that shows nothing.
inline constexpr float kNothing = -1.0f;

// The disparities of a face of a valid environment.
[[nodiscard]] Image<float> face_disparity(const DepthImage& face);

// Which steps of disparity between neighbouring texels separate surfaces? Slopes are depth per
// lateral distance, as for texel links (warp/texel_links.h), except that a plane may have any slope
// while its steps change evenly: the ground extends to the horizon.
struct CutOptions {
  float gentle = 6.0f;        // slopes up to this never separate
  float steepest = 20.0f;     // slopes up to this separate unless a step beside is comparable ...
  float growth = 2.0f;        // ... by at most this factor
  float even_growth = 1.25f;  // the factor for steeper slopes
  float least_step = 0.0f;    // 1/m: smaller steps never separate
};

// The axes of a face in node space (those of environment_cameras).
struct FaceAxes {
  glm::ivec3 forward, right, up;
};
// The axes of all faces.
[[nodiscard]] const std::array<FaceAxes, 6>& face_axes();

// A texel on a side of a face. Sides: 0 top, 1 right, 2 bottom, 3 left; `along` counts rightwards
// or downwards.
struct SideTexel {
  int face = 0, side = 0, along = 0;
};

// The disparities and gates of a node.
class CubeGrid {
 public:
  // Requires a valid environment (validate_environment).
  CubeGrid(const EnvironmentMap& map, const CutOptions& options);

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] const Image<float>& disparity(int face) const { return disparity_[face]; }
  [[nodiscard]] float at(int face, const glm::ivec2& texel) const {
    return disparity_[face](texel.x, texel.y);
  }

  // Is the gate between texels (x, y) and (x + 1, y), or (x, y + 1), of a face cut?
  [[nodiscard]] bool cut_right(int face, int x, int y) const { return cuts_[face](x, y) & 1; }
  [[nodiscard]] bool cut_below(int face, int x, int y) const { return cuts_[face](x, y) & 2; }
  // Is the gate between a border texel and its neighbour on the next face cut?
  [[nodiscard]] bool cut_border(const SideTexel& t) const {
    return border_[t.face][t.side][std::size_t(t.along)] != 0;
  }
  // Where four cut gates meet at a corner of texels, not on the border: do two texels that meet
  // there alone show one surface, nearer than the other two? A thin cable goes on so in the next
  // row.
  enum class Diagonal { none, down_right, down_left };
  [[nodiscard]] Diagonal joined_diagonal(int face, const glm::ivec2& corner) const;
  // Joins a cut gate. Not for gates next to kNothing.
  void join_right(int face, int x, int y) { cuts_[face](x, y) &= std::uint8_t(~1u); }
  void join_below(int face, int x, int y) { cuts_[face](x, y) &= std::uint8_t(~2u); }

  // The lattice point as a direction in node space, and the inverse.
  [[nodiscard]] glm::ivec3 key(int face, const glm::ivec2& half) const;
  [[nodiscard]] glm::ivec2 half(int face, const glm::ivec3& key) const;
  // A texel of a side, and the corner before it (0 ... n), in half texels.
  [[nodiscard]] glm::ivec2 side_texel(int side, int along) const;
  [[nodiscard]] glm::ivec2 side_corner(int side, int along) const;
  // The neighbour on the next face.
  [[nodiscard]] SideTexel across(const SideTexel& t) const;

  // The disparity of a texel's surface at a lattice point at most a texel away, extrapolated by the
  // mean step to linked neighbours and limited to a factor of two.
  [[nodiscard]] float continued(int face, const glm::ivec2& texel, const glm::ivec2& half) const;

 private:
  void find_cuts();
  void find_border_cuts();

  int size_ = 0;
  CutOptions options_;
  std::array<Image<float>, 6> disparity_;
  std::array<Image<std::uint8_t>, 6> cuts_;
  std::array<std::array<std::vector<std::uint8_t>, 4>, 6> border_;
};

// Checks for six square faces of one size (2 to 4096 texels), 90 degrees wide, at one point, in
// order and with consistent axes, and for depths that are positive and at least 1e-30 m, so that
// disparities are finite floats. The error says what is wrong.
[[nodiscard]] Result<> validate_environment(const EnvironmentMap& map);

// The rigid motion from node space, in which the faces are those of environment_cameras.
[[nodiscard]] glm::dmat4 world_from_node(const EnvironmentMap& map);

}  // namespace rilievo
