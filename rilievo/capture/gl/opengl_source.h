// OpenGL as a source of pictures: it draws a scene with a SceneRenderer.
//
// Captures the renderer's time. Needs a current OpenGL context; changes the bound framebuffer and
// viewport.
#pragma once

#include "rilievo/capture/capture_source.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

// A scene as a capture source.
class OpenGLSource final : public CaptureSource {
 public:
  // `renderer` must outlive the source.
  explicit OpenGLSource(SceneRenderer& renderer) : renderer_(renderer) {}

  [[nodiscard]] std::string_view name() const override { return renderer_.scene().name; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // Fails where OpenGL does.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  // By depth peeling (capture_layers.h).
  [[nodiscard]] Result<LayeredDepthImage> capture_layers(const LayersRequest& request) override;
  [[nodiscard]] const Scene* scene() const override { return &renderer_.scene(); }

 private:
  SceneRenderer& renderer_;
};

}  // namespace rilievo
