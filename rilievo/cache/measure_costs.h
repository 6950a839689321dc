// Measures what drawing and capturing cost by a backend (cache/prices/machine_costs.h).
//
// A scene of balls: the same number of them with many and with few triangles, and many small ones.
// Times of frames and of captures that differ in one thing only tell what that thing costs. Each
// time is the least of a few runs, which take turns. On two cores all of a backend takes less than
// a second; nothing else should run. The results are rounded to three digits.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rilievo/cache/prices/machine_costs.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/frame/frame_chooser.h"
#include "rilievo/nailboard/nailboard_store.h"
#include "rilievo/nailboard/picture_set.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// A run of objects, or of pictures: [first, first + count).
struct MeasuredRun {
  std::uint32_t first = 0, count = 0;
  std::uint64_t triangles = 0;  // of each object
};

// A scene to measure. Each run of balls covers the whole frame, side by side.
struct MeasuredScene {
  Scene scene;
  Camera frame;
  MeasuredRun heavy, light, small;   // objects; the first two of the same size
  std::vector<DepthImage> pictures;  // of the balls of `light`, then of `small`
};
[[nodiscard]] MeasuredScene measured_scene();

// Chooses an explicit list of objects and pictures, without a sky.
class MeasuredChooser final : public FrameChooser {
 public:
  // `pictures` are of MeasuredScene::pictures.
  explicit MeasuredChooser(PictureSet pictures) : pictures_(std::move(pictures)) {}
  void show(const MeasuredRun& objects, const MeasuredRun& pictures) {
    objects_ = objects, shown_ = pictures;
  }

  void add_sets(FrameContent& content) override;
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats& stats) override;

 private:
  PictureSet pictures_;
  MeasuredRun objects_, shown_;
};

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
// The time of drawing.
[[nodiscard]] Result<DrawTimes> measure_drawing(const MeasuredScene& scene, MeasuredFrames& frames);
// Polygons alone, in a fifth of the time.
[[nodiscard]] Result<PolygonTimes> measure_polygons(const MeasuredScene& scene,
                                                    MeasuredFrames& frames);
// The time of captures, into empty slots of `pictures`.
[[nodiscard]] CaptureTimes measure_captures(const MeasuredScene& scene, NailboardStore& pictures);

}  // namespace rilievo
