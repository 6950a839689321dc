#include "rilievo/cache/gl/impostor_frames.h"

#include <utility>

#include "rilievo/nailboard/gl/atlas_boards.h"

namespace rilievo {

Result<std::unique_ptr<ImpostorFrames>> ImpostorFrames::create(
    SceneRenderer& renderer, ImpostorContent content, const ImpostorFramesOptions& options) {
  Result<std::unique_ptr<AtlasBoards>> boards = AtlasBoards::create();
  if (!boards) return boards.error();
  std::unique_ptr<ImpostorFrames> frames(new ImpostorFrames(renderer));
  frames->chooser_ = std::make_unique<ImpostorChooser>(renderer.placed(), std::move(*boards),
                                                       std::move(content), options);
  frames->chooser_->add_sets(frames->content());
  frames->outlines_ = options.outlines;
  return {std::move(frames)};
}

Result<> ImpostorFrames::draw(const Camera& camera, double time) {
  Result<> done = SceneFrames::draw(camera, time);
  chooser_->drawn();
  return done;
}

Result<> ImpostorFrames::choose(const Camera& camera, FrameContent& content, FrameStats& stats) {
  return chooser_->choose(camera, renderer().placed(), content, stats);
}

bool ImpostorFrames::shows_blended(std::uint32_t object) const {
  return chooser_->shows_blended(object);
}

}  // namespace rilievo
