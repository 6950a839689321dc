// What are the means and percentiles of a method's frames? Used by the report's JSON and its page.
#pragma once

#include "rilievo/measure/report.h"
#include "rilievo/measure/stats.h"

namespace rilievo {

// The statistics of each measure over all frames; of PSNR over those that show pictures, if any.
struct MethodSummary {
  Summary frame_ms, psnr_db, ssim, flip, wrong_visibility, uncovered, counted, gap_px;
  Summary flip_p99, ghost, speckle, flicker;
};

// One measure of all frames, in order; PSNR is limited to kMaxPsnrDb.
[[nodiscard]] std::vector<double> series(const MethodResult& method, double FrameResult::*figure);
// The statistics of a method's frames.
[[nodiscard]] MethodSummary summarize(const MethodResult& method);

}  // namespace rilievo
