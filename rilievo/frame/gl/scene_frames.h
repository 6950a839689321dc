// One frame of a scene: opaque things, the sky, what blends, outlines, object identifiers.
//
// The same for all: who derives from it only chooses what each object is drawn from. Draws into the
// bound framebuffer. Needs a current OpenGL context; leaves the OpenGL state as it was found, so
// that it can be used inside somebody else's frame, in his z-buffer.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

class SceneFrames : public FrameSource {
 public:
  // Draws polygons and the sky of `renderer`'s scene, which may be empty; it must outlive this.
  explicit SceneFrames(SceneRenderer& renderer);

  Result<> draw(const Camera& camera, double time) final;
  Result<> draw_objects() final;
  [[nodiscard]] const FrameStats& stats() const final { return stats_; }
  void append_errors(int step, std::vector<float>& errors_px) const final;

 protected:
  // Fills `content` and what `stats` says of captures, memory and the bound. The renderer's time is
  // set. May change the bound framebuffer, viewport and scissor test.
  virtual Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) = 0;
  // Before identifiers are drawn: captures those that are missing.
  virtual void prepare_objects() {}

  [[nodiscard]] SceneRenderer& renderer() const { return *renderer_; }
  [[nodiscard]] const FrameContent& content() const { return content_; }
  [[nodiscard]] FrameContent& content() { return content_; }

  bool outlines_ = false;  // draw outlines around what is drawn from pictures (S1.8)
  bool sky_ = true;        // draw the scene's sky where nothing else is

 private:
  void draw_opaque(Output output);
  void count();

  SceneRenderer* renderer_;
  FrameContent content_;
  FrameStats stats_;
  std::vector<std::uint32_t> blended_;  // objects with blended parts
  std::vector<std::uint32_t> scratch_;
  Camera camera_;
  double time_ = 0;
};

// Direct drawing of every object as polygons: the true frame, and the baseline.
class DirectFrames final : public SceneFrames {
 public:
  using SceneFrames::SceneFrames;

 private:
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
};

}  // namespace rilievo
