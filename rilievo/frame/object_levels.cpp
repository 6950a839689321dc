#include "rilievo/frame/object_levels.h"

#include <algorithm>
#include <utility>

#include "rilievo/core/box_distance.h"

namespace rilievo {

namespace {

ObjectLevels finest(LeveledScene leveled) {
  ObjectLevels levels{std::move(leveled), {}};
  for (const Object& object : levels.leveled.scene.objects) levels.model_of.push_back(object.model);
  return levels;
}

}  // namespace

ObjectLevels make_object_levels(const Scene& scene, const LevelsOptions& options) {
  return finest(make_levels(scene, options));
}

ObjectLevels make_bounded_object_levels(const Scene& scene) {
  return finest(make_bounded_levels(scene));
}

void show_level(std::uint32_t object, const glm::mat4& pose, double error, ObjectLevels& levels) {
  const int finest = levels.model_of[object];
  levels.leveled.scene.objects[object].model =
      error > 0
          ? choose_level(levels.leveled.levels[std::size_t(finest)], error / largest_stretch(pose))
                .model
          : finest;
}

double choose_levels(const Camera& camera, std::span<const std::uint32_t> objects,
                     std::span<const glm::mat4> poses, std::span<const Box> bounds, double error_px,
                     ObjectLevels& levels) {
  double largest_px = 0;
  for (const std::uint32_t object : objects) {
    const std::vector<ModelLevel>& all =
        levels.leveled.levels[std::size_t(levels.model_of[object])];
    const Box& box = bounds[object];
    const double distance = std::max(distance_to(box, camera.position()), camera.z_near);
    const double stretch = largest_stretch(poses[object]);
    // What one pixel in the middle of the frame shows at this distance.
    const double pixel = (camera.window.top - camera.window.bottom) / camera.height * distance;
    const ModelLevel& level = choose_level(all, error_px * pixel / std::max(stretch, 1e-30));
    levels.leveled.scene.objects[object].model = level.model;
    largest_px = std::max(largest_px, level.error * stretch / pixel);
  }
  return largest_px;
}

}  // namespace rilievo
