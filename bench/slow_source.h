// How is a software shader made slower, without changing what it makes?
#pragma once

#include <mutex>
#include <optional>
#include <thread>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/stopwatch.h"

namespace rilievo::bench {

// A source that takes `factor` times as long, asleep or at work on a core. Coarse pictures come
// later by as much.
class SlowSource final : public CaptureSource {
 public:
  SlowSource(CaptureSource& source, double factor, bool busy)
      : source_(source), factor_(factor), busy_(busy) {}

  [[nodiscard]] std::string_view name() const override { return source_.name(); }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override {
    return source_.bounds(objects);
  }
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    Stopwatch watch;
    const std::stop_token stop = request.control ? request.control->stop : std::stop_token();
    CaptureControl control;
    control.stop = stop;
    if (request.control && request.control->refined)
      control.refined = [&](const CapturedPicture& coarse) {
        delay(watch.ms(), stop);
        keep(coarse.picture);
        request.control->refined(coarse);
        watch = Stopwatch();
      };
    CaptureRequest slow = request;
    slow.control = &control;
    Result<CapturedPicture> captured = source_.capture(slow);
    if (captured) {
      delay(watch.ms(), stop);
      keep(captured->picture);
    }
    if (stop.stop_requested()) return Error{std::string(name()), std::string(kCaptureStopped)};
    return captured;
  }
  // The last picture that it let out, coarse or not. Any thread.
  [[nodiscard]] std::optional<DepthImage> last() const {
    const std::lock_guard lock(mutex_);
    return last_;
  }

 private:
  void delay(double took_ms, const std::stop_token& stop) const {
    const Stopwatch watch;
    const double more_ms = (factor_ - 1) * took_ms;
    while (watch.ms() < more_ms && !stop.stop_requested())
      if (!busy_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  void keep(const DepthImage& picture) {
    const std::lock_guard lock(mutex_);
    last_ = picture;
  }

  CaptureSource& source_;
  double factor_;
  bool busy_;
  mutable std::mutex mutex_;
  std::optional<DepthImage> last_;
};

}  // namespace rilievo::bench
