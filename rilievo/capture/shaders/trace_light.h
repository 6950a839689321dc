// How much light arrives along a ray? Recursive ray tracing (S5.8), after [Whitted 1980] and, for
// lights of a size, [Cook, Porter, Carpenter 1984].
//
// Surfaces are shaded as everywhere in the library (shading_model.inl), but lights cast shadows,
// and the mirrored part of the surroundings comes from a ray instead of from the sky alone. Where a
// mirror ray meets nothing and nothing casts a shadow, the colour is that of the other renderers.
// Roughness keeps its meaning there: the share of the hemisphere's light in the mirrored one, not a
// wider cone. Glass (Material::transmission) refracts by Snell's law, reflects by Fresnel's
// formula, and lets light through to what it shadows, straight on. Blended parts are glass that
// does not bend light. Internal to capture; any thread.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/render/rays/hit_surface.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

// What is traced.
struct TraceOptions {
  int bounces = 4;            // reflections and refractions in a row
  int light_samples = 4;      // shadow rays towards a light of a size, for each sample of a texel
  double sun_degrees = 0.53;  // the angle that a directional light fills; 0: hard shadows
  double light_radius = 0.0;  // metres, of point and spot lights; 0: hard shadows
  std::uint64_t seed = 1;     // of the places on lights
};

// A place of a picture's texel: which random numbers its rays use.
struct TraceSample {
  std::uint64_t texel = 0;  // the key of the texel
  int index = 0;            // of the texel's samples
};

// Traces rays of one picture.
class LightTracer {
 public:
  // `rays` and `objects` must outlive it. Rays of the eye see `objects` (a mask; empty: all) alone;
  // shadows and reflections are everybody's.
  LightTracer(const RayScene& rays, const PictureRays& picture, const glm::dvec3& eye,
              std::span<const bool> objects, const TraceOptions& options);

  // The first hit of a ray of the eye.
  [[nodiscard]] std::optional<RayHit> first_hit(const glm::dvec3& origin,
                                                const glm::dvec3& direction) const;
  // Light from that hit of `ray` (as PictureRays has it), premultiplied; alpha below 1 where the
  // eye's ray goes through blended parts into the open.
  [[nodiscard]] glm::vec4 light(const RayHit& hit, const glm::vec3& ray,
                                const TraceSample& sample) const;

 private:
  struct Ray;
  struct Surface;
  [[nodiscard]] Surface surface(const RayHit& hit, const PictureRays& rays, const glm::vec3& ray,
                                const glm::dvec3& eye) const;
  [[nodiscard]] glm::vec4 leaving(const Ray& ray, const Surface& at) const;
  [[nodiscard]] glm::vec3 direct(const Ray& ray, const Surface& at) const;
  [[nodiscard]] glm::vec3 visible(const Surface& at, const glm::vec3& way, float distance) const;
  [[nodiscard]] glm::vec4 arriving(const Ray& ray) const;

  const RayScene& rays_;
  PictureRays picture_;
  glm::dvec3 eye_;
  std::span<const bool> objects_;
  TraceOptions options_;
  std::vector<Light> storage_;
  std::span<const Light> lights_;
  Sky sky_;
  bool has_glass_ = false;  // are there parts that light goes through?
  float sun_cosine_ = 1;
};

}  // namespace rilievo
