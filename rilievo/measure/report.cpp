#include "rilievo/measure/report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "rilievo/measure/report_summary.h"

namespace rilievo {
namespace {

using Json = nlohmann::ordered_json;

Json mean_min(const Summary& s) { return {{"mean", s.mean}, {"min", s.min}}; }
Json mean_max(const Summary& s) { return {{"mean", s.mean}, {"max", s.max}}; }

Json method_json(const MethodResult& method) {
  const MethodSummary s = summarize(method);
  Json out;
  out["frame_ms"] = {{"p50", s.frame_ms.p50}, {"p99", s.frame_ms.p99}, {"max", s.frame_ms.max}};
  out["psnr_db"] = mean_min(s.psnr_db);
  out["ssim"] = mean_min(s.ssim);
  out["flip"] = mean_max(s.flip);
  out["wrong_visibility"] = mean_max(s.wrong_visibility);
  out["depth_error"] = {{"p50", method.depth_error_p50}, {"p99", method.depth_error_p99}};
  out["uncovered"] = mean_max(s.uncovered);
  out["counted"] = mean_min(s.counted);
  out["gap_px"] = mean_max(s.gap_px);
  out["flip_p99"] = mean_max(s.flip_p99);
  out["ghost"] = mean_max(s.ghost);
  out["speckle"] = mean_max(s.speckle);
  if (!method.flicker.empty()) out["flicker"] = mean_max(s.flicker);
  out["picture_frames"] = std::count_if(method.frames.begin(), method.frames.end(),
                                        [](const FrameResult& f) { return f.pictures; });
  out["captures"] = method.captures;
  out["capture_ms"] = method.capture_ms;
  out["picture_bytes"] = method.picture_bytes;
  if (method.bound_px_max) out["bound_px"] = {{"max", *method.bound_px_max}};
  if (method.gap_bound_px_max) out["gap_bound_px"] = {{"max", *method.gap_bound_px_max}};
  if (const auto& e = method.error_px)
    out["error_px"] = {{"p50", e->p50},
                       {"p99", e->p99},
                       {"max", e->max},
                       {"resolution", e->resolution},
                       {"measured_share", e->measured},
                       {"boundary_share", e->boundary},
                       {"mixed_share", e->mixed},
                       {"unresolved_share", e->unresolved},
                       {"over_bound_share", e->over_bound},
                       {"violations", e->violations},
                       {"in_gaps", e->in_gaps}};
  if (method.first_frame_ms) out["first_frame_ms"] = *method.first_frame_ms;
  if (method.cut_ms) out["cut_ms"] = *method.cut_ms;
  if (method.over_bound_share) out["over_bound_share"] = *method.over_bound_share;
  if (method.walked_frames) out["walked_frames"] = *method.walked_frames;
  if (method.pop_max)
    out["pop"] = {{"max", *method.pop_max}, {"frame_max", method.pop_frame_max.value_or(0)}};
  if (!method.drawn_as.empty()) {
    Json& drawn_as = out["drawn_as"] = Json::object();
    for (const auto& [way, count] : method.drawn_as) drawn_as[way] = count;
  }
  if (!method.decisions.empty()) out["decisions"] = method.decisions;
  Json& all = out["series"] = Json::object();
  all["frame_ms"] = series(method, &FrameResult::frame_ms);
  all["psnr_db"] = series(method, &FrameResult::psnr_db);
  all["ssim"] = series(method, &FrameResult::ssim);
  all["flip"] = series(method, &FrameResult::flip);
  all["wrong_visibility"] = series(method, &FrameResult::wrong_visibility);
  all["uncovered"] = series(method, &FrameResult::uncovered);
  all["gap_px"] = series(method, &FrameResult::gap_px);
  all["flip_p99"] = series(method, &FrameResult::flip_p99);
  all["ghost"] = series(method, &FrameResult::ghost);
  all["speckle"] = series(method, &FrameResult::speckle);
  if (!method.flicker.empty()) all["flicker"] = method.flicker;
  return out;
}

}  // namespace

std::vector<double> series(const MethodResult& method, double FrameResult::*figure) {
  std::vector<double> out;
  for (const FrameResult& frame : method.frames) out.push_back(frame.*figure);
  if (figure == &FrameResult::psnr_db)
    for (double& v : out) v = std::min(v, kMaxPsnrDb);
  return out;
}

MethodSummary summarize(const MethodResult& method) {
  const auto of = [&](double FrameResult::*figure) { return summarize(series(method, figure)); };
  std::vector<double> psnr;
  const bool any = std::any_of(method.frames.begin(), method.frames.end(),
                               [](const FrameResult& f) { return f.pictures; });
  for (const FrameResult& f : method.frames)
    if (f.pictures || !any) psnr.push_back(std::min(f.psnr_db, kMaxPsnrDb));
  return {method.walked_ms ? *method.walked_ms : of(&FrameResult::frame_ms),
          summarize(psnr),
          of(&FrameResult::ssim),
          of(&FrameResult::flip),
          of(&FrameResult::wrong_visibility),
          of(&FrameResult::uncovered),
          of(&FrameResult::counted),
          of(&FrameResult::gap_px),
          of(&FrameResult::flip_p99),
          of(&FrameResult::ghost),
          of(&FrameResult::speckle),
          method.flicker.empty() ? Summary() : summarize(method.flicker)};
}

std::string report_json(const Report& report) {
  RILIEVO_EXPECTS(!report.methods.empty());
  Json out;
  out["schema"] = "rilievo-report-1";
  out["commit"] = report.commit;
  out["machine"] = {{"cpu", report.machine.cpu},
                    {"threads", report.machine.threads},
                    {"gl_renderer", report.machine.gl_renderer}};
  out["scene"] = {
      {"name", report.scene_name}, {"triangles", report.triangles}, {"objects", report.objects}};
  out["size"] = {report.width, report.height};
  out["frames"] = report.methods.front().frames.size();
  out["antialiasing"] = report.antialiasing;
  out["command"] = report.command;
  Json& methods = out["methods"] = Json::object();
  for (const MethodResult& method : report.methods) {
    RILIEVO_EXPECTS_EQ(method.frames.size(), report.methods.front().frames.size());
    methods[method.name] = method_json(method);
  }
  // Names of scenes come from files, which need not be UTF-8.
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<int> frames_to_show(int frames, int most) {
  RILIEVO_EXPECTS(frames >= 0 && most >= 2);
  std::vector<int> shown;
  const int count = std::min(frames, most);
  for (int i = 0; i < count; ++i)
    shown.push_back(count == 1 ? 0 : int(std::lround(double(i) * (frames - 1) / (count - 1))));
  return shown;
}

}  // namespace rilievo
