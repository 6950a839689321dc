// Relights the holes that rays fill, so that they match the keyframes around them.
//
// Rays shade without shadows and without light from other surfaces. A path tracer's keyframe has
// both, so that plain fills would be bright outlines in it. Such a keyframe keeps a grid of cells:
// each has the keyframe's colour and the colour that rays give the same surface. The colour of a
// fill is multiplied by the ratio of the two, a weighted mean over the cells around its place. A
// cell has more weight if it is near, shows the same object, and has a similar colour by rays: then
// it probably shows the same material at the same angle.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/result.h"
#include "rilievo/keyframes/keyframe.h"
#include "rilievo/keyframes/warp_keyframes.h"

namespace rilievo {

// Fills the cells of a complete keyframe. `rays` captures its view once more, one sample a cell, of
// `objects` (empty: all) at `time` (seconds). Fails where that capture does.
Result<> find_light(CaptureSource& rays, std::span<const std::uint32_t> objects, double time,
                    Keyframe& keyframe);

// Relights the fills of a frame. After begin() any number of threads may call the rest.
class Relight {
 public:
  // The cells around a place: a square of 2 kReach + 1 cells at each of these steps.
  static constexpr int kReach = 2, kSteps[2] = {1, 4};

  // Begins a frame. Keyframes without cells change nothing. All must live until the last shown().
  void begin(std::span<const WarpedKeyframe> keyframes, const Camera& frame);
  [[nodiscard]] bool any() const { return !maps_.empty(); }
  // Returns the relit colour of a surface at raster position (x, y) of the frame, in pixels, and
  // 1 / eye_z. `object` is an index into Scene::objects, `color` what rays shade there. Colours are
  // premultiplied sRGB bytes.
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
