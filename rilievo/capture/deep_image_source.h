// Deep images, mostly of other renderers, as a source (S4.1).
//
// They are used as they are; nothing is captured.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rilievo/capture/capture_source.h"

namespace rilievo {

// Deep images as a capture source.
class DeepImageSource final : public CaptureSource {
 public:
  // Requires valid pictures.
  // `world` is where the pictures' space lies.
  DeepImageSource(std::string name, std::vector<LayeredDepthImage> pictures,
                  const WorldSpace& world = {})
      : name_(std::move(name)), pictures_(std::move(pictures)), world_(world) {}

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // Always fails: deep images are not captured again.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  [[nodiscard]] std::span<const LayeredDepthImage> deep_images() const override {
    return pictures_;
  }
  [[nodiscard]] WorldSpace world() const override { return world_; }

 private:
  std::string name_;
  std::vector<LayeredDepthImage> pictures_;
  WorldSpace world_;
};

}  // namespace rilievo
