// Which parts of the pictures of a frame need to be drawn?
//
// A picture is mostly nothing around a silhouette, and in a forest most of the rest is hidden by
// the pictures before it; but a fragment that writes its depth cannot be rejected before it is
// shaded. So pictures are drawn by cells of the frame. Left out are cells in which the picture is
// empty (picture_blocks.h), and those of which every tile is closed by a picture drawn before: one
// that covers all of the tile with opaque texels nearer than this picture's nearest there.
//
// Cells consist of whole pixels: where two of one picture meet, nothing is shaded twice and no
// sample falls between.
//
// What is left out changes no sample of the frame. Pure; frame raster here runs upwards, as
// OpenGL's does. Keeps its buffers: a steady frame does not allocate.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/draw/picture_blocks.h"

namespace rilievo {

// Where a picture's polygon stands, relative to the frame's eye, metres, axes of the world.
struct StandingPicture {
  glm::dvec3 origin;                          // lower left corner
  glm::dvec3 u_axis, v_axis;                  // edges from there
  glm::dvec3 eye;                             // the capturing one
  double z_near = 0, z_far = 0, plane_z = 0;  // of the capturing camera
  // Do texels stand where their Delta says (else on the polygon)?
  bool relief = true;
  // May it hide others: is all of it drawn, with depths between those that Delta says?
  bool hides = true;
};

// Of a picture, what it shows of the frame's pixels x0 <= x < x1, y0 <= y < y1. No pixels at all:
// the whole polygon, wherever it reaches.
struct DrawnCells {
  std::uint32_t picture = 0;
  std::uint16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] bool whole() const { return x1 == 0; }
  friend bool operator==(const DrawnCells&, const DrawnCells&) = default;
};

class VisibleCells {
 public:
  // clip_from_relative: from axes of the world around the frame's eye.
  void begin(const glm::dmat4& clip_from_relative, int width, int height, double z_near,
             double z_far);
  // Appends the rectangles of the frame in which `picture` may be seen. Those that hide most come
  // first if pictures come front to back. Returns what takes (x, y, 1), pixels, to the texels there
  // (homogeneous); meaningless if the picture is to be drawn whole.
  glm::dmat3 append(std::uint32_t picture, const StandingPicture& standing,
                    const PictureBlocksView& blocks, std::vector<DrawnCells>& drawn);

 private:
  struct Placement;
  bool look_at_cell(const Placement& placement, const PictureBlocksView& blocks, int column,
                    int row);
  void append_runs(std::uint32_t picture, const Placement& placement, int row,
                   std::vector<DrawnCells>& drawn);

  // Drawn or left out as a whole: cells of kCell x kCell pixels; hidden by tiles of kTile x kTile.
  static constexpr int kTile = 8, kTiles = 2, kCell = kTile * kTiles;
  glm::dmat4 clip_from_relative_{1.0};
  int width_ = 0, height_ = 0;
  double z_near_ = 0, z_far_ = 0;
  std::size_t stride_ = 0;          // tiles from one row to the next
  std::vector<float> closed_;       // by tile: eye_z beyond which nothing is seen
  std::vector<std::uint8_t> seen_;  // by cell of a row
  std::vector<std::uint32_t> open_runs_, next_runs_;
};

}  // namespace rilievo
