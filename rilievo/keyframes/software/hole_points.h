// What rays found in holes, shown again in the frames after.
//
// A hole stays open until a keyframe shows what is there, for some twenty frames. So what a ray
// found is kept as a point of the world with its colour; of the sky, as a direction. A hole shows
// the point nearest to the eye of those within kReach pixels of its middle; if there is none,
// within kFarReach. Rays are cast of the other holes only. A point that no hole shows is forgotten:
// there are at most as many as holes.
//
// Among leaves points land where they happen to: with squares of a pixel's size alone, rays would
// be cast of more than a third of a grove's holes; with those of kFarReach it is a fifth.
//
// For what stands still. All cores; the result does not depend on the number of threads. A steady
// frame allocates nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/image.h"
#include "rilievo/render/rays/cast_pixels.h"

namespace rilievo {

// What a ray found in the middle of a pixel.
struct FoundInHole {
  FramePixel pixel;
  float inverse_z = 0;       // 1 / eye_z; 0: nothing but the sky
  std::uint32_t color = 0;   // premultiplied sRGB bytes, of a surface
  std::uint32_t object = 0;  // index into Scene::objects, of a surface
};

// The points of the frames of one eye.
class HolePoints {
 public:
  // Half of the side of a point's square, in pixels: a little more than half, so that points of one
  // surface leave no cracks between them through which others behind it would be shown. And of the
  // square where there is no other point.
  static constexpr float kReach = 0.55f, kFarReach = 0.9f;

  // A point is shown in at most so many pixels.
  static constexpr std::size_t kMostShown = 4;
  static_assert(2 * kFarReach < 2, "of a row, two pixels");

  // Shows points in the holes of a frame, but those of objects for which `included` is false.
  void show(const Camera& camera, std::span<const FramePixel> holes,
            std::span<const bool> included);

  // Is hole i of the last show() shown? And what: as FoundInHole has it.
  [[nodiscard]] bool shows(std::size_t hole) const { return shown_[hole] != 0; }
  [[nodiscard]] float inverse_z(std::size_t hole) const;
  [[nodiscard]] std::uint32_t color(std::size_t hole) const { return at(hole).color; }
  [[nodiscard]] std::uint32_t object(std::size_t hole) const { return at(hole).object; }

  // Forgets the points that the last show() did not show, and takes what rays found in a frame of
  // this camera.
  void keep(const Camera& camera, std::span<const FoundInHole> found);
  // Forgets all.
  void clear();
  // Forgets all, and allocates what frames of this size need (pixels) in which rays fill so many
  // holes and points show as many others.
  void take_memory(int width, int height, std::size_t holes);
  [[nodiscard]] std::size_t size() const { return points_.size(); }

 private:
  struct Point {
    glm::vec4 place;  // world axes, from origin_; w = 0: a direction
    std::uint32_t color, object;
  };
  [[nodiscard]] const Point& at(std::size_t hole) const {
    return points_[std::uint32_t(shown_[hole]) - 1];
  }

  glm::dvec3 origin_{0.0};  // where the eye was some time ago
  std::vector<Point> points_;
  // By hole: whether it is within kReach, 1 / eye_z as bits, and the index of the point + 1; 0: no
  // point. The largest is shown.
  std::vector<std::uint64_t> shown_;
  std::vector<std::uint8_t> used_;  // by point
  Image<std::uint32_t> index_;      // of each pixel's hole, + 1; 0: it is none. Of show()
};

}  // namespace rilievo
