// Which parts of the pictures of a frame need to be drawn?
//
// Around a silhouette most of a picture is empty, and in a forest most of the rest is hidden by
// nearer pictures; but a fragment that writes its depth cannot be rejected before it is shaded. So
// pictures are drawn in cells of the frame. Cells in which the picture is empty (occlusion_tiles.h)
// are skipped, and so are cells whose tiles are all fully occluded (occlusion culling): each tile
// is covered by opaque texels of one picture, or of two that fade into each other, that are nearer
// than this picture's nearest texel there.
//
// Cells are merged into rectangles of whole pixels, so that no sample falls between them, and cut
// to tiles at their edges. Where that is cheaper, rectangles include cells that could be skipped,
// and overlap: the overlap draws the same fragments twice.
//
// Skipping changes no sample of the frame. Pure. Frame coordinates here point upwards, as in
// OpenGL. Buffers are kept: a steady frame does not allocate.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/nailboard/occlusion_tiles.h"

namespace rilievo {

// A placed picture: its polygon relative to the frame's eye, metres, world axes.
struct PlacedPolygon {
  glm::dvec3 origin;                          // lower left corner
  glm::dvec3 u_axis, v_axis;                  // edges from there
  glm::dvec3 eye;                             // the capture eye
  double z_near = 0, z_far = 0, plane_z = 0;  // of the capturing camera
  // Are texels drawn at the depth of their Delta (otherwise at the polygon's)?
  bool relief = true;
  // May it occlude others? Requires depths between those of its Deltas.
  bool hides = true;
  // Has it a cross-fade range? The other pixels show `partner`, another of the pictures; both hide
  // what each of them would.
  bool share = false;
  std::optional<std::uint32_t> partner;
  OcclusionTilesView blocks;
};

// A rectangle to draw: what a picture shows of the frame's pixels x0 <= x < x1, y0 <= y < y1. A
// rectangle without pixels means the whole polygon.
struct DrawnCells {
  std::uint32_t picture = 0;
  std::uint16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] bool whole() const { return x1 == 0; }
  friend bool operator==(const DrawnCells&, const DrawnCells&) = default;
};

// Finds the rectangles of a frame.
class VisibleCells {
 public:
  VisibleCells();
  VisibleCells(VisibleCells&&) noexcept;
  VisibleCells& operator=(VisibleCells&&) noexcept;
  ~VisibleCells();

  // Finds the rectangles in which `pictures` can be visible, first those of pictures drawn at all
  // pixels, then those with a cross-fade range. Pictures in front-to-back order hide the most.
  // `clip_from_relative` transforms from world axes around the frame's eye. The result does not
  // depend on the number of threads.
  void find(const glm::dmat4& clip_from_relative, int width, int height, double z_near,
            double z_far, std::span<const PlacedPolygon> pictures);

  [[nodiscard]] std::span<const DrawnCells> drawn() const { return drawn_; }
  // The number of rectangles of pictures without a cross-fade range.
  [[nodiscard]] std::size_t drawn_before_shares() const { return before_shares_; }
  // Maps (x, y, 1) in pixels to the picture's texels (homogeneous); undefined for a picture that is
  // drawn whole.
  [[nodiscard]] const glm::dmat3& texel_from_raster(std::size_t picture) const;

 private:
  struct Placement;
  struct Band;
  void place(const PlacedPolygon& standing, Placement& placement) const;
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
