// How are frames drawn with OpenGL that a chooser of its own chooses?
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "rilievo/frame/frame_chooser.h"
#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/frame/object_chooser.h"
#include "rilievo/frame/surrounding_chooser.h"

namespace rilievo {

// Draws what a FrameChooser chooses.
class ChosenFrames : public SceneFrames {
 public:
  // `renderer` must outlive the source. `chooser` knows its scene.
  ChosenFrames(SceneRenderer& renderer, std::unique_ptr<FrameChooser> chooser, bool outlines);

  Result<> draw(const Camera& camera, double time) override;
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override;

 private:
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
  [[nodiscard]] bool shows_blended(std::uint32_t object) const override;

  std::unique_ptr<FrameChooser> chooser_;
};

// Frames of baked objects (frame/object_chooser.h), or of baked surroundings
// (frame/surrounding_chooser.h), captured by OpenGL at the renderer's time.
[[nodiscard]] Result<std::unique_ptr<ChosenFrames>> make_object_frames(
    SceneRenderer& renderer, const Kind& kind, std::unique_ptr<DrawableFactory> factory,
    const ObjectFramesOptions& options);
[[nodiscard]] Result<std::unique_ptr<ChosenFrames>> make_surrounding_frames(
    SceneRenderer& renderer, const Kind& kind, std::unique_ptr<DrawableFactory> factory,
    const SurroundingFramesOptions& options);

}  // namespace rilievo
