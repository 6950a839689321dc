#include "rilievo/cache/gl/measure_opengl.h"

#include <memory>

#include "rilievo/cache/explicit_frames.h"
#include "rilievo/cache/gl/image_cache.h"
#include "rilievo/frame/gl/stored_frames.h"
#include "rilievo/gl/context.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {
namespace {

class GlMeasured final : public MeasuredFrames {
 public:
  GlMeasured(const Camera& frame, SceneRenderer& renderer, StoredPictures pictures,
             FrameTarget target)
      : frame_(frame), frames_(std::move(pictures), renderer), target_(std::move(target)) {}
  Result<> draw(const MeasuredRun& objects, const MeasuredRun& pictures) override {
    frames_.show(objects, pictures);
    target_.begin();
    if (Result<> drawn = frames_.draw(frame_, 0); !drawn) return drawn;
    target_.resolve();
    gl::finish();
    return Done{};
  }

 private:
  Camera frame_;
  ExplicitFrames<SceneFrames, StoredPictures> frames_;
  FrameTarget target_;
};

}  // namespace

Result<> measure_opengl(MachineCosts& costs) {
  const MeasuredScene scene = measured_scene();
  Result<SceneRenderer> renderer = SceneRenderer::create(scene.scene);
  if (!renderer) return renderer.error();
  Result<FrameTarget> target = FrameTarget::create(scene.frame.width, scene.frame.height, 4);
  if (!target) return target.error();
  Result<StoredPictures> pictures = make_stored_pictures(scene.pictures);
  if (!pictures) return pictures.error();
  GlMeasured frames(scene.frame, *renderer, std::move(*pictures), std::move(*target));
  const Result<DrawTimes> drawing = measure_drawing(scene, frames);
  if (!drawing) return drawing.error();

  ImageCacheOptions options;
  options.capture_by = CaptureBy::opengl;
  Result<std::unique_ptr<CachePictures>> store = ImageCache::make_pictures(*renderer, options);
  if (!store) return store.error();
  costs.draw_opengl = *drawing;
  costs.capture_opengl = measure_captures(scene, **store);
  costs.gl_renderer = gl::renderer_name();
  return Done{};
}

}  // namespace rilievo
