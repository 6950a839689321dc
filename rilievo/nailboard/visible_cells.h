// Which parts of the pictures of a frame need to be drawn?
//
// A picture is mostly nothing around a silhouette, and in a forest most of the rest is hidden by
// the pictures before it; but a fragment that writes its depth cannot be rejected before it is
// shaded. So pictures are drawn by cells of the frame. Left out are cells in which the picture is
// empty (picture_blocks.h), and those of which every tile is closed by a picture before: one that
// covers all of the tile with opaque texels nearer than this picture's nearest there; or two of
// which one fades into the other and that both do.
//
// Cells are joined to rectangles of whole pixels, so that no sample falls between, and cut to the
// tiles at their edges. Where it is cheaper they hold cells that could be left out, and may lie
// over each other: what is drawn twice is the same twice.
//
// What is left out changes no sample of the frame. Pure; frame raster here runs upwards, as
// OpenGL's does. Keeps its buffers: a steady frame does not allocate.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/nailboard/picture_blocks.h"

namespace rilievo {

// Where a picture's polygon stands, relative to the frame's eye, metres, axes of the world.
struct StandingPicture {
  glm::dvec3 origin;                          // lower left corner
  glm::dvec3 u_axis, v_axis;                  // edges from there
  glm::dvec3 eye;                             // the capturing one
  double z_near = 0, z_far = 0, plane_z = 0;  // of the capturing camera
  // Do texels stand where their Delta says (else on the polygon)?
  bool relief = true;
  // May it hide others: does it have depths between those that Delta says?
  bool hides = true;
  // Is only a share of its pixels drawn? Those that it leaves out are drawn of `partner`, another
  // of the pictures: they hide what both of them would.
  bool share = false;
  std::optional<std::uint32_t> partner;
  PictureBlocksView blocks;
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
  VisibleCells();
  VisibleCells(VisibleCells&&) noexcept;
  VisibleCells& operator=(VisibleCells&&) noexcept;
  ~VisibleCells();

  // Finds the rectangles of the frame in which `pictures` may be seen: those of pictures of which
  // all pixels are drawn, then those of shares. Most is hidden if pictures come front to back.
  // clip_from_relative: from axes of the world around the frame's eye. The same for any number of
  // threads.
  void find(const glm::dmat4& clip_from_relative, int width, int height, double z_near,
            double z_far, std::span<const StandingPicture> pictures);

  [[nodiscard]] std::span<const DrawnCells> drawn() const { return drawn_; }
  [[nodiscard]] std::size_t drawn_before_shares() const { return before_shares_; }
  // Takes (x, y, 1), pixels, to the texels there (homogeneous); meaningless if the picture is to be
  // drawn whole.
  [[nodiscard]] const glm::dmat3& texel_from_raster(std::size_t picture) const;

 private:
  struct Placement;
  struct Band;
  void place(const StandingPicture& standing, Placement& placement) const;
  void look_at_band(Band& band);
  std::uint8_t look_at_cell(const Placement& placement, int column, int row);

  // Joined to rectangles: cells of kCell x kCell pixels; seen or hidden: tiles of kTile x kTile.
  static constexpr int kTile = 4, kTiles = 2, kCell = kTile * kTiles;
  static constexpr int kBands = 8;  // of the frame, each for itself
  glm::dmat4 clip_from_relative_{1.0};
  int width_ = 0, height_ = 0;
  double z_near_ = 0, z_far_ = 0;
  std::size_t stride_ = 0;     // tiles from one row to the next
  std::vector<float> closed_;  // by tile: eye_z beyond which nothing is seen
  std::vector<Placement> placed_;
  std::vector<Band> bands_;
  std::vector<DrawnCells> drawn_;
  std::size_t before_shares_ = 0;
};

}  // namespace rilievo
