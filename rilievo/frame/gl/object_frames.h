// Every heavy object of a scene drawn from a representation that was baked once, before the first
// frame. Which objects share one: representation/gl/object_drawables.h.
//
// Polygons are what is light, what the memory has no room for, what blends, what stretches as it
// moves, and what the eye is too near to.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/representation/gl/object_drawables.h"

namespace rilievo {

struct ObjectFramesOptions {
  ObjectDrawablesOptions objects;
  double max_texel_px = 4;  // an object whose texels would appear larger is drawn as polygons
  bool outlines = false;
};

class ObjectFrames final : public SceneFrames {
 public:
  // Bakes at the renderer's time. `renderer` must outlive it.
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
