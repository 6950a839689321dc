// Warps keyframes and draws frames with OpenGL, into the bound framebuffer.
//
// The frame is warped by the GPU and read back, so that what it does not show is found as without
// OpenGL (keyframes/software/), and filled by rays on processors; what they find goes back as
// pixels. Polygons, the sky and what blends are drawn by OpenGL into the same z-buffer. Leaves the
// OpenGL state as it was.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "rilievo/keyframes/gl/cover_target.h"
#include "rilievo/keyframes/gl/keyframe_warper.h"
#include "rilievo/keyframes/keyframe_painter.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {

// The painter with OpenGL. Needs a current OpenGL context.
class OpenGLPainter final : public KeyframePainter {
 public:
  // `renderer` must outlive the painter. `samples`: of a pixel of the bound framebuffer. Fails
  // where the driver does.
  [[nodiscard]] static Result<std::unique_ptr<KeyframePainter>> create(SceneRenderer& renderer,
                                                                       int samples);

  void begin(const Camera& camera, const PlacedScene& placed, double time) override;
  Result<> place(std::span<const std::uint32_t> polygons) override;
  Result<> warp(std::span<const WarpedKeyframe> keyframes, float nearest, bool leaves_sky,
                WarpedFrame& out) override;
  Result<> draw(const KeyframeContent& content) override;
  Result<> draw_objects(KeyframeTiles* warped) override;
  void finish() override;
  // Of polygons OpenGL knows nothing by what the source of keyframes takes.
  [[nodiscard]] bool draws_as_source() const override { return false; }
  void take_memory(std::span<const std::uint32_t> polygons) override;
  // Of pixels that polygons cover as a whole, without those objects that were found missing.
  [[nodiscard]] double polygon_share(const WarpedFrame& warped) const override;

 private:
  OpenGLPainter(SceneRenderer& renderer, int samples, KeyframeWarper warper)
      : renderer_(renderer), samples_(samples), warper_(std::move(warper)) {}
  Result<> make_cover();

  SceneRenderer& renderer_;
  int samples_;
  KeyframeWarper warper_;
  Camera camera_;
  double time_ = 0;
  std::span<const std::uint32_t> live_;
  std::optional<CoverTarget> cover_;  // polygons alone; made when first needed
  std::vector<FilledHole> filled_;
  std::optional<SoftwareTarget> objects_;  // identifiers of what was warped
};

}  // namespace rilievo
