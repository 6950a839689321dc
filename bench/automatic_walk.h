// One walk by the method auto and by each other one: times, and what is shown at a dozen places.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "rilievo/core/camera_path.h"
#include "rilievo/core/result.h"
#include "rilievo/measure/stats.h"
#include "rilievo/method/method.h"
#include "rilievo/scene/scene.h"

namespace rilievo::bench {

inline constexpr int kAutoSamples = 4;      // of a pixel, of all methods
inline constexpr int kAutoReference = 36;   // of a true frame
inline constexpr double kAutoRefresh = 30;  // frames a second of the eye, however long they take
// Frames are compared with the truth once in so many, at so many places at most: each is kept.
inline constexpr int kPlaceFrames = 20, kMostPlaces = 12;
inline constexpr int kUsualFrames = 8;  // how many frames without a change are looked at for pops
// Who prepares for so much longer than direct drawing before its first frame lets the user wait, as
// no other does.
inline constexpr double kAtOnceMs = 250;

inline constexpr const char* kAutoMethods[] = {"auto", "direct-raster", "direct-rays",
                                               "lod",  "cache",         "keyframes"};
inline constexpr std::size_t kDirectAt = 1, kCacheAt = 4;

// One method along the walk.
struct TimedMethod {
  std::string name;
  std::vector<double> ms, busy_ms;  // of all frames after the first; busy: of all threads
  double prepare_ms = 0;            // before its first frame
  double first_ms = 0;
  std::vector<double> psnr_db;  // by place
  int bad_places = 0;           // where it does not show what was asked for
  bool good_in_mean = true;     // what was asked for in the mean of the places
  Summary summary, busy;

  [[nodiscard]] bool good() const { return bad_places == 0; }
  [[nodiscard]] double mean_db() const;
};

// All methods along the walk.
struct AutoWalk {
  std::vector<TimedMethod> methods;  // of kAutoMethods
  std::map<std::string, int> drawn_by;
  int changes = 0;
  // Over the median of the frames around, the worst first frame of a method that another one drew
  // before; and its excess of change over the true frames' (measure/popping.h), beside that of
  // frames without a change. The same where the eye has jumped, so that all of the frame changes:
  // nobody sees a pop there.
  double change_ms = 0, change_pop = 0, cut_pop = 0, usual_pop = 0;
  std::size_t best = 0;          // by p50, of those that are good
  std::size_t best_in_mean = 0;  // of those that are good in the mean of the places
  double best_p99 = 0, best_busy_p50 = 0;
  double best_p99_at_once = 0;  // of those that begin at once

  [[nodiscard]] double regret_p50() const { return median() / methods[best].summary.p50; }
  [[nodiscard]] double regret_p50_in_mean() const {
    return median() / methods[best_in_mean].summary.p50;
  }
  [[nodiscard]] double regret_busy() const { return methods[0].busy.p50 / best_busy_p50; }
  [[nodiscard]] double regret_p99() const { return methods[0].summary.p99 / best_p99; }
  [[nodiscard]] double regret_p99_at_once() const {
    return methods[0].summary.p99 / best_p99_at_once;
  }

 private:
  [[nodiscard]] double median() const { return methods[0].summary.p50; }
};

// How a walk is run.
struct AutoRun {
  int width = 1280, height = 720, frames = 240;
  MethodOptions method;

  // A place is judged each so many frames.
  [[nodiscard]] int place_frames() const {
    return std::min(std::max(kPlaceFrames, frames / kMostPlaces), frames);
  }
};

// Draws the same frames by all methods in turn, so that each meets the same load; the path goes to
// and fro. What they show is judged after the last frame, so that no method has the time of a true
// frame to prepare in: keeps the frames of all methods at each place, 22 MB at 1280 x 720, and two
// of auto at each change. Fails where a method does.
[[nodiscard]] Result<AutoWalk> walk_by_all(const Scene& scene, const CameraPath& path,
                                           const AutoRun& run);

}  // namespace rilievo::bench
