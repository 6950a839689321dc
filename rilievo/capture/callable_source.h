// A function as a source of pictures. S5 calls such functions software shaders.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "rilievo/capture/capture_source.h"

namespace rilievo {

// A capture source that calls `shade`.
class CallableSource final : public CaptureSource {
 public:
  // Makes the picture of a request.
  using Shade = std::function<Result<CapturedPicture>(const CaptureRequest&)>;

  // `shade` captures what lies within `bounds` (world space), with depth as CapturedPicture defines
  // it.
  CallableSource(std::string name, const Box& bounds, Shade shade)
      : name_(std::move(name)), bounds_(bounds), shade_(std::move(shade)) {}

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t>) const override { return bounds_; }
  // Fails if the callable fails, or if its picture does not fit the camera.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    Result<CapturedPicture> captured = shade_(request);
    if (!captured) return captured;
    const DepthImage& picture = captured->picture;
    if (picture.depth.width() != request.camera.width ||
        picture.depth.height() != request.camera.height)
      return Error{name_, "returned a picture of the wrong size"};
    if (Result<> ok = validate(picture); !ok) return Error{name_, ok.error().reason};
    return captured;
  }

 private:
  std::string name_;
  Box bounds_;
  Shade shade_;
};

}  // namespace rilievo
