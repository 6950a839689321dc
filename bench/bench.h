// What can be measured, by name: `rilievo bench NAME`.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/cache/plan/policy.h"
#include "rilievo/cache/prices/machine_costs.h"
#include "rilievo/core/result.h"
#include "rilievo/measure/bench_report.h"

namespace rilievo::bench {

struct BenchOptions {
  // Far fewer cases: shows that the bench runs, its figures mean nothing.
  bool quick = false;
  // All cases, where a run without it tries fewer of them.
  bool full = false;
  // A capture of photographs with depth (io/rgbd.h), for benches that take one; may be empty.
  std::string capture;
  // What draws frames, where a bench leaves it open (of `real`, the cache's): opengl, software, or
  // automatic, which is software where OpenGL runs on processors (the command line says which is
  // faster, instead); never automatic without OpenGL.
  std::string draw = "automatic";
  // For `program-walk`: who shades, raytrace, sdf:NAME or exec:PROGRAM; empty: raytrace.
  std::string shader;
  // Scene files, for benches that take some besides the built-in ones.
  std::vector<std::string> scenes;
  // For `real`: the size of frames (0: its own), and the cache's time for captures per frame, ms
  // (0: a budget of triangles instead).
  int width = 0, height = 0;
  double capture_ms = 0;
  double late = SpikePolicy{}.late;      // as ImageCacheOptions::late
  double max_spike = kInteractiveSpike;  // as ImageCacheOptions::max_spike
  bool levels = false;                   // as ImageCacheOptions::levels
  // For `keyframes`: time that a frame spends on the next keyframe, ms (0: a sixteenth of one), and
  // samples of a keyframe's texel.
  double keyframe_ms = 8;
  int keyframe_samples = 4;
  // For `keyframes`: the eye moves by a sixtieth of a second a frame, not by the clock; and where
  // true frames of such a walk are kept (empty: nowhere).
  bool each_frame = false;
  std::string reference_folder;
  // For `serve`, `auto` and `slow-keyframes`: the length of walks, s (0: its own). For `serve`:
  // which of 60 frames a second are compared (one of so many; 0: its own), latencies one way
  // (empty: its networks), and who makes pictures, raster or raytrace.
  double seconds = 0;
  int every_frame = 0;
  std::vector<double> latencies_ms;
  std::string source;
  // For `real`: what the cache compares; none: the costs built in.
  std::optional<MachineCosts> machine;
  // Called now and then with what is done and how much there is.
  std::function<void(int done, int total)> progress;
};

// What does a bench need to run?
enum class Needs {
  nothing,
  opengl,      // a current OpenGL context
  as_it_draws  // one unless BenchOptions::draw is software
};

struct Bench {
  std::string_view name;
  std::string_view question;
  Needs needs = Needs::opengl;
  Result<BenchReport> (*run)(const BenchOptions&) = nullptr;
};

[[nodiscard]] std::span<const Bench> benches();

}  // namespace rilievo::bench
