// How right is a relief impostor in a frame, beside a full ray tracing of its object?
//
// Each is drawn alone, over black, without OpenGL, and compared in the rectangle around the object.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rilievo/capture/shaders/ray_tracer.h"
#include "rilievo/relief_impostor/impostor_drawable.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/scene.h"

namespace rilievo::bench {

// A scene, one object of it, and rays that meet all of it.
struct TracedScene {
  std::string name;
  std::unique_ptr<Scene> scene;
  std::unique_ptr<RayScene> rays;
  std::uint32_t object = 0;
  Box box;  // of the object
};

// "builtin:..." or a file; the object with the most triangles that is not larger than half of the
// scene, if there is one.
[[nodiscard]] Result<TracedScene> traced_scene(const std::string& name);

// The eye of an orbit around the object, at an angle (radians).
[[nodiscard]] Camera orbit_camera(const TracedScene& traced, double angle, int width, int height);

struct ImpostorQuality {
  double psnr_db = 0, ssim = 0, flip = 0;
};
// The mean of several.
[[nodiscard]] ImpostorQuality mean_quality(const std::vector<ImpostorQuality>& all);

// Draws and compares.
class ImpostorJudge {
 public:
  ImpostorJudge(const TracedScene& traced, int width, int height, int samples);
  // The picture that a worker would make.
  [[nodiscard]] Result<DepthImage> shade(const Camera& seen_from, const WorkerOptions& options);
  // The truth is what `source` shows of `objects` with so many samples, instead of the object
  // ray-traced; it must outlive the judge.
  void judge_by(CaptureSource& source, std::vector<std::uint32_t> objects, int samples) {
    source_ = &source, truth_objects_ = std::move(objects), samples_ = samples;
  }
  // Draws a board, as a frame does, and compares it with the object traced for `camera`.
  [[nodiscard]] Result<ImpostorQuality> judge(const Prewarped& board, const Camera& camera);
  [[nodiscard]] int width() const { return target_.width(); }
  [[nodiscard]] int height() const { return target_.height(); }
  // The last two that were compared.
  [[nodiscard]] const Rgba8Image& drawn() const { return drawn_; }
  [[nodiscard]] const Rgba8Image& truth() const { return truth_; }
  // The part of a picture by the same camera that these two are, and its upper left corner.
  [[nodiscard]] Rgba8Image same_part(const DepthImage& picture) const;
  [[nodiscard]] glm::ivec2 corner() const { return {crop_.x, crop_.y}; }

 private:
  const TracedScene* traced_;
  SoftwareTarget target_;
  std::unique_ptr<ImpostorDrawable> drawable_;
  std::uint64_t number_ = 0;
  Camera truth_camera_;
  CaptureSource* source_ = nullptr;  // null: rays
  std::vector<std::uint32_t> truth_objects_;
  int samples_ = 4;
  glm::ivec4 crop_{0};  // left, top, right, bottom
  Rgba8Image truth_premultiplied_, drawn_, truth_;
};

// The picture as it is, one plane with the colours of its eye: drawn from another one, a homography
// moves it (what reprojection of the last frame does).
[[nodiscard]] Prewarped as_one_plane(const DepthImage& picture);
// Two pictures warped for an eye and merged, as the workers do; empty if they cannot be.
[[nodiscard]] Prewarped merged_for(const DepthImage& one, const DepthImage& two,
                                   const glm::dvec3& eye);
// ... warped for an eye; empty if it cannot be.
[[nodiscard]] Prewarped warped_for(const DepthImage& picture, const glm::dvec3& eye);

}  // namespace rilievo::bench
