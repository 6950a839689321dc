// A source that is watched while it works: how many pictures it has captured.
//
// Sets the samples, too, for who asks through kinds that do not. As safe for threads as the source
// that captures.
#pragma once

#include <functional>
#include <utility>

#include "rilievo/capture/forwarding_source.h"

namespace rilievo {

// Another source, watched.
class WatchedSource final : public ForwardingSource {
 public:
  // Called before the first picture and after each, with the number of those that are done. An
  // error becomes that of the capture.
  using Watch = std::function<Result<>(int done)>;

  // `source` must outlive it. `samples`: of each texel; 0: as many as are asked for.
  WatchedSource(CaptureSource& source, int samples, Watch watch)
      : ForwardingSource(source), samples_(samples), watch_(std::move(watch)) {}

  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    CaptureRequest asked = request;
    if (samples_ > 0) asked.samples = samples_;
    return watched([&] { return source_.capture(asked); });
  }
  [[nodiscard]] Result<LayeredDepthImage> capture_layers(const LayersRequest& request) override {
    LayersRequest asked = request;
    if (samples_ > 0) asked.samples = samples_;
    return watched([&] { return source_.capture_layers(asked); });
  }

 private:
  template <class Capture>
  auto watched(const Capture& capture) -> decltype(capture()) {
    if (watch_ && done_ == 0)
      if (Result<> go = watch_(0); !go) return go.error();
    auto captured = capture();
    ++done_;
    if (watch_ && captured)
      if (Result<> go = watch_(done_); !go) return go.error();
    return captured;
  }

  int samples_;
  Watch watch_;
  int done_ = 0;
};

}  // namespace rilievo
