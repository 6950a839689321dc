// How are frames drawn from representations that were baked once, one for each heavy object?
//
// Objects can share one (representation/gl/object_drawables.h). Drawn as polygons: light objects,
// objects beyond the memory limit, blended parts, objects that deform as they move, and objects too
// near to the eye.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/representation/gl/object_drawables.h"

namespace rilievo {

// What to bake, and when to use it.
struct ObjectFramesOptions {
  ObjectDrawablesOptions objects;
  double max_texel_px = 4;  // objects with larger texels on the screen are drawn as polygons
  bool outlines = false;
};

// A frame source for baked objects.
class ObjectFrames final : public SceneFrames {
 public:
  // Bakes at the renderer's time. `renderer` must outlive the source. Fails where a bake fails.
  [[nodiscard]] static Result<std::unique_ptr<ObjectFrames>> create(
      SceneRenderer& renderer, const Kind& kind, std::unique_ptr<DrawableFactory> factory,
      const ObjectFramesOptions& options);

 private:
  using SceneFrames::SceneFrames;
  // The first frame counts the time of the bake as its own.
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
  [[nodiscard]] std::optional<Instance> instance_of(std::uint32_t object,
                                                    const Camera& camera) const;

  struct Baked {
    ObjectDrawable object;
    ErrorModel error;
  };
  std::unique_ptr<DrawableFactory> factory_;
  std::vector<Baked> baked_;
  std::vector<int> baked_of_;  // by object; -1: none
  std::vector<std::uint32_t> visible_;
  double max_texel_px_ = 4;
  std::size_t bytes_ = 0;
  int captures_ = 0;       // not reported yet ...
  double capture_ms_ = 0;  // ... nor how long they took
};

}  // namespace rilievo
