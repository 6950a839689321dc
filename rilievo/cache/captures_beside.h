// Captures of pictures beside the frames.
//
// The rasteriser captures them on a background thread. The frame's thread orders captures and takes
// those that are done; it never waits for one, and no lock is held during one. A picture shows its
// objects, their poses and their levels of detail as they were when it was ordered.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/cache/plan/policy.h"
#include "rilievo/capture/placed_raster.h"
#include "rilievo/core/background.h"

namespace rilievo {

// A picture that was ordered, and what was made of it.
struct OrderedCapture {
  Capture capture;
  RasterPicture picture;
  GapTable gaps;  // all zero where they were not asked for
  double ms = 0;  // wall-clock time

 private:
  friend class CapturesBeside;
  std::vector<PlacedMesh> placed;
  std::atomic<bool> done{false};
};

// Makes ordered captures one after the other, in their order.
class CapturesBeside {
 public:
  // `source` must outlive the object. Until all ordered captures are done, others may call nothing
  // but PlacedRaster::place() of it.
  CapturesBeside(PlacedRaster& source, int samples) : source_(source), samples_(samples) {}

  // Orders a picture of `objects` as they are now.
  void order(const Capture& capture, std::span<const std::uint32_t> objects, bool with_gaps);
  // Returns the oldest ordered capture if it is done, and null otherwise. Valid until the next
  // call.
  [[nodiscard]] OrderedCapture* take();
  // Waits until all are done.
  void finish() { background_.wait(); }

 private:
  PlacedRaster& source_;
  int samples_;
  std::deque<std::unique_ptr<OrderedCapture>> ordered_;  // the oldest first
  std::vector<std::unique_ptr<OrderedCapture>> unused_;  // their buffers serve the next ones
  std::unique_ptr<OrderedCapture> taken_;
  Background background_;  // destroyed first: it waits for its tasks, which use the others
};

}  // namespace rilievo
