#include "rilievo/frame/gl/opengl_frames.h"

#include <utility>

#include "rilievo/gl/state_guard.h"
#include "rilievo/render/draw_list.h"

namespace rilievo {

OpenGLFrames::OpenGLFrames(SceneRenderer& renderer, std::unique_ptr<FrameChooser> chooser)
    : chooser_(std::move(chooser)), renderer_(renderer) {
  for (std::uint32_t i = 0; i < renderer.scene().objects.size(); ++i)
    if (renderer.has_blended_parts(i)) blended_.push_back(i);
  chooser_->add_sets(content_);
}

// Pictures before polygons: their shading is the cheaper one, and it hides the polygons behind.
void OpenGLFrames::draw_opaque(Output output) {
  for (FrameContent::Set& set : content_.sets)
    if (!set.instances.empty()) set.drawable->draw(camera_, set.instances, output);
  if (output == Output::color) {
    renderer_.draw_opaque(camera_, content_.polygons, OutputEncoding::srgb);
    renderer_.draw_cross_fades(camera_, content_.fading, OutputEncoding::srgb);
    return;
  }
  renderer_.draw_objects(camera_, content_.polygons);
  renderer_.draw_fading_objects(camera_, content_.fading);
}

Result<> OpenGLFrames::draw_chosen() {
  const gl::StateGuard guard;
  renderer_.set_time(time_);
  content_.clear();
  stats_.captures = 0, stats_.capture_ms = 0, stats_.gap_px = 0;
  stats_.bound_px.reset();
  if (Result<> chosen = chooser_->choose(camera_, renderer_.placed(), content_, stats_); !chosen)
    return chosen;
  count_drawn(content_, stats_);

  guard.bind_frame();
  draw_opaque(Output::color);
  if (content_.sky)
    renderer_.draw_sky(content_.sky_over(renderer_.scene()), camera_, OutputEncoding::srgb);
  scratch_.clear();
  const Frustum frustum = frustum_of(camera_);
  for (const std::uint32_t object : blended_)
    if (!chooser_->shows_blended(object) && may_touch(frustum, renderer_.object_bounds(object)))
      scratch_.push_back(object);
  renderer_.draw_blended(camera_, scratch_, OutputEncoding::srgb);
  if (content_.outlines)
    for (FrameContent::Set& set : content_.sets)
      if (!set.instances.empty()) set.drawable->draw_outlines(camera_, set.instances);
  return Done{};
}

Result<> OpenGLFrames::draw(const Camera& camera, double time) {
  camera_ = camera;
  time_ = time;
  Result<> done = draw_chosen();
  chooser_->drawn(nullptr, stats_);
  return done;
}

Result<> OpenGLFrames::draw_objects() {
  const gl::StateGuard guard;
  renderer_.set_time(time_);
  chooser_->prepare_objects();
  guard.bind_frame();
  draw_opaque(Output::object_id);
  return Done{};
}

}  // namespace rilievo
