#include "rilievo/cache/gl/impostor_frames.h"

#include <utility>

#include "rilievo/nailboard/gl/atlas_boards.h"

namespace rilievo {

Result<std::unique_ptr<ImpostorFrames>> ImpostorFrames::create(
    SceneRenderer& renderer, ImpostorContent content, const ImpostorFramesOptions& options) {
  Result<std::unique_ptr<AtlasBoards>> boards = AtlasBoards::create();
  if (!boards) return boards.error();
  auto chooser = std::make_unique<ImpostorChooser>(renderer.placed(), std::move(*boards),
                                                   std::move(content), options);
  ImpostorChooser* const chosen_by = chooser.get();
  std::unique_ptr<ImpostorFrames> frames(
      new ImpostorFrames(renderer, std::move(chooser), options.outlines));
  frames->chooser_ = chosen_by;
  return {std::move(frames)};
}

}  // namespace rilievo
