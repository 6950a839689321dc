// How does a frame that processors drew get into an OpenGL frame?
//
// Colours and depths are drawn as one picture that covers the frame. A pixel of which a share of
// the samples is covered writes as many samples; the sky and blended parts follow as in all
// frames (scene_frames.h). What presenting costs is in the frame's time.
#pragma once

#include <memory>

#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/render/shading/frame_renderer.h"

namespace rilievo {

// A frame source that draws opaque parts without OpenGL.
class ProcessorFrames final : public SceneFrames {
 public:
  // The sky and blended parts are those of `renderer`'s scene, which `processor` draws. `renderer`
  // must outlive the source. `samples` of a pixel: 1 or 4, and those of the OpenGL frame.
  [[nodiscard]] static Result<std::unique_ptr<ProcessorFrames>> create(
      SceneRenderer& renderer, std::unique_ptr<FrameRenderer> processor, int samples);
  ~ProcessorFrames() override;

 private:
  class Picture;
  ProcessorFrames(SceneRenderer& renderer, std::unique_ptr<FrameRenderer> processor);
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;

  std::unique_ptr<FrameRenderer> processor_;
  std::unique_ptr<Picture> picture_;
};

}  // namespace rilievo
