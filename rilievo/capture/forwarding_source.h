// A source that another one stands behind: what wraps a source overrides what it changes.
#pragma once

#include "rilievo/capture/capture_source.h"

namespace rilievo {

// Asks the other source for everything. As safe for threads as that one.
class ForwardingSource : public CaptureSource {
 public:
  // `source` must outlive it.
  explicit ForwardingSource(CaptureSource& source) : source_(source) {}

  [[nodiscard]] std::string_view name() const override { return source_.name(); }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override {
    return source_.bounds(objects);
  }
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    return source_.capture(request);
  }
  [[nodiscard]] Result<LayeredDepthImage> capture_layers(const LayersRequest& request) override {
    return source_.capture_layers(request);
  }
  [[nodiscard]] std::span<const LayeredDepthImage> deep_images() const override {
    return source_.deep_images();
  }
  [[nodiscard]] const Scene* scene() const override { return source_.scene(); }
  [[nodiscard]] WorldSpace world() const override { return source_.world(); }
  [[nodiscard]] StrokeSize stroke_size(std::span<const std::uint32_t> objects) const override {
    return source_.stroke_size(objects);
  }
  [[nodiscard]] std::span<const DepthImage> photographs() const override {
    return source_.photographs();
  }

 protected:
  CaptureSource& source_;
};

}  // namespace rilievo
