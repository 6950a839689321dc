#include "rilievo/frame/gl/opengl_backend.h"

#include <utility>

#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/frame/gl/opengl_frames.h"
#include "rilievo/frame/gl/opengl_target.h"
#include "rilievo/frame/gl/presented_frames.h"
#include "rilievo/gl/context.h"
#include "rilievo/keyframes/gl/opengl_painter.h"
#include "rilievo/nailboard/gl/atlas_boards.h"
#include "rilievo/nailboard/gl/atlas_pictures.h"
#include "rilievo/nailboard/gl/atlas_store.h"
#include "rilievo/representation/gl/factories.h"

namespace rilievo {
Result<std::unique_ptr<OpenGLBackend>> OpenGLBackend::create(const Scene& scene, int samples) {
  Result<SceneRenderer> renderer = SceneRenderer::create(scene);
  if (!renderer) return renderer.error();
  auto own = std::make_unique<SceneRenderer>(std::move(*renderer));
  auto backend = std::make_unique<OpenGLBackend>(*own, samples);
  backend->own_ = std::move(own);
  return {std::move(backend)};
}

Result<std::unique_ptr<CaptureSource>> OpenGLBackend::make_capture_source() {
  return {std::make_unique<OpenGLSource>(*renderer_)};
}

std::span<const DrawableRow> OpenGLBackend::drawables() const { return drawable_rows(); }

Result<std::unique_ptr<NailboardStore>> OpenGLBackend::make_store(
    const NailboardStoreOptions& options) {
  return make_atlas_store(*renderer_, options);
}

Result<std::unique_ptr<PrewarpedBoards>> OpenGLBackend::make_boards() {
  Result<std::unique_ptr<AtlasBoards>> boards = AtlasBoards::create();
  if (!boards) return boards.error();
  return {std::move(*boards)};
}

Result<PictureSet> OpenGLBackend::make_pictures(std::span<const DepthImage> pictures,
                                                DepthMode mode, int delta_bits) {
  return make_atlas_pictures(pictures, mode, delta_bits);
}

Result<std::unique_ptr<Backend>> OpenGLBackend::make_backend(const Scene& scene) const {
  Result<std::unique_ptr<OpenGLBackend>> made = create(scene, samples_);
  if (!made) return made.error();
  return {std::move(*made)};
}

Result<std::unique_ptr<FrameSource>> OpenGLBackend::make_frames(
    std::unique_ptr<FrameChooser> chooser) {
  return {std::make_unique<OpenGLFrames>(*renderer_, std::move(chooser))};
}

Result<std::unique_ptr<KeyframePainter>> OpenGLBackend::make_keyframe_painter() {
  return OpenGLPainter::create(*renderer_, samples_);
}

Result<std::unique_ptr<BackendTarget>> OpenGLBackend::make_target(int width, int height) const {
  Result<OpenGLTarget> target = OpenGLTarget::create(width, height, samples_);
  if (!target) return target.error();
  return {std::make_unique<OpenGLTarget>(std::move(*target))};
}

void OpenGLBackend::finish() { gl::finish(); }

Result<SoftwareBackend*> OpenGLBackend::software() {
  if (samples_ != 1 && samples_ != 4)
    return Error{"--samples", "frames drawn without OpenGL have 1 or 4 samples a pixel"};
  if (!software_)
    software_ = std::make_unique<SoftwareBackend>(renderer_->scene(), samples_, deformations_);
  return software_.get();
}

Result<std::unique_ptr<FrameSource>> OpenGLBackend::present(
    std::unique_ptr<FrameSource> software_frames) {
  Result<std::unique_ptr<PresentedFrames>> made =
      PresentedFrames::create(std::move(software_frames));
  if (!made) return made.error();
  return {std::move(*made)};
}

}  // namespace rilievo
