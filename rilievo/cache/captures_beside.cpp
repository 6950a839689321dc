#include "rilievo/cache/captures_beside.h"

#include <utility>

#include "rilievo/core/stopwatch.h"
#include "rilievo/nailboard/raster_gaps.h"

namespace rilievo {
namespace {

constexpr std::size_t kMostUnused = 8;  // whose buffers are kept

}  // namespace

void CapturesBeside::order(const Capture& capture, std::span<const std::uint32_t> objects,
                           bool with_gaps) {
  std::unique_ptr<OrderedCapture> one;
  if (unused_.empty()) {
    one = std::make_unique<OrderedCapture>();
  } else {
    one = std::move(unused_.back());
    unused_.pop_back();
  }
  one->capture = capture;
  one->gaps = {};
  one->done.store(false, std::memory_order_relaxed);
  source_.place(capture.geometry.capture, objects, one->placed);
  background_.run([this, order = one.get(), with_gaps] {
    const Stopwatch watch;
    const Camera& eye = order->capture.geometry.capture;
    source_.draw(eye, order->placed, samples_, order->picture);
    if (with_gaps)
      order->gaps = raster_gaps(order->picture, source_.draw_farthest(eye, order->placed), eye);
    order->ms = watch.ms();
    order->done.store(true, std::memory_order_release);
  });
  ordered_.push_back(std::move(one));
}

OrderedCapture* CapturesBeside::take() {
  if (taken_ && unused_.size() < kMostUnused) unused_.push_back(std::move(taken_));
  taken_.reset();
  if (ordered_.empty() || !ordered_.front()->done.load(std::memory_order_acquire)) return nullptr;
  taken_ = std::move(ordered_.front());
  ordered_.pop_front();
  return taken_.get();
}

}  // namespace rilievo
