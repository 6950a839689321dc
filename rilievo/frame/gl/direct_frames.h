// Direct drawing of every object as polygons: the true frame, and the baseline.
#pragma once

#include <vector>

#include "rilievo/frame/gl/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

class DirectFrames : public FrameSource {
 public:
  // `renderer` must outlive it.
  explicit DirectFrames(SceneRenderer& renderer) : renderer_(renderer) {}

  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  [[nodiscard]] FrameFigures figures() const override { return figures_; }

 private:
  SceneRenderer& renderer_;
  Camera camera_;
  double time_ = 0;
  std::vector<std::uint32_t> visible_;
  FrameFigures figures_;
};

}  // namespace rilievo
