#include "rilievo/relief_impostor/frame_gate.h"

#include <chrono>
#include <thread>

namespace rilievo {
namespace {

// Work goes on so soon after a frame. Looking so often costs a core less than a hundredth.
constexpr auto kLook = std::chrono::microseconds(250);

}  // namespace

void BackgroundWork::wait(const std::stop_token& stop) {
  if (!gate_.drawing()) return;
  const double waited = waited_ms(), worked = since_.ms() - waited;
  const double most = kFirstWait + 2 * worked - waited;
  const Stopwatch watch;
  while (watch.ms() < most && gate_.drawing() && !stop.stop_requested())
    std::this_thread::sleep_for(kLook);
  waited_ms_.fetch_add(watch.ms(), std::memory_order_relaxed);
}

}  // namespace rilievo
