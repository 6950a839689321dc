// How does OpenGL draw flat impostors and nailboards that are used in the plain way (S1.5)?
//
// cache/picture_chooser.h says which pictures are captured when.
#pragma once

#include <memory>
#include <utility>

#include "rilievo/cache/picture_chooser.h"
#include "rilievo/frame/gl/chosen_frames.h"

namespace rilievo {

// A frame source with one picture for each heavy object.
class PictureFrames final : public ChosenFrames {
 public:
  // `renderer` must outlive the source. Fails where the atlas cannot be allocated.
  [[nodiscard]] static Result<PictureFrames> create(SceneRenderer& renderer,
                                                    const PictureFramesOptions& options);

 private:
  PictureFrames(SceneRenderer& renderer, std::unique_ptr<PictureChooser> chooser, bool outlines)
      : ChosenFrames(renderer, std::move(chooser), outlines) {}
};

}  // namespace rilievo
