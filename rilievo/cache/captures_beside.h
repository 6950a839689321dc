// How are pictures captured beside the frames?
//
// By the rasteriser, in the background. The frame's thread orders, and takes what is done: it never
// waits, and no lock is held across a capture. What objects, poses and levels were when a picture
// was ordered is what it shows.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/cache/policy.h"
#include "rilievo/capture/raster_source.h"
#include "rilievo/core/background.h"

namespace rilievo {

// A picture that was ordered, and what was made of it.
struct OrderedCapture {
  Capture capture;
  std::vector<std::uint32_t> objects;  // indices into Scene::objects

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
  // `source` must outlive the object, and be used by nobody else while captures are ordered that
  // are not done, but for RasterSource::place().
  CapturesBeside(RasterSource& source, int samples) : source_(source), samples_(samples) {}

  // Orders a picture of `objects` as they are now.
  void order(const Capture& capture, std::span<const std::uint32_t> objects, bool with_gaps);
  // The eldest order, if it is done; null: it is not, or there is none. Valid until the next call.
  [[nodiscard]] OrderedCapture* take();
  // Waits until all are done.
  void finish() { background_.wait(); }

 private:
  RasterSource& source_;
  int samples_;
  std::deque<std::unique_ptr<OrderedCapture>> ordered_;  // the eldest first
  std::vector<std::unique_ptr<OrderedCapture>> unused_;  // their buffers serve the next ones
  std::unique_ptr<OrderedCapture> taken_;
  Background background_;  // the first to go: it waits for what it does
};

}  // namespace rilievo
