// The target of frames that are drawn without OpenGL, which are in memory anyway.
#pragma once

#include "rilievo/frame/backend_target.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {

// Frames of any size.
class SoftwareBackendTarget final : public BackendTarget {
 public:
  Result<> draw(FrameSource& source, const Camera& camera, double time) override;
  [[nodiscard]] Rgba8Image color() const override { return frame_->color(); }
  [[nodiscard]] Image<float> eye_z() const override { return frame_->eye_z(); }
  [[nodiscard]] Result<SeenObjects> draw_objects(FrameSource& source) override;

 private:
  const SoftwareTarget* frame_ = nullptr;  // the last source's
};

}  // namespace rilievo
