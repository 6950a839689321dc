// Any callable as a source of pictures: what S5 calls a software shader.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "rilievo/capture/capture_source.h"

namespace rilievo {

class CallableSource final : public CaptureSource {
 public:
  using Shade = std::function<Result<CapturedPicture>(const CaptureRequest&)>;

  // `shade` makes pictures of what lies within `bounds`, with depth as CapturedPicture says.
  CallableSource(std::string name, const Box& bounds, Shade shade)
      : name_(std::move(name)), bounds_(bounds), shade_(std::move(shade)) {}

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t>) const override { return bounds_; }
  // An error if what the callable made does not fit the camera.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    Result<CapturedPicture> captured = shade_(request);
    if (!captured) return captured;
    const DepthImage& picture = captured->picture;
    if (picture.depth.width() != request.camera.width ||
        picture.depth.height() != request.camera.height)
      return Error{name_, "made a picture of another size than was asked for"};
    if (Result<> ok = validate(picture); !ok) return Error{name_, ok.error().reason};
    return captured;
  }

 private:
  std::string name_;
  Box bounds_;
  Shade shade_;
};

}  // namespace rilievo
