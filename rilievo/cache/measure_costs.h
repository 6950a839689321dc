// How is a backend measured, so that its costs are known (cache/machine_costs.h)?
//
// A scene of balls: the same number of them with many and with few triangles, and many small ones.
// Times of frames and of captures that differ in one thing only tell what that thing costs. Each
// time is the least of a few runs, which take turns. On two cores all of a backend takes less than
// a second; nothing else should run. The results are rounded to three digits.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "rilievo/cache/cache_pictures.h"
#include "rilievo/cache/machine_costs.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// A run of objects, or of pictures: [first, first + count).
struct MeasuredRun {
  std::uint32_t first = 0, count = 0;
  std::uint64_t triangles = 0;  // of each object
};

// What is drawn to be measured. Each run of balls covers the whole frame, side by side.
struct MeasuredScene {
  Scene scene;
  Camera frame;
  MeasuredRun heavy, light, small;   // objects; the first two of the same size
  std::vector<DepthImage> pictures;  // of the balls of `light`, then of `small`
};
[[nodiscard]] MeasuredScene measured_scene();

// Draws frames of polygons or of pictures, without a sky.
class MeasuredFrames {
 public:
  virtual ~MeasuredFrames() = default;
  // Draws these objects of MeasuredScene::scene as polygons, or these of its pictures; both can be
  // empty. Returns when the frame is complete.
  virtual Result<> draw(const MeasuredRun& objects, const MeasuredRun& pictures) = 0;
};

// A time to three digits, within what a file may hold.
[[nodiscard]] double rounded_ns(double ns);
// What drawing takes.
[[nodiscard]] Result<DrawTimes> measure_drawing(const MeasuredScene& scene, MeasuredFrames& frames);
// What captures take, into empty slots of `pictures`.
[[nodiscard]] CaptureTimes measure_captures(const MeasuredScene& scene, CachePictures& pictures);

}  // namespace rilievo
