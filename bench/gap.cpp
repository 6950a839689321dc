#include "bench/gap.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "bench/gap_scenes.h"
#include "bench/random.h"
#include "rilievo/core/depth.h"
#include "rilievo/measure/stats.h"
#include "rilievo/nailboard/gap_table.h"

namespace rilievo::bench {
namespace {

constexpr int kFramesPerScene = 8, kGapRays = 1500, kRuns = 12;
constexpr double kStep = 0.05, kLongest = 200;  // pixels

struct GapCapture {
  GapScene scene;
  PictureGeometry picture;
  GapTable table;
};

GapCapture capture(std::size_t kind, SplitMix64& random) {
  GapCapture made;
  made.scene = make_gap_scene(kind, random);
  const double reach = made.scene.reach();
  Box box;
  box.add(glm::vec3(float(-reach))), box.add(glm::vec3(float(reach)));
  // Along z, within some 20 degrees.
  const glm::dvec3 from = glm::normalize(glm::dvec3(0, 0, 3) + random.direction());
  const double distance = 10 * random.power(0.7, 2);
  Camera camera = tight_camera(Projection::perspective, distance * from, {0, 1, 0}, box).value();
  camera.width = 160 + random.below(160);
  camera.height = 160 + random.below(160);
  made.picture = picture_geometry(camera);
  Image<float> nearest(camera.width, camera.height, kNoDepth), farthest = nearest;
  double least = camera.z_far, most = camera.z_near;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec3 ray = world_from_raster(camera, {x + 0.5, y + 0.5}, 1) - camera.position();
      double first = 0, last = 0;
      if (!made.scene.cast(camera.position(), ray, first, last)) continue;
      nearest(x, y) = float(first), farthest(x, y) = float(last);
      least = std::min(least, first), most = std::max(most, first);
    }
  // As the cache narrows it: to what the capture saw.
  made.picture.slab = {least, most};
  made.picture.plane_z = best_plane(made.picture.slab);
  made.table = make_gap_table(nearest, farthest);
  return made;
}

struct GapFrame {
  Camera camera;
  RigidMotion motion;
  Camera camera_then;  // the frame's, moved against the object
};

GapFrame new_frame(const GapCapture& captured, SplitMix64& random) {
  const glm::dvec3 old_eye = captured.picture.capture.position();
  const double distance = glm::length(old_eye);
  glm::dvec3 step = random.vector(distance * random.power(0.01, 0.1));
  if (random.next() < 0.4) step -= 0.9 * glm::dot(step, old_eye) / (distance * distance) * old_eye;
  GapFrame frame;
  const glm::dvec3 target = random.vector(distance * random.between(0, 0.15));
  const glm::dvec3 up = random.next() < 0.5 ? glm::dvec3(0, 1, 0) : random.direction();
  frame.camera = look_at(old_eye + step, target, up, random.between(0.4, 1.0), 480, 320,
                         0.01 * distance, 10 * distance);
  if (random.next() < 0.5) {
    const glm::dvec3 axis = random.direction();
    frame.motion.now_from_then = glm::rotate(glm::dmat4(1), random.power(1e-3, 0.05), axis);
    frame.motion.now_from_then[3] =
        glm::dvec4(random.vector(distance * random.power(1e-3, 0.03)), 1);
  }
  frame.camera_then = frame.camera;
  frame.camera_then.world_from_eye =
      glm::inverse(frame.motion.now_from_then) * frame.camera.world_from_eye;
  return frame;
}

// What of the scene the capture's position did not see, in the frame's raster space.
class Missing {
 public:
  Missing(const GapScene& scene, const glm::dvec3& capture_eye, const Camera& frame)
      : scene_(scene), capture_eye_(capture_eye), frame_(frame) {}

  // Is it missing, inside the frame? And where is it?
  bool at(const glm::dvec2& raster, glm::dvec3* where = nullptr) const {
    if (raster.x < 0 || raster.y < 0 || raster.x > frame_.width || raster.y > frame_.height)
      return false;
    const glm::dvec3 eye = frame_.position(), ray = world_from_raster(frame_, raster, 1) - eye;
    double first = 0, last = 0;
    if (!scene_.cast(eye, ray, first, last)) return false;
    const glm::dvec3 point = eye + first * ray;
    if (where) *where = point;
    double seen = 0;
    return scene_.cast(capture_eye_, point - capture_eye_, seen, last) && seen < 1 - 1e-6;
  }

  // Pixels of the run along the epipolar line.
  double run(const glm::dvec2& raster, const glm::dvec3& point) const {
    const glm::dvec3 nearer = point + 1e-4 * (capture_eye_ - point);
    const glm::dvec2 along = glm::dvec2(raster_from_world(frame_, nearer)) -
                             glm::dvec2(raster_from_world(frame_, point));
    if (glm::length(along) < 1e-9) return 0;
    const glm::dvec2 step = kStep * glm::normalize(along);
    int before = 0, behind = 0;
    const int most = int(kLongest / kStep);
    while (before < most && at(raster - double(before + 1) * step)) ++before;
    while (behind < most && at(raster + double(behind + 1) * step)) ++behind;
    return kStep * (before + behind);
  }

 private:
  const GapScene& scene_;
  glm::dvec3 capture_eye_;
  const Camera& frame_;
};

double widest(const GapCapture& captured, const GapFrame& frame, SplitMix64& random) {
  const Missing missing(captured.scene, captured.picture.capture.position(), frame.camera_then);
  double widest = 0;
  int runs = 0;
  for (int i = 0; i < kGapRays && runs < kRuns; ++i) {
    const glm::dvec2 raster{random.next() * frame.camera.width,
                            random.next() * frame.camera.height};
    glm::dvec3 point;
    if (!missing.at(raster, &point)) continue;
    widest = std::max(widest, missing.run(raster, point));
    ++runs;
  }
  return widest;
}

}  // namespace

GapStats run_gap_benchmark(const GapOptions& options) {
  GapStats stats;
  std::vector<double> ratios;
  std::vector<std::vector<double>> ratios_of(std::size(kGapScenes));
  for (const std::string_view name : kGapScenes)
    stats.scenes.push_back({std::string(name), 0, 0, 0, 0, 0});
  SplitMix64 random{options.seed};
  GapCapture captured;
  for (int i = 0; i < options.cases; ++i) {
    const std::size_t kind = std::size_t(i / kFramesPerScene) % std::size(kGapScenes);
    if (i % kFramesPerScene == 0) captured = capture(kind, random);
    const GapFrame frame = new_frame(captured, random);
    const double truth = widest(captured, frame, random);
    const double bound =
        options.scale * bound_gap_px(captured.picture, captured.table, frame.camera, frame.motion);
    const double slab = bound_error(captured.picture, frame.camera, frame.motion).disocclusion_px;
    GapStats::OfScene& of = stats.scenes[kind];
    ++of.cases, ++stats.cases;
    if (truth > bound + kGapMeasuredTo) {
      ++of.violations, ++stats.violations;
      stats.worst_excess_px = std::max(stats.worst_excess_px, truth - bound);
    }
    if (truth > slab + kGapMeasuredTo) ++of.slab_violations, ++stats.slab_violations;
    if (truth < 1) continue;
    ++of.seen, ++stats.seen;
    ratios.push_back(bound / truth), ratios_of[kind].push_back(bound / truth);
  }
  stats.tightness_median = median_of(ratios);
  for (std::size_t kind = 0; kind < stats.scenes.size(); ++kind)
    stats.scenes[kind].tightness_median = median_of(ratios_of[kind]);
  return stats;
}

}  // namespace rilievo::bench
