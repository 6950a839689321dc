// Frames that are drawn without OpenGL, uploaded into an OpenGL frame: colours and depths.
//
// The whole frame is one picture: all samples of a pixel get its average and the depth of its
// first sample. The frame's time includes the upload. Leaves the OpenGL state as it was.
#pragma once

#include <memory>

#include "rilievo/frame/frame_source.h"
#include "rilievo/kind/drawable.h"

namespace rilievo {

// Draws another source's frames into the bound framebuffer.
class PresentedFrames final : public FrameSource {
 public:
  // `frames` draw without OpenGL. Needs a current OpenGL context; fails where the driver does.
  [[nodiscard]] static Result<std::unique_ptr<PresentedFrames>> create(
      std::unique_ptr<FrameSource> frames);
  ~PresentedFrames() override;

  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  [[nodiscard]] const FrameStats& stats() const override { return frames_->stats(); }
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override {
    return frames_->read_pictures();
  }

 private:
  struct Textures;
  explicit PresentedFrames(std::unique_ptr<FrameSource> frames);
  void upload(const Camera& camera, Output output);

  std::unique_ptr<FrameSource> frames_;
  std::unique_ptr<Textures> textures_;
  Camera camera_;
};

}  // namespace rilievo
