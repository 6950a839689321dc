// What do the frame's thread and the workers know of one impostor?
//
// Internal to impostor_workers.cpp. Each member says who writes it; values go from thread to thread
// by triple buffers and atomics alone.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "rilievo/core/stopwatch.h"
#include "rilievo/core/triple_buffer.h"
#include "rilievo/relief_impostor/critical_points.h"
#include "rilievo/relief_impostor/impostor_workers.h"
#include "rilievo/relief_impostor/merge_warps.h"

namespace rilievo {

// What the frame knows of a picture.
struct ImpostorJudgement {
  PictureGeometry geometry;
  std::vector<CriticalPair> pairs;
  bool final = false;
  std::uint64_t picture = 0;
  double time = 0;  // of what it shows
  Stopwatch made;
};

// A warp, from the warping worker to the frame.
struct ImpostorWarpResult {
  Prewarped board;
  EncodedPiece encoded;
  Stopwatch made;  // the picture
  double interpolated = 0;
  std::uint64_t picture = 0;
  double time = 0;  // of what it shows
};

// A picture, to the warping worker.
struct NumberedImpostor {
  ImpostorPicture picture;
  Stopwatch made;
  std::uint64_t number = 0;
  bool final = false;
  double time = 0;
};

// A finished picture that shows nothing, from the rendering worker to the frame.
struct ImpostorEmpty {
  static constexpr std::uint64_t kNone = ~std::uint64_t(0);
  glm::dvec3 eye{0.0};
  double time = 0;
  std::uint64_t after = kNone;  // the number of the picture that was published last before it
};

// A kind of work of one object: ordered by the frame, taken by one worker at a time.
struct ImpostorWork {
  std::atomic<bool> wanted{false}, busy{false};
  std::atomic<double> priority{0};

  // Ordered, or being done.
  [[nodiscard]] bool pending() const {
    return wanted.load(std::memory_order_acquire) || busy.load(std::memory_order_acquire);
  }
  // False if somebody else has it, or it is not wanted any more.
  bool take() {
    if (busy.exchange(true, std::memory_order_acq_rel)) return false;
    // Wanted falls after busy rose: pending() never says no in between.
    if (wanted.exchange(false, std::memory_order_acq_rel)) return true;
    busy.store(false, std::memory_order_release);
    return false;
  }
};

// One impostor.
struct ImpostorSlot {
  ImpostorObject object;
  Box bounds;
  ImpostorWork warp, render;
  // From the frame.
  TripleBuffer<glm::dvec3> warp_eyes;
  TripleBuffer<ImpostorEye> render_orders;
  // From the rendering worker: to the frame, and to the warping one.
  TripleBuffer<ImpostorJudgement> judgements;
  TripleBuffer<NumberedImpostor> pictures;
  TripleBuffer<ImpostorEmpty> empties;
  TripleBuffer<std::stop_source> stops;
  std::atomic<double> render_s{0.1};  // the last picture took
  std::atomic<std::uint64_t> published{0};
  std::atomic<bool> coarse_helps{true};  // from the frame: what is there is worse than a coarse one
  // From the warping worker to the frame; the numbers of the pictures that it has.
  TripleBuffer<ImpostorWarpResult> boards;
  std::atomic<std::uint64_t> warps_from{0}, warps_before{0};
  // The warping worker's own: the last finished picture of another eye than the newest one's.
  WarpPairScratch scratch;
  NumberedImpostor before;
  // The frame's own.
  ImpostorJudgement judged_before;  // of that picture
  glm::dvec3 ordered_eye{0.0};
  Stopwatch ordered;
  std::optional<Stopwatch> needed;  // since when a picture is
  std::uint64_t boards_seen = 0;
  std::uint64_t shown = 0;  // the picture that was shown last
};

}  // namespace rilievo
