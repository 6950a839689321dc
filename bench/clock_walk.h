// An orbit by the clock, in frames with one relief impostor that is made in the background.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/drawn_by.h"
#include "bench/impostor_judge.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/method/relief_impostors.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo::bench {

// How the eye goes, and what it sees. Angles in radians.
struct ClockWalkOptions {
  double seconds = 8;
  double turn = 0.5;             // of the orbit, a second
  double pace_ms = 1000.0 / 30;  // frames are not drawn faster
  int width = 640, height = 360, samples = 4;
  int kept = 8;  // frames to be judged
  WorkerOptions workers = {};
  // The last picture there was, coarse or not; may be empty.
  std::function<std::optional<DepthImage>()> last = {};
};

// A frame to be judged.
struct KeptFrame {
  Camera camera;
  Prewarped board;                 // what was shown; empty: polygons, or nothing
  std::optional<DepthImage> last;  // the last picture there was
};

struct ClockWalk {
  std::vector<double> frame_ms, latency_ms;
  std::vector<KeptFrame> kept;
  WorkerStats stats;
  int shown = 0, frames = 0;
};

// Frames with impostors, and who chooses them.
struct ImpostorDrawer {
  std::unique_ptr<FrameSource> frames;
  ImpostorChooser* chooser = nullptr;  // of `frames`
};
// Of the scene at time 0. `renderer` is make_renderer()'s, and must outlive the frames.
[[nodiscard]] Result<ImpostorDrawer> impostor_drawer(const Scene& scene, SceneRenderer* renderer,
                                                     ImpostorContent content,
                                                     const ImpostorFramesOptions& options,
                                                     int samples);

// Walks. Whatever there is of the impostor is shown, never polygons. `renderer` is
// make_renderer()'s, of the traced scene.
[[nodiscard]] Result<ClockWalk> walk_by_clock(const TracedScene& traced, SceneRenderer* renderer,
                                              ImpostorContent content,
                                              const ClockWalkOptions& options);

// The same without an impostor, all polygons: what frame times vary by without any worker.
[[nodiscard]] Result<ClockWalk> walk_polygons_by_clock(const TracedScene& traced,
                                                       SceneRenderer* renderer,
                                                       const ClockWalkOptions& options);

// How many latencies lie below 50 ms, 100 ms, ...
[[nodiscard]] std::string latency_histogram(const std::vector<double>& ms);

}  // namespace rilievo::bench
