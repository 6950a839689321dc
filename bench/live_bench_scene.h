// A scene that `bench serve` walks through: what makes its pictures, and the true frames.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "rilievo/capture/raster_ray_source.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/core/result.h"
#include "rilievo/measure/bench_report.h"
#include "rilievo/serve/live_world.h"

namespace rilievo::bench {

// How long a walk is, how large its frames are, and how many are compared.
struct LiveSizes {
  int width = 1280, height = 720;
  double seconds = 8;
  double frames_a_second = 2;  // that are compared; what is delivered does not depend on it
};

// The path tracer's light over the geometry of rays.
struct TracedLight;

// True frames are kept: they take 8 bytes a pixel each.
class LiveBenchScene {
 public:
  // `of` must outlive it. `traced`: pictures and true frames have the path tracer's light.
  [[nodiscard]] static Result<std::unique_ptr<LiveBenchScene>> create(const Scene& of,
                                                                      CameraPath walk,
                                                                      const LiveSizes& sizes,
                                                                      bool traced);
  ~LiveBenchScene();
  LiveBenchScene(const LiveBenchScene&) = delete;
  LiveBenchScene& operator=(const LiveBenchScene&) = delete;

  [[nodiscard]] const LiveSizes& sizes() const { return sizes_; }
  [[nodiscard]] CaptureSource& source();
  [[nodiscard]] CaptureSource& quick();  // of coarse pictures
  // Drawn behind pictures; null: the source draws it.
  [[nodiscard]] const Sky* sky() const;
  [[nodiscard]] LiveScene shown();
  // Work as find_work() found it.
  [[nodiscard]] LiveWorldOptions world_options() const;

  [[nodiscard]] Camera camera(double seconds) const;
  // With the rasteriser's light, whatever the source is.
  [[nodiscard]] DepthImage drawn(const Camera& camera);
  // Of 16 samples a pixel, four of each quarter; of traced light 64.
  const std::pair<Rgba8Image, Image<std::uint32_t>>& truth(double now);

  // What a fine and a coarse picture cost, by processor time over two cores: the median of a few
  // along the walk, once, so that no row depends on what else runs.
  void find_work();
  double work_s = 0, coarse_work_s = 0;

 private:
  LiveBenchScene(const Scene& of, CameraPath walk, const LiveSizes& sizes, RayScene rays);

  const Scene& scene_;
  CameraPath path_;
  LiveSizes sizes_;
  PlacedScene placed_;
  RayScene rays_;
  RasterRaySource raster_;
  std::unique_ptr<TracedLight> traced_;
  std::map<double, std::pair<Rgba8Image, Image<std::uint32_t>>> true_frames_;
};

// The depth codec on four frames, beside others: a row of a table, and figures.
[[nodiscard]] Table depth_codec_table();
void add_depth_codec(const std::string& name, LiveBenchScene& scene, Table& table,
                     BenchReport& report);

}  // namespace rilievo::bench
