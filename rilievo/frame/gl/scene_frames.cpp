#include "rilievo/frame/gl/scene_frames.h"

#include "rilievo/gl/state_guard.h"
#include "rilievo/render/draw_list.h"

namespace rilievo {

SceneFrames::SceneFrames(SceneRenderer& renderer) : renderer_(&renderer) {
  for (std::uint32_t i = 0; i < renderer.scene().objects.size(); ++i)
    if (renderer.has_blended_parts(i)) blended_.push_back(i);
}

// Pictures before polygons: their shading is the cheaper one, and it hides the polygons behind.
void SceneFrames::draw_opaque(Output output) {
  for (FrameContent::Set& set : content_.sets)
    if (!set.instances.empty()) set.drawable->draw(camera_, set.instances, output);
  if (output == Output::color) {
    renderer_->draw_opaque(camera_, content_.polygons, OutputEncoding::srgb);
    renderer_->draw_cross_fades(camera_, content_.fading, OutputEncoding::srgb);
    return;
  }
  renderer_->draw_objects(camera_, content_.polygons);
  renderer_->draw_fading_objects(camera_, content_.fading);
}

Result<> SceneFrames::draw(const Camera& camera, double time) {
  const gl::StateGuard guard;
  camera_ = camera;
  time_ = time;
  renderer_->set_time(time);
  content_.clear();
  stats_.captures = 0, stats_.capture_ms = 0, stats_.bound_px = stats_.gap_px = 0;
  if (Result<> chosen = choose(camera, content_, stats_); !chosen) return chosen;
  count_drawn(content_, stats_);

  guard.bind_frame();
  draw_opaque(Output::color);
  if (sky_) renderer_->draw_sky(camera, OutputEncoding::srgb);
  scratch_.clear();
  const Frustum frustum = frustum_of(camera);
  for (const std::uint32_t object : blended_)
    if (!shows_blended(object) && may_touch(frustum, renderer_->object_bounds(object)))
      scratch_.push_back(object);
  renderer_->draw_blended(camera, scratch_, OutputEncoding::srgb);
  if (outlines_)
    for (FrameContent::Set& set : content_.sets)
      if (!set.instances.empty()) set.drawable->draw_outlines(camera, set.instances);
  return Done{};
}

Result<> SceneFrames::draw_objects() {
  const gl::StateGuard guard;
  renderer_->set_time(time_);
  prepare_objects();
  guard.bind_frame();
  draw_opaque(Output::object_id);
  return Done{};
}

Result<> DirectFrames::choose(const Camera& camera, FrameContent& content, FrameStats&) {
  renderer().cull(camera, content.polygons);
  return Done{};
}

}  // namespace rilievo
