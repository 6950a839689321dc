// How is a software shader made slower, without changing what it makes?
#pragma once

#include <mutex>
#include <optional>
#include <thread>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/stopwatch.h"

namespace rilievo::bench {

// A source that takes `factor` times as long, asleep or at work on a core; what it waits for frames
// is not multiplied. Coarse pictures come later by as much.
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
    double waited_ms = 0;  // by this thread alone: workers have one
    const std::stop_token stop = request.control ? request.control->stop : std::stop_token();
    CaptureControl control;
    control.stop = stop;
    if (request.control && request.control->give_way)
      control.give_way = [&] {
        const Stopwatch waiting;
        request.control->give_way();
        waited_ms += waiting.ms();
      };
    const auto delay_more = [&] { delay(watch.ms() - waited_ms, control, waited_ms); };
    if (request.control && request.control->refined)
      control.refined = [&](const CapturedPicture& coarse) {
        delay_more();
        keep(coarse.picture);
        request.control->refined(coarse);
        waited_ms = 0, watch = Stopwatch();
      };
    CaptureRequest slow = request;
    slow.control = &control;
    Result<CapturedPicture> captured = source_.capture(slow);
    if (captured) {
      delay_more();
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
  // `waited_ms` grows by what control.give_way() waits.
  void delay(double took_ms, const CaptureControl& control, const double& waited_ms) const {
    const Stopwatch watch;
    const double before_ms = waited_ms, more_ms = (factor_ - 1) * took_ms;
    while (watch.ms() - (waited_ms - before_ms) < more_ms && !control.stop.stop_requested())
      if (!busy_)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      else if (control.give_way)
        control.give_way();
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
