// Which parts of the pictures of a frame need to be drawn?
//
// A picture is mostly nothing around a silhouette, and in a forest most of the rest is hidden by
// the pictures before it; but a fragment that writes its depth cannot be rejected before it is
// shaded. So pictures are drawn cell by cell (picture_blocks.h): empty cells are left out, and so
// are those of which every pixel lies in a tile of the frame that a picture drawn before closes:
// one that covers all of it with opaque texels nearer than the cell's nearest.
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

// Texels x0 <= x < x1, y0 <= y < y1 of a picture.
struct DrawnCells {
  std::uint32_t picture = 0;
  std::uint16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  friend bool operator==(const DrawnCells&, const DrawnCells&) = default;
};

class VisibleCells {
 public:
  // clip_from_relative: from axes of the world around the frame's eye.
  void begin(const glm::dmat4& clip_from_relative, int width, int height, double z_near,
             double z_far);
  // Appends the rectangles of `picture` that may be seen. Those that hide most come first if
  // pictures come front to back. Rectangles reach one texel over the cells that they stand for, so
  // that no sample falls between two.
  void append(std::uint32_t picture, const StandingPicture& standing,
              const PictureBlocksView& blocks, std::vector<DrawnCells>& drawn);

 private:
  struct Homography;
  void append_cells(std::uint32_t picture, const Homography& raster_from_texel,
                    const StandingPicture& standing, const PictureBlocksView& blocks,
                    std::vector<DrawnCells>& drawn);
  void close_tiles(const Homography& raster_from_texel, const PictureBlocksView& blocks);

  static constexpr int kTile = 8;  // pixels a side
  glm::dmat4 clip_from_relative_{1.0};
  int width_ = 0, height_ = 0, tiles_ = 0, tile_rows_ = 0;
  double z_near_ = 0, z_far_ = 0;
  std::vector<float> closed_;  // by tile: eye_z beyond which nothing is seen
  std::vector<glm::dvec3> lower_, upper_;
  std::vector<std::uint32_t> open_runs_, next_runs_;
};

}  // namespace rilievo
