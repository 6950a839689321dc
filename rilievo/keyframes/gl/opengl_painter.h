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

#include "rilievo/keyframes/gl/keyframe_warper.h"
#include "rilievo/keyframes/keyframe_painter.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {

// The painter with OpenGL. Needs a current OpenGL context.
class OpenGLPainter final : public KeyframePainter {
 public:
  // `renderer` must outlive the painter. Fails where the driver does.
  [[nodiscard]] static Result<std::unique_ptr<KeyframePainter>> create(SceneRenderer& renderer);

  void begin(const Camera& camera, const PlacedScene& placed, double time) override;
  Result<> place(std::span<const std::uint32_t> polygons) override;
  Result<> warp(std::span<const WarpedKeyframe> keyframes, float nearest, bool leaves_sky,
                WarpedFrame& out) override;
  Result<> draw(const KeyframeContent& content) override;
  Result<> draw_objects(KeyframeTiles* warped) override;
  void finish() override;
  void take_memory(std::span<const std::uint32_t> polygons) override;
  // Of pixels that polygons cover.
  [[nodiscard]] double polygon_share(const WarpedFrame& warped) const override;

 private:
  OpenGLPainter(SceneRenderer& renderer, KeyframeWarper warper)
      : renderer_(renderer), warper_(std::move(warper)) {}
  Result<> make_cover();

  SceneRenderer& renderer_;
  KeyframeWarper warper_;
  Camera camera_;
  std::span<const std::uint32_t> live_;
  std::optional<ProbeTarget> cover_;  // polygons alone; made when first needed
  std::vector<FilledHole> filled_;
  std::optional<SoftwareTarget> objects_;  // identifiers of what was warped
};

}  // namespace rilievo
