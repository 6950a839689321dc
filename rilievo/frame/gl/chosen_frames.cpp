#include "rilievo/frame/gl/chosen_frames.h"

#include "rilievo/capture/gl/opengl_source.h"

namespace rilievo {

ChosenFrames::ChosenFrames(SceneRenderer& renderer, std::unique_ptr<FrameChooser> chooser,
                           bool outlines)
    : SceneFrames(renderer), chooser_(std::move(chooser)) {
  chooser_->add_sets(content());
  outlines_ = outlines;
}

Result<> ChosenFrames::draw(const Camera& camera, double time) {
  Result<> done = SceneFrames::draw(camera, time);
  chooser_->drawn();
  return done;
}

Result<> ChosenFrames::choose(const Camera& camera, FrameContent& content, FrameStats& stats) {
  return chooser_->choose(camera, renderer().placed(), content, stats);
}

std::vector<DepthImage> ChosenFrames::read_pictures() const {
  return chooser_->read_pictures(content());
}

bool ChosenFrames::shows_blended(std::uint32_t object) const {
  return chooser_->shows_blended(object);
}

Result<std::unique_ptr<ChosenFrames>> make_object_frames(SceneRenderer& renderer, const Kind& kind,
                                                         std::unique_ptr<DrawableFactory> factory,
                                                         const ObjectFramesOptions& options) {
  OpenGLSource source(renderer);
  Result<std::unique_ptr<ObjectChooser>> chooser =
      ObjectChooser::create(renderer.placed(), source, kind, std::move(factory), options);
  if (!chooser) return chooser.error();
  return std::make_unique<ChosenFrames>(renderer, std::move(*chooser), options.outlines);
}

Result<std::unique_ptr<ChosenFrames>> make_surrounding_frames(
    SceneRenderer& renderer, const Kind& kind, std::unique_ptr<DrawableFactory> factory,
    const SurroundingFramesOptions& options) {
  OpenGLSource source(renderer);
  Result<std::unique_ptr<SurroundingChooser>> chooser =
      SurroundingChooser::create(renderer.placed(), source, kind, std::move(factory), options);
  if (!chooser) return chooser.error();
  return std::make_unique<ChosenFrames>(renderer, std::move(*chooser), false);
}

}  // namespace rilievo
