// What of a node's six faces does its triangulation look at: disparities, and where surfaces end?
//
// Disparity is 1 / eye_z of the face: a plane is affine in it over a face (S3.2), it is the same
// from both faces along a shared cube edge, where eye_z is the same, and it is what parallax is
// proportional to. The sky has disparity 0; a texel that shows nothing has kNothing.
//
// The half-texel lattice: over a face of n texels, raster positions in half texels, (0, 0) to
// (2n, 2n), y down. Texels' centres are odd, their corners even. As a direction, a lattice point is
// a whole-numbered vector whose largest coordinate is n or -n: points on shared cube edges have one
// name.
//
// A gate is what lies between two neighbouring texels; it is cut if they show different surfaces.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/core/depth_image.h"

namespace rilievo {

inline constexpr float kNothing = -1.0f;

// Which steps of disparity between neighbouring texels are jumps to another surface? Depth per
// lateral distance, as for texel links (core/texel_links.h), except that a plane may be as steep as
// it likes while its steps go on evenly: the ground reaches the horizon.
struct CutOptions {
  float gentle = 6.0f;        // up to this slope never
  float steepest = 20.0f;     // up to this one not if a step beside it is half as large ...
  float growth = 2.0f;        // ... to say it in numbers
  float even_growth = 1.25f;  // above, only if a step beside it is nearly as large
  float least_step = 0.0f;    // 1/m: smaller ones never
};

// The axes of a face in the node's own space (those of environment_cameras).
struct FaceAxes {
  glm::ivec3 forward, right, up;
};
[[nodiscard]] const std::array<FaceAxes, 6>& face_axes();

// Sides of a face: 0 top, 1 right, 2 bottom, 3 left; places along them count rightwards, downwards.
struct SideTexel {
  int face = 0, side = 0, along = 0;
};

class CubeGrid {
 public:
  // Requires a valid environment (validate_environment).
  CubeGrid(const EnvironmentMap& map, const CutOptions& options);

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] const Image<float>& disparity(int face) const { return disparity_[face]; }
  [[nodiscard]] float at(int face, const glm::ivec2& texel) const {
    return disparity_[face](texel.x, texel.y);
  }

  // Between texels (x, y) and (x + 1, y), or (x, y + 1), of one face.
  [[nodiscard]] bool cut_right(int face, int x, int y) const { return cuts_[face](x, y) & 1; }
  [[nodiscard]] bool cut_below(int face, int x, int y) const { return cuts_[face](x, y) & 2; }
  // Between a border texel and its neighbour on the next face.
  [[nodiscard]] bool cut_border(const SideTexel& t) const {
    return border_[t.face][t.side][std::size_t(t.along)] != 0;
  }
  // Joins what a gate has parted. Not for gates to nothing.
  void join_right(int face, int x, int y) { cuts_[face](x, y) &= std::uint8_t(~1u); }
  void join_below(int face, int x, int y) { cuts_[face](x, y) &= std::uint8_t(~2u); }

  // The lattice point as a direction of the node's space, and back.
  [[nodiscard]] glm::ivec3 key(int face, const glm::ivec2& half) const;
  [[nodiscard]] glm::ivec2 half(int face, const glm::ivec3& key) const;
  // The texel of a side, and the corner before it (0 ... n), in half texels.
  [[nodiscard]] glm::ivec2 side_texel(int side, int along) const;
  [[nodiscard]] glm::ivec2 side_corner(int side, int along) const;
  // Its neighbour on the next face.
  [[nodiscard]] SideTexel across(const SideTexel& t) const;

  // The texel's surface, continued to a lattice point at most a texel away: with the mean of its
  // disparity's steps to linked neighbours; within a factor of two of its own.
  [[nodiscard]] float continued(int face, const glm::ivec2& texel, const glm::ivec2& half) const;

 private:
  void find_cuts(const CutOptions& options);
  void find_border_cuts(const CutOptions& options);

  int size_ = 0;
  std::array<Image<float>, 6> disparity_;
  std::array<Image<std::uint8_t>, 6> cuts_;
  std::array<std::array<std::vector<std::uint8_t>, 4>, 6> border_;
};

// Is this six square faces of one size, 2 to 4096 texels, 90 degrees wide, at one point, in order
// and turned alike? The error says what is not.
[[nodiscard]] Result<> validate_environment(const EnvironmentMap& map);

// The rigid motion from the node's own space, in which the faces are those of environment_cameras.
[[nodiscard]] glm::dmat4 world_from_node(const EnvironmentMap& map);

}  // namespace rilievo
