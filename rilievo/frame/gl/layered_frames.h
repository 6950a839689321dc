// Every heavy object of a scene as a layered impostor: pictures taken from all around once, before
// the first frame, and never again. Which objects share one: object_impostors.h.
//
// Polygons are what is light, what the memory has no room for, what blends, what stretches as it
// moves, and what the eye is too near to.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "rilievo/frame/gl/frame_source.h"
#include "rilievo/layered_impostor/gl/layered_drawer.h"
#include "rilievo/layered_impostor/gl/object_impostors.h"

namespace rilievo {

struct LayeredFramesOptions {
  ObjectImpostorOptions impostors;  // `method` is that of `layered`
  LayeredOptions layered;
  double max_texel_px = 4;  // an object whose texels would appear larger is drawn as polygons
};

class LayeredFrames : public FrameSource {
 public:
  // Bakes at the renderer's time. `renderer` must outlive it.
  [[nodiscard]] static Result<LayeredFrames> create(SceneRenderer& renderer,
                                                    const LayeredFramesOptions& options);

  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  // The first frame has the captures, and their time, of create().
  [[nodiscard]] FrameFigures figures() const override { return figures_; }

 private:
  struct Impostor {
    ObjectImpostor baked;
    double texel = 0;  // metres, at the centre
    std::vector<LayeredInstance> instances{};
  };

  LayeredFrames(SceneRenderer& renderer, LayeredDrawer drawer)
      : renderer_(renderer), drawer_(std::move(drawer)) {}
  [[nodiscard]] std::optional<LayeredInstance> instance_of(std::uint32_t object,
                                                           const Camera& camera) const;

  SceneRenderer& renderer_;
  LayeredFramesOptions options_;
  LayeredDrawer drawer_;
  std::vector<Impostor> impostors_;
  std::vector<int> impostor_of_;  // by object; -1: none
  std::vector<std::uint32_t> visible_, polygons_;
  Camera camera_;
  double time_ = 0;
  int captures_ = 0;       // not reported yet ...
  double capture_ms_ = 0;  // ... nor how long they took
  FrameFigures figures_;
};

}  // namespace rilievo
