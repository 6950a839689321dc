// A source that is made when its first picture is asked for.
//
// For programs that take long to start, and may not be there where their pictures are: a bake whose
// pictures are all kept does without. As safe for threads as no source that is being made.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "rilievo/capture/capture_source.h"

namespace rilievo {

// Another source, made late.
class LateSource final : public CaptureSource {
 public:
  using Make = std::function<Result<std::unique_ptr<CaptureSource>>()>;

  // `name`: the source's. `bounds`: of all that it shows; it knows no single objects.
  LateSource(std::string name, const Box& bounds, const WorldSpace& world, Make make)
      : name_(std::move(name)), bounds_(bounds), world_(world), make_(std::move(make)) {}

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t>) const override { return bounds_; }
  [[nodiscard]] WorldSpace world() const override { return world_; }
  // Fails where the source cannot be made, or does.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    if (Result<> made = make(); !made) return made.error();
    return source_->capture(request);
  }
  [[nodiscard]] Result<LayeredDepthImage> capture_layers(const LayersRequest& request) override {
    if (Result<> made = make(); !made) return made.error();
    return source_->capture_layers(request);
  }

 private:
  [[nodiscard]] Result<> make() {
    if (source_) return Done{};
    Result<std::unique_ptr<CaptureSource>> made = make_();
    if (!made) return made.error();
    source_ = *std::move(made);
    return Done{};
  }

  std::string name_;
  Box bounds_;
  WorldSpace world_;
  Make make_;
  std::unique_ptr<CaptureSource> source_;
};

}  // namespace rilievo
