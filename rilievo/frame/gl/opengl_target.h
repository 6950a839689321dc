// OpenGL's target for frames that are read back.
#pragma once

#include <optional>
#include <utility>

#include "rilievo/frame/backend_target.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {

// A framebuffer for frames, and one for their identifiers. Needs a current OpenGL context.
class OpenGLTarget final : public BackendTarget {
 public:
  // As FrameTarget::create().
  [[nodiscard]] static Result<OpenGLTarget> create(int width, int height, int samples);

  Result<> draw(FrameSource& source, const Camera& camera, double time) override;
  [[nodiscard]] Rgba8Image color() const override { return frame_.read(); }
  [[nodiscard]] Image<float> eye_z() const override { return frame_.read_eye_z(camera_); }
  [[nodiscard]] Result<SeenObjects> draw_objects(FrameSource& source) override;

  // The framebuffer, to be shown or drawn over.
  [[nodiscard]] FrameTarget& frame() { return frame_; }

 private:
  FrameTarget frame_;
  std::optional<ProbeTarget> probe_;  // made when first needed
  Camera camera_;                     // of the last frame
};

}  // namespace rilievo
