// The backend with OpenGL: a scene on the GPU, and pictures in textures.
#pragma once

#include <memory>

#include "rilievo/frame/backend.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

// Draws a scene's frames into the bound framebuffer. Needs a current OpenGL context.
class OpenGLBackend final : public Backend {
 public:
  // Uploads the scene, which must outlive the backend. `samples` are those of the framebuffer.
  // `deformations`: as SoftwareBackend's, for what is drawn by it; OpenGL's polygons do not bend.
  [[nodiscard]] static Result<std::unique_ptr<OpenGLBackend>> create(const Scene& scene,
                                                                     int samples);
  // A scene that is on the GPU; `renderer` must outlive the backend.
  OpenGLBackend(SceneRenderer& renderer, int samples, const Deformations* deformations = nullptr)
      : renderer_(&renderer), samples_(samples), deformations_(deformations) {}

  [[nodiscard]] SceneRenderer& renderer() const { return *renderer_; }

  [[nodiscard]] DrawnBy drawn_by() const override { return DrawnBy::opengl; }
  [[nodiscard]] const PlacedScene& placed() const override { return renderer_->placed(); }
  void set_time(double time) override { renderer_->set_time(time); }
  [[nodiscard]] const Deformations* deformations() const override { return deformations_; }
  [[nodiscard]] int samples() const override { return samples_; }

  // By OpenGL. Fails where the driver does, as do those that follow.
  [[nodiscard]] Result<std::unique_ptr<CaptureSource>> make_capture_source() override;
  [[nodiscard]] std::span<const DrawableRow> drawables() const override;
  [[nodiscard]] Result<std::unique_ptr<NailboardStore>> make_store(
      const NailboardStoreOptions& options) override;
  [[nodiscard]] Result<std::unique_ptr<PrewarpedBoards>> make_boards() override;
  [[nodiscard]] Result<PictureSet> make_pictures(std::span<const DepthImage> pictures,
                                                 DepthMode mode, int delta_bits) override;
  [[nodiscard]] Result<std::unique_ptr<Backend>> make_backend(const Scene& scene) const override;
  [[nodiscard]] Result<std::unique_ptr<FrameSource>> make_frames(
      std::unique_ptr<FrameChooser> chooser) override;
  [[nodiscard]] Result<std::unique_ptr<KeyframePainter>> make_keyframe_painter() override;
  [[nodiscard]] Result<std::unique_ptr<BackendTarget>> make_target(int width,
                                                                   int height) const override;
  void finish() override;
  [[nodiscard]] Result<SoftwareBackend*> software() override;
  [[nodiscard]] Result<std::unique_ptr<FrameSource>> present(
      std::unique_ptr<FrameSource> software_frames) override;

 private:
  std::unique_ptr<SceneRenderer> own_;  // null: the caller's
  SceneRenderer* renderer_;
  int samples_;
  const Deformations* deformations_;
  std::unique_ptr<SoftwareBackend> software_;  // null: not asked for yet
};

}  // namespace rilievo
