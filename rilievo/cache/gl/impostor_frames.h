// How does OpenGL draw frames in which some objects are relief impostors?
//
// cache/impostor_chooser.h chooses them.
#pragma once

#include <memory>
#include <utility>

#include "rilievo/cache/impostor_chooser.h"
#include "rilievo/frame/gl/chosen_frames.h"

namespace rilievo {

// A frame source with relief impostors.
class ImpostorFrames final : public ChosenFrames {
 public:
  // `renderer` must outlive the source, and be at the time at which `content` was made. Fails if
  // the driver refuses the memory or the shaders.
  [[nodiscard]] static Result<std::unique_ptr<ImpostorFrames>> create(
      SceneRenderer& renderer, ImpostorContent content, const ImpostorFramesOptions& options);

  [[nodiscard]] ImpostorChooser& chooser() { return *chooser_; }
  // As ImpostorChooser's.
  [[nodiscard]] std::span<const ImpostorStatus> statuses() const { return chooser_->statuses(); }
  [[nodiscard]] ImpostorWorkers& workers() { return chooser_->workers(); }
  [[nodiscard]] const ImpostorContent& impostors() const { return chooser_->impostors(); }

 private:
  ImpostorFrames(SceneRenderer& renderer, std::unique_ptr<ImpostorChooser> chooser, bool outlines)
      : ChosenFrames(renderer, std::move(chooser), outlines) {}

  ImpostorChooser* chooser_ = nullptr;  // the base's
};

}  // namespace rilievo
