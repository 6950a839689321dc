// In which order is a frame drawn? Opaque parts, sky, blended parts, outlines; and identifiers.
//
// The order is the same for all sources: a derived class only chooses what each object is drawn
// from. Draws into the bound framebuffer. Needs a current OpenGL context. Leaves the OpenGL state
// as it was, so that it can draw within another program's frame, into its z-buffer.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

// A frame source that draws polygons and drawables with OpenGL.
class SceneFrames : public FrameSource {
 public:
  // Draws the polygons and the sky of `renderer`'s scene, which can be empty. `renderer` must
  // outlive the source.
  explicit SceneFrames(SceneRenderer& renderer);

  // See FrameSource. Fail where OpenGL or a capture does.
  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() final;
  [[nodiscard]] const FrameStats& stats() const final { return stats_; }

 protected:
  // Fills `content`, and in `stats` the captures, memory and bound. The renderer is already at the
  // frame's time. May change the bound framebuffer, viewport and scissor test.
  virtual Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) = 0;
  // Called before identifiers are drawn: captures those that are missing.
  virtual void prepare_objects() {}
  // Does what stands for the object in this frame hold its blended parts, too? Otherwise they are
  // drawn as polygons.
  [[nodiscard]] virtual bool shows_blended(std::uint32_t /*object*/) const { return false; }

  [[nodiscard]] SceneRenderer& renderer() const { return *renderer_; }
  [[nodiscard]] const FrameContent& content() const { return content_; }
  [[nodiscard]] FrameContent& content() { return content_; }
  // The time of the frame, seconds.
  [[nodiscard]] double time() const { return time_; }

  bool outlines_ = false;  // draw outlines around pictures (S1.8)
  bool sky_ = true;        // draw the scene's sky behind everything

 private:
  void draw_opaque(Output output);

  SceneRenderer* renderer_;
  FrameContent content_;
  FrameStats stats_;
  std::vector<std::uint32_t> blended_;  // objects with blended parts
  std::vector<std::uint32_t> scratch_;
  Camera camera_;
  double time_ = 0;
};

// Draws every object as polygons: the true frame, and the baseline.
class DirectFrames final : public SceneFrames {
 public:
  using SceneFrames::SceneFrames;

 private:
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
};

}  // namespace rilievo
