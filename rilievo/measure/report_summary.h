// What a method's frames come to; shared by the report's JSON and its page.
#pragma once

#include "rilievo/measure/report.h"
#include "rilievo/measure/stats.h"

namespace rilievo {

struct MethodSummary {
  Summary frame_ms, psnr_db, ssim, flip, wrong_visibility, uncovered;
};

// One figure of every frame, in their order; PSNR cut off at kMostPsnrDb.
[[nodiscard]] std::vector<double> series(const MethodResult& method, double FrameResult::*figure);
[[nodiscard]] MethodSummary summarize(const MethodResult& method);

}  // namespace rilievo
