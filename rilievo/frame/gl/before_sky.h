// What draws no sky of its own, before a scene's.
#pragma once

#include <memory>
#include <utility>

#include "rilievo/frame/gl/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

class BeforeSky : public FrameSource {
 public:
  // `sky` must outlive it.
  BeforeSky(std::unique_ptr<FrameSource> source, SceneRenderer& sky)
      : source_(std::move(source)), sky_(sky) {}

  Result<> draw(const Camera& camera, double time) override {
    if (Result<> drawn = source_->draw(camera, time); !drawn) return drawn;
    sky_.draw_sky(camera, OutputEncoding::srgb);
    return Done{};
  }
  Result<> draw_objects() override { return source_->draw_objects(); }
  [[nodiscard]] FrameFigures figures() const override { return source_->figures(); }

 private:
  std::unique_ptr<FrameSource> source_;
  SceneRenderer& sky_;
};

}  // namespace rilievo
