#include "bench/stale_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/report.h"
#include "rilievo/capture/shaders/refine_picture.h"
#include "rilievo/capture/shaders/trace_light.h"
#include "rilievo/core/random.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/render/rays/cast_picture.h"

namespace rilievo::bench {
namespace {

constexpr int kNear = 2;           // pixels
constexpr float kEdge = 1 / 50.f;  // of the depth, from pixel to pixel: another surface

// Rays of one eye with the light towards another.
class OldLightRays final : public RayShader {
 public:
  OldLightRays(const TracedScene& traced, const Camera& before, const Camera& now)
      : before_(before),
        now_(now),
        objects_(*traced.scene, std::span(&traced.object, 1)),
        rays_(picture_rays(before)),
        new_rays_(picture_rays(now)),
        old_(*traced.rays, rays_, before.position(), objects_, {}),
        new_(*traced.rays, new_rays_, now.position(), objects_, {}) {}

  [[nodiscard]] std::optional<Seen> nearest(const glm::dvec2& raster) const override {
    const CameraRay ray = camera_ray(now_, raster);
    const auto hit = new_.first_hit(ray.origin, ray.direction);
    if (!hit) return std::nullopt;
    return Seen{float(ray.eye_z_start + double(hit->distance) * ray.eye_z_step), hit->object};
  }
  [[nodiscard]] float farthest(const glm::dvec2&) const override { return kNoDepth; }

  [[nodiscard]] glm::vec4 light(int x, int y, const glm::dvec2& place, int sample) const override {
    const glm::dvec2 raster(x + place.x, y + 1 - place.y);
    const CameraRay ray = camera_ray(now_, raster);
    const auto hit = new_.first_hit(ray.origin, ray.direction);
    if (!hit) return glm::vec4(0.0f);
    const TraceSample which{combine(std::uint64_t(x), std::uint64_t(y)), sample};
    const glm::dvec3 point = ray.origin + double(hit->distance) * ray.direction;
    if (const auto seen = old_hit(point)) {
      const glm::dvec3 at = raster_from_world(before_, point);
      return old_.light(*seen, rays_.through(float(at.x), float(before_.height - at.y)), which);
    }
    return new_.light(*hit, new_rays_.through(float(raster.x), float(now_.height - raster.y)),
                      which);
  }

  // Does the old eye see what the pixel's centre shows?
  [[nodiscard]] bool seen(int x, int y) const {
    const CameraRay ray = camera_ray(now_, {x + 0.5, y + 0.5});
    const auto hit = new_.first_hit(ray.origin, ray.direction);
    return !hit || old_hit(ray.origin + double(hit->distance) * ray.direction).has_value();
  }

 private:
  // The old eye's hit at a point; none where something else is before it.
  [[nodiscard]] std::optional<RayHit> old_hit(const glm::dvec3& point) const {
    const glm::dvec3 eye = before_.position();
    const auto hit = old_.first_hit(eye, 1.01 * (point - eye));
    // Single precision, and surfaces seen at grazing angles.
    constexpr double kClose = 1e-3;
    if (!hit || std::abs(1.01 * double(hit->distance) - 1) > kClose) return std::nullopt;
    return hit;
  }

  const Camera &before_, &now_;
  ObjectSet objects_;
  PictureRays rays_, new_rays_;
  LightTracer old_, new_;
};

}  // namespace

OldLight old_light(const TracedScene& traced, const Camera& before, const Camera& now,
                   int samples) {
  const OldLightRays rays(traced, before, now);
  CaptureRequest request;
  request.camera = now;
  request.samples = samples;
  Result<CapturedPicture> captured = refine_picture(rays, request, traced.name);
  RILIEVO_EXPECTS(bool(captured));
  OldLight light;
  light.picture = std::move(captured->picture);
  light.hidden = Image<std::uint8_t>(now.width, now.height);
  for (int y = 0; y < now.height; ++y)
    for (int x = 0; x < now.width; ++x)
      light.hidden(x, y) = light.picture.covered(x, y) && !rays.seen(x, y);
  return light;
}

ErrorShares error_shares(const Rgba8Image& drawn, const Rgba8Image& truth, const glm::ivec2& corner,
                         const OldLight& light) {
  const DepthImage& picture = light.picture;
  const int w = picture.camera.width, h = picture.camera.height;
  // An edge between a pixel and its right or lower neighbour.
  Image<std::uint8_t> edge(w, h);
  std::size_t covered = 0, hidden = 0;
  for (int y = 0; y + 1 < h; ++y)
    for (int x = 0; x + 1 < w; ++x) {
      const float at = picture.depth(x, y);
      for (const float other : {picture.depth(x + 1, y), picture.depth(x, y + 1)})
        if ((at == kNoDepth) != (other == kNoDepth) ||
            std::abs(at - other) > kEdge * std::min(at, other))
          edge(x, y) = 1;
      covered += at != kNoDepth, hidden += light.hidden(x, y);
    }
  double all = 0;
  ErrorShares shares;
  for (int y = 0; y < drawn.height(); ++y)
    for (int x = 0; x < drawn.width(); ++x) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) {
        const double d = double(drawn(x, y)[k]) - double(truth(x, y)[k]);
        sum += d * d;
      }
      if (sum == 0) continue;
      bool by_edge = false, by_hidden = false;
      const int cx = x + corner.x, cy = y + corner.y;
      for (int v = std::max(0, cy - kNear); v <= std::min(h - 1, cy + kNear); ++v)
        for (int u = std::max(0, cx - kNear); u <= std::min(w - 1, cx + kNear); ++u)
          by_edge = by_edge || edge(u, v), by_hidden = by_hidden || light.hidden(u, v);
      all += sum;
      (by_edge ? shares.silhouettes : shares.hidden) += by_edge || by_hidden ? sum : 0;
    }
  if (all > 0) shares.silhouettes /= all, shares.hidden /= all;
  shares.hidden_pixels = covered > 0 ? double(hidden) / double(covered) : 0;
  return shares;
}

Result<> stale_parts(const TracedScene& traced, ImpostorJudge& judge, double turn, int eyes,
                     const WorkerOptions& options, BenchReport& report) {
  Table table{"Whose is the error of an old picture? " + traced.name,
              {"age ms", "warped", "true surfaces, old light", "warped against old light",
               "at silhouettes %", "at hidden parts %", "hidden pixels %"},
              {}};
  constexpr int kSamples = 4;
  for (const double age : {0.0, 0.1, 0.5}) {
    double warped = 0, ideal = 0, own = 0, edges = 0, hidden = 0, pixels = 0;
    for (int i = 0; i < eyes; ++i) {
      const double angle = 2 * std::numbers::pi * i / eyes;
      const Camera now = orbit_camera(traced, angle, judge.width(), judge.height());
      const Camera before = orbit_camera(traced, angle - turn * age, judge.width(), judge.height());
      const Result<DepthImage> picture = judge.shade(before, options);
      if (!picture) return picture.error();
      const Result<ImpostorQuality> q = judge.judge(warped_for(*picture, now.position()), now);
      if (!q) return q.error();
      const OldLight light = old_light(traced, before, now, kSamples);
      const Rgba8Image best = judge.same_part(light.picture);
      const ErrorShares shares = error_shares(judge.drawn(), best, judge.corner(), light);
      warped += q->psnr_db, ideal += psnr_db(best, judge.truth());
      own += psnr_db(judge.drawn(), best);
      edges += shares.silhouettes, hidden += shares.hidden, pixels += shares.hidden_pixels;
      if (i == 0) {
        const std::string suffix = fmt::format(", {:.0f} ms old", 1e3 * age);
        report.pictures.push_back(png_picture("true surfaces, old light" + suffix, best));
      }
    }
    const auto mean = [&](double sum, int digits) {
      return fmt::format("{:.{}f}", sum / eyes, digits);
    };
    table.rows.push_back({fmt::format("{:.0f}", 1e3 * age), mean(warped, 1), mean(ideal, 1),
                          mean(own, 1), mean(100 * edges, 0), mean(100 * hidden, 0),
                          mean(100 * pixels, 1)});
    report.figures.emplace_back(fmt::format("psnr_db_old_light_{:.0f}ms", 1e3 * age), ideal / eyes);
    report.figures.emplace_back(fmt::format("psnr_db_warp_alone_{:.0f}ms", 1e3 * age), own / eyes);
  }
  report.tables.push_back(std::move(table));
  return Done{};
}

}  // namespace rilievo::bench
