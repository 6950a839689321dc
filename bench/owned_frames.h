// Frames that keep the backend that draws them.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "rilievo/frame/backend.h"

namespace rilievo::bench {

// A source and its backend as one.
class OwnedFrames final : public FrameSource {
 public:
  OwnedFrames(std::unique_ptr<Backend> backend, std::unique_ptr<FrameSource> frames)
      : backend_(std::move(backend)), frames_(std::move(frames)) {}

  Result<> draw(const Camera& camera, double time) override { return frames_->draw(camera, time); }
  Result<> draw_objects() override { return frames_->draw_objects(); }
  [[nodiscard]] const SoftwareTarget* software_target() const override {
    return frames_->software_target();
  }
  [[nodiscard]] const FrameStats& stats() const override { return frames_->stats(); }
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override {
    return frames_->read_pictures();
  }

 private:
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<FrameSource> frames_;
};

}  // namespace rilievo::bench
