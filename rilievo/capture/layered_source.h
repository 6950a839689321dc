// How do layered pictures, mostly from deep image files, serve as a source (S4.1)?
//
// They are used as they are; nothing is captured.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rilievo/capture/capture_source.h"

namespace rilievo {

// Layered pictures as a capture source.
class LayeredSource final : public CaptureSource {
 public:
  // Requires valid pictures.
  LayeredSource(std::string name, std::vector<LayeredDepthImage> pictures)
      : name_(std::move(name)), pictures_(std::move(pictures)) {}

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // Always fails: layered pictures are not captured again.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  [[nodiscard]] std::span<const LayeredDepthImage> layered_pictures() const override {
    return pictures_;
  }

 private:
  std::string name_;
  std::vector<LayeredDepthImage> pictures_;
};

}  // namespace rilievo
