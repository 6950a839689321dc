// The order of a frame that OpenGL draws: opaque parts, sky, blended parts, outlines; identifiers.
//
// Draws into the bound framebuffer. Needs a current OpenGL context. Leaves the OpenGL state as it
// was, so that it can draw within another program's frame, into its z-buffer.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rilievo/frame/frame_chooser.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

// Draws what a chooser chooses, with OpenGL.
class OpenGLFrames final : public FrameSource {
 public:
  // Draws the polygons and the sky of `renderer`'s scene, which can be empty. `renderer` must
  // outlive the source, unless `chooser`, of its scene, keeps it.
  OpenGLFrames(SceneRenderer& renderer, std::unique_ptr<FrameChooser> chooser);

  // See FrameSource. Fail where OpenGL or the choice does.
  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  [[nodiscard]] const FrameStats& stats() const override { return stats_; }
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override {
    return chooser_->read_pictures(content_);
  }

 private:
  Result<> draw_chosen();
  void draw_opaque(Output output);

  std::unique_ptr<FrameChooser> chooser_;
  SceneRenderer& renderer_;
  FrameContent content_;
  FrameStats stats_;
  std::vector<std::uint32_t> blended_;  // objects with blended parts
  std::vector<std::uint32_t> scratch_;
  Camera camera_;
  double time_ = 0;
};

}  // namespace rilievo
