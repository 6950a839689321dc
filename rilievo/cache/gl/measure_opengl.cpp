#include "rilievo/cache/gl/measure_opengl.h"

#include <memory>

#include "rilievo/cache/measure_costs.h"
#include "rilievo/frame/gl/opengl_frames.h"
#include "rilievo/gl/context.h"
#include "rilievo/nailboard/gl/atlas_pictures.h"
#include "rilievo/nailboard/gl/atlas_store.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {
namespace {

class GlMeasured final : public MeasuredFrames {
 public:
  GlMeasured(const Camera& frame, SceneRenderer& renderer, PictureSet pictures, FrameTarget target)
      : frame_(frame), target_(std::move(target)) {
    auto chooser = std::make_unique<MeasuredChooser>(std::move(pictures));
    chooser_ = chooser.get();
    frames_ = std::make_unique<OpenGLFrames>(renderer, std::move(chooser));
  }
  Result<> draw(const MeasuredRun& objects, const MeasuredRun& pictures) override {
    chooser_->show(objects, pictures);
    target_.begin();
    if (Result<> drawn = frames_->draw(frame_, 0); !drawn) return drawn;
    target_.resolve();
    gl::finish();
    return Done{};
  }

 private:
  Camera frame_;
  MeasuredChooser* chooser_ = nullptr;
  std::unique_ptr<OpenGLFrames> frames_;
  FrameTarget target_;
};

// Draws the scene with these of its pictures.
Result<std::unique_ptr<GlMeasured>> make_frames(const MeasuredScene& scene, SceneRenderer& renderer,
                                                std::span<const DepthImage> shown) {
  Result<FrameTarget> target = FrameTarget::create(scene.frame.width, scene.frame.height, 4);
  if (!target) return target.error();
  Result<PictureSet> pictures = make_atlas_pictures(shown);
  if (!pictures) return pictures.error();
  return std::make_unique<GlMeasured>(scene.frame, renderer, std::move(*pictures),
                                      std::move(*target));
}

}  // namespace

Result<PolygonTimes> measure_polygons_by_opengl() {
  const MeasuredScene scene = measured_scene();
  Result<SceneRenderer> renderer = SceneRenderer::create(scene.scene);
  if (!renderer) return renderer.error();
  const auto frames = make_frames(scene, *renderer, std::span(scene.pictures).first(1));
  if (!frames) return frames.error();
  return measure_polygons(scene, **frames);
}

Result<> measure_opengl(MachineCosts& costs) {
  const MeasuredScene scene = measured_scene();
  Result<SceneRenderer> renderer = SceneRenderer::create(scene.scene);
  if (!renderer) return renderer.error();
  const auto frames = make_frames(scene, *renderer, scene.pictures);
  if (!frames) return frames.error();
  const Result<DrawTimes> drawing = measure_drawing(scene, **frames);
  if (!drawing) return drawing.error();

  NailboardStoreOptions options;
  options.capture_by = CaptureBy::opengl;
  Result<std::unique_ptr<NailboardStore>> store = make_atlas_store(*renderer, options);
  if (!store) return store.error();
  costs.draw_opengl = *drawing;
  costs.capture_opengl = measure_captures(scene, **store);
  costs.gl_renderer = gl::renderer_name();
  return Done{};
}

}  // namespace rilievo
