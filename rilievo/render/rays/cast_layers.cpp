#include "rilievo/render/rays/cast_layers.h"

#include <cmath>
#include <limits>

#include "rilievo/core/parallel_for.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/rays/stroke_hits.h"

namespace rilievo {

LayeredDepthImage cast_layers(const RayScene& rays, const Camera& camera,
                              const CastLayersOptions& options) {
  const HitShader shader(rays, camera, options.least_roughness);
  return cast_layers(rays, camera, options, [&shader](const RayHit& hit, int x, int y) {
    return std::optional(shader.shade(hit, x, y));
  });
}

LayeredDepthImage cast_layers(const RayScene& rays, const Camera& camera,
                              const CastLayersOptions& options, const LayerShade& shade) {
  RILIEVO_EXPECTS(camera.projection != Projection::back_perspective);
  const int width = camera.width, height = camera.height;
  const ObjectSet objects(rays.scene(), options.objects);
  const StrokeHits strokes(rays, camera, objects);
  struct Row {
    std::vector<LayerSample> samples;
    std::vector<std::uint32_t> counts;
  };
  std::vector<Row> rows{std::size_t(height)};
  parallel_for(0, height, [&](int y) {
    Row& row = rows[std::size_t(y)];
    row.counts.assign(std::size_t(width), 0);
    for (int x = 0; x < width; ++x) {
      const CameraRay ray = camera_ray(camera, {x + 0.5, y + 0.5});
      double kept = -std::numeric_limits<double>::infinity();
      float from = 0;
      for (int layer = 0; layer < options.max_layers;) {
        const std::optional<RayHit> hit = strokes.nearer(
            {x + 0.5, y + 0.5},
            rays.first_hit(ray.origin, ray.direction, from, 1.0f, RaySides::both, objects), from);
        if (!hit) break;
        // The next surface lies behind this one, by as little as can be told.
        from = std::nextafter(hit->distance, 2.0f);
        const double z = ray.eye_z_start + double(hit->distance) * ray.eye_z_step;
        if (z - kept <= options.merge) continue;
        const std::optional<glm::vec4> color = shade(*hit, x, y);
        if (!color) continue;
        LayerSample sample;
        sample.color = *color;
        sample.depth = sample.back = float(z);
        sample.object = hit->object;
        row.samples.push_back(sample);
        ++row.counts[std::size_t(x)];
        kept = z;
        ++layer;
      }
    }
  });

  LayeredDepthImage layers;
  layers.camera = camera;
  layers.first.reserve(std::size_t(width) * std::size_t(height) + 1);
  layers.first.push_back(0);
  std::size_t samples = 0;
  for (const Row& row : rows) samples += row.samples.size();
  layers.samples.reserve(samples);
  for (const Row& row : rows) {
    for (const std::uint32_t count : row.counts)
      layers.first.push_back(layers.first.back() + count);
    layers.samples.insert(layers.samples.end(), row.samples.begin(), row.samples.end());
  }
  return layers;
}

}  // namespace rilievo
