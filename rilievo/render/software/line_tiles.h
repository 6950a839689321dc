// How do outlines of pictures (S1.8) get into a frame that processors draw?
//
// Lines of one pixel's width in OpenGL's colour of outlines, over everything that is not nearer.
// With 4 samples a line covers the rectangle around it; with one, of each column or row that it
// crosses the nearest pixel. Writes no depth.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// Draws lines into the tiles of a SoftwareTarget.
class LineTiles final : public TileDrawer {
 public:
  // Begins a frame. Requires a perspective camera.
  void begin(const Camera& camera);
  // Adds a line between two points in the world. What lies before the near plane is cut off.
  void add(const glm::dvec3& from, const glm::dvec3& to);
  // Adds a closed polygon.
  void add_loop(std::span<const glm::dvec3> corners);
  // Adds the edges of a box, placed by a matrix.
  void add_box(const glm::dvec3& low, const glm::dvec3& high, const glm::dmat4& world_from_box);

  void draw_tile(FrameTile& tile) const override;

 private:
  // In the frame, pixels; y points down.
  struct Line {
    glm::dvec2 from, along;  // along: unit
    double length = 0;
    double inverse_z = 0, per_px = 0;  // 1 / eye_z at `from`, and along the line
    glm::dvec2 low, high;
  };
  [[nodiscard]] unsigned covered(const Line& line, double x, double y, int samples) const;

  Camera camera_;
  glm::dmat4 eye_from_world_{1.0};
  std::vector<Line> lines_;
};

}  // namespace rilievo
