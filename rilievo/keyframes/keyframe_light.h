// What the source of a keyframe knows of light that rays do not: shadows, reflections, light from
// all around.
//
// Holes are filled by rays, in the light of the scene's lights alone. Beside keyframes by a path
// tracer these were bright outlines, and pillars without shadows. So at some cells of its view such
// a keyframe keeps the colour that it has there and the one that rays give the same surface. What a
// ray finds is multiplied by the factor between both, of the cells around its place that look like
// it: of the same object, and of a similar colour by rays, which have its material and its slant.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/result.h"
#include "rilievo/keyframes/keyframe.h"
#include "rilievo/keyframes/warp_keyframes.h"

namespace rilievo {

// Finds the cells' light in a complete keyframe. `rays` captures them once more, of `objects`
// (empty: all) at `time`. Fails where it does.
Result<> find_light(CaptureSource& rays, std::span<const std::uint32_t> objects, double time,
                    Keyframe& keyframe);

// Shows what rays find in a frame in the light of its keyframes. Any thread, after begin().
class Relight {
 public:
  // So far around a place cells are looked at, in these steps and without the middle twice.
  static constexpr int kReach = 2, kSteps[2] = {1, 4};

  // Keyframes without light change nothing. They must live until the last shown().
  void begin(std::span<const WarpedKeyframe> keyframes, const Camera& frame);
  [[nodiscard]] bool any() const { return !maps_.empty(); }
  // The colour of a surface of `object` (index into Scene::objects) at raster place (x, y) of the
  // frame, whose colour by rays is `color`; both are premultiplied sRGB bytes.
  [[nodiscard]] std::uint32_t shown(float x, float y, float inverse_z, std::uint32_t object,
                                    std::uint32_t color) const;

 private:
  struct Map {
    const KeyframeLight* light;
    RasterMap map;
    float weight;
  };
  std::vector<Map> maps_;
};

}  // namespace rilievo
