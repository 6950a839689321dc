#include "rilievo/capture/shaders/trace_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rilievo/core/random.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {
namespace {

namespace model = shading_model;
using TraceVec = model::Vec3<float>;

constexpr int kMaxPasses = 16;        // blended parts that one ray goes through
constexpr float kLeastShare = 0.01f;  // of the mirrored light, for a ray of its own
constexpr float kUnlimited = 1e30f;

glm::vec3 glm_from(const TraceVec& v) { return {v.x, v.y, v.z}; }

// Two units across `w`, which is one, too [Duff et al. 2017].
void axes_across(const glm::vec3& w, glm::vec3& u, glm::vec3& v) {
  const float sign = std::copysign(1.0f, w.z), a = -1.0f / (sign + w.z), b = w.x * w.y * a;
  u = {1 + sign * w.x * w.x * a, sign * b, -sign * w.x};
  v = {b, sign + w.y * w.y * a, -w.y};
}

// The i-th place in the unit square, of a sequence that fills it evenly from any start: multiples
// of the powers of the plastic number's inverse [Roberts 2018], shifted by `key`.
glm::vec2 even_place(std::uint64_t key, int i) {
  const double x = double(unit_float(scramble(key))) + i * 0.7548776662466927;
  const double y = double(unit_float(scramble(key + 1))) + i * 0.5698402909980532;
  return {float(x - std::floor(x)), float(y - std::floor(y))};
}

// The share of light that glass reflects: Fresnel's formulas for light without polarisation.
// `cosine`: of the angle of incidence; `eta`: index behind the surface over that before it.
float fresnel(float cosine, float eta, float& cosine_behind) {
  const float sine2 = (1 - cosine * cosine) / (eta * eta);
  if (sine2 >= 1) return 1;  // total reflection
  cosine_behind = std::sqrt(1 - sine2);
  const float s = (cosine - eta * cosine_behind) / (cosine + eta * cosine_behind);
  const float p = (eta * cosine - cosine_behind) / (eta * cosine + cosine_behind);
  return 0.5f * (s * s + p * p);
}

}  // namespace

// A ray on its way.
struct LightTracer::Ray {
  glm::dvec3 origin{0.0};
  glm::vec3 direction{0.0f};    // unit
  float width = 0, spread = 0;  // of a texel where it starts, and how that grows with distance
  int bounces = 0, passes = 0;
  bool of_eye = false;    // straight from the eye so far
  bool inside = false;    // in glass that bends light
  std::uint64_t key = 0;  // of its random numbers
  int sample = 0, light_samples = 1;
};

// A hit, ready to be shaded.
struct LightTracer::Surface {
  model::SurfacePoint<float> point;
  model::Response<float> response;
  glm::dvec3 eye{0.0};       // what positions are relative to
  glm::vec3 relative{0.0f};  // its position
  glm::vec3 front{0.0f};     // geometric normal
  float offset = 0;          // how far from the surface a new ray starts
  bool blended = false;
  int mesh = 0;
  std::uint32_t triangle = 0;
  glm::vec2 barycentric{0.0f};

  // Where a ray in this direction starts: on the side to which it goes.
  [[nodiscard]] glm::dvec3 start(const glm::vec3& way) const {
    const double side = glm::dot(way, front) < 0 ? -offset : offset;
    return eye + glm::dvec3(relative) + side * glm::dvec3(front);
  }
};

LightTracer::LightTracer(const RayScene& rays, const PictureRays& picture, const glm::dvec3& eye,
                         std::span<const bool> objects, const TraceOptions& options)
    : rays_(rays),
      picture_(picture),
      eye_(eye),
      objects_(objects),
      options_(options),
      lights_(surface_lights(rays.scene(), eye, storage_).lights),
      sky_(rays.scene().sky),
      sun_cosine_(float(std::cos(0.5 * options.sun_degrees * std::numbers::pi / 180))) {
  for (const Material& material : rays.scene().materials)
    has_glass_ = has_glass_ || material.alpha_mode == AlphaMode::blend;
}

std::optional<RayHit> LightTracer::first_hit(const glm::dvec3& origin,
                                             const glm::dvec3& direction) const {
  return rays_.first_hit(RayPictureView{picture_, eye_, objects_}, origin, direction, 0.0f, 1.0f);
}

LightTracer::Surface LightTracer::surface(const RayHit& hit, const PictureRays& rays,
                                          const glm::vec3& ray, const glm::dvec3& eye) const {
  Surface at;
  at.point = surface_of_hit(rays_, hit, rays, ray, eye);
  at.response = model::response_of(at.point);
  at.eye = eye;
  at.relative = glm_from(at.point.relative);
  at.front = hit.normal;
  // Single precision places a point so well in the world, and relative to the eye.
  const glm::dvec3 world = glm::abs(eye + glm::dvec3(at.relative));
  at.offset = 4e-6f * (float(std::max({world.x, world.y, world.z})) + glm::length(at.relative));
  at.blended = surface_material(rays_, hit).blended;
  at.mesh = mesh_of_hit(rays_, hit);
  at.triangle = hit.triangle;
  at.barycentric = hit.barycentric;
  return at;
}

// The share of light that arrives from `way`, up to a distance.
glm::vec3 LightTracer::visible(const Surface& at, const glm::vec3& way, float distance) const {
  const glm::vec3 origin(at.start(way));
  if (!has_glass_) return glm::vec3(rays_.occluded(origin, way, 0.0f, distance) ? 0.0f : 1.0f);
  const Scene& scene = rays_.scene();
  glm::vec3 share(1.0f);
  float from = 0;
  for (int i = 0; i < kMaxPasses; ++i) {
    const auto hit = rays_.first_hit(origin, way, from, distance);
    if (!hit) return share;
    if (!surface_material(rays_, *hit).blended) break;
    const int mesh = mesh_of_hit(rays_, *hit);
    const Material& material =
        scene.materials[std::size_t(scene.meshes[std::size_t(mesh)].material)];
    const glm::vec4 color = base_color_at(scene, mesh, hit->triangle, hit->barycentric);
    share *= material.transmission > 0 ? material.transmission * glm::vec3(color)
                                       : glm::vec3(1 - color.a);
    from = hit->distance + at.offset;
  }
  return glm::vec3(0.0f);
}

// Light that comes straight from the lights and leaves towards the view.
glm::vec3 LightTracer::direct(const Ray& ray, const Surface& at) const {
  const model::Response<float>& s = at.response;
  TraceVec light(0, 0, 0);
  for (std::size_t i = 0; i < lights_.size(); ++i) {
    const Light& whole = lights_[i];
    const bool sun = whole.kind == Light::Kind::directional;
    const bool has_size = sun ? options_.sun_degrees > 0 : options_.light_radius > 0;
    const int samples = has_size ? ray.light_samples : 1;
    TraceVec sum(0, 0, 0);
    for (int k = 0; k < samples; ++k) {
      Light place = whole;
      if (has_size) {
        const glm::vec2 u = even_place(combine(ray.key, i), ray.sample * samples + k);
        const float turn = 2 * std::numbers::pi_v<float> * u.y;
        glm::vec3 x, y, way;
        TraceVec l;
        model::arrives(whole, at.eye, at.point.relative, l);
        way = glm_from(l);
        axes_across(way, x, y);
        const glm::vec3 across = std::cos(turn) * x + std::sin(turn) * y;
        if (sun) {
          // Uniform over the cap of the sphere of directions.
          const float c = 1 - u.x * (1 - sun_cosine_);
          place.direction = -(c * way + std::sqrt(std::max(0.0f, 1 - c * c)) * across);
        } else {
          // Uniform over the disc that faces the surface.
          place.position += float(options_.light_radius) * std::sqrt(u.x) * across;
        }
      }
      TraceVec l;
      const float strength = model::arrives(place, at.eye, at.point.relative, l);
      const TraceVec out = strength * (TraceVec(place.intensity) *
                                       model::reflected(s.n, s.v, l, s.diffuse, s.f0, s.alpha2));
      if (!(out.x > 0 || out.y > 0 || out.z > 0)) continue;
      const float distance =
          sun ? kUnlimited
              : float(glm::length(glm::dvec3(place.position) - at.eye - glm::dvec3(at.relative)));
      sum = sum + TraceVec(visible(at, glm_from(l), distance)) * out;
    }
    light = light + (samples == 1 ? sum : 1.0f / float(samples) * sum);
  }
  return glm_from(light);
}

// Light that leaves a surface against the ray.
glm::vec4 LightTracer::leaving(const Ray& ray, const Surface& at) const {
  const Scene& scene = rays_.scene();
  Surface here = at;
  model::Response<float>& s = here.response;
  const auto onward = [&](const glm::vec3& way, std::uint64_t branch) {
    Ray out = ray;
    out.origin = at.start(way);
    out.direction = way;
    out.width = ray.width + ray.spread * glm::length(at.relative);
    out.key = combine(ray.key, branch);
    return out;
  };
  const auto bounced = [&](const glm::vec3& way, std::uint64_t branch, bool inside) {
    if (ray.bounces >= options_.bounces) return glm_from(model::sky_radiance(sky_, way.y));
    Ray out = onward(way, branch);
    out.bounces = ray.bounces + 1;
    out.light_samples = 1;
    out.of_eye = false;
    out.inside = inside;
    return glm::vec3(arriving(out));
  };
  const glm::vec3 n = glm_from(s.n), v = glm_from(s.v);
  const float towards_v = glm::dot(n, v), n_v = std::clamp(towards_v, 0.0f, 1.0f);

  // The light that goes through, in shares of red, green and blue.
  glm::vec3 through(0.0f);
  float alpha = 1, mirror = 0, behind = 1, eta = 1;
  bool bends = false;
  if (here.blended) {
    const Material& glass =
        scene.materials[std::size_t(scene.meshes[std::size_t(at.mesh)].material)];
    if (glass.transmission > 0) {
      const bool enters = glm::dot(at.front, ray.direction) < 0;
      eta = ray.inside && !enters ? 1 / glass.ior : glass.ior;
      mirror = fresnel(n_v, eta, behind);
      bends = glass.refracts;
      through = (1 - mirror) * glass.transmission *
                (ray.inside ? glm::vec3(1.0f) : glm_from(at.point.base));
      s.diffuse = (1 - glass.transmission) * s.diffuse;
    } else {
      alpha = base_color_at(scene, at.mesh, at.triangle, at.barycentric).a;
      through = glm::vec3(1 - alpha);
    }
  }

  glm::vec3 color = glm_from(at.point.base);
  if (ray.inside) {
    color = mirror * bounced(2 * towards_v * n - v, 2, true);
  } else if (at.point.lit > 0) {
    const TraceVec hemisphere = model::hemisphere_of(sky_, s.n);
    TraceVec share = model::mirror_share(s, n_v);
    if (mirror > 0) share = TraceVec(mirror, mirror, mirror);
    const glm::vec3 way = 2 * towards_v * n - v;
    TraceVec seen = model::sky_radiance(sky_, way.y);
    const float most =
        std::max({share.x, share.y, share.z}) * (1 - s.roughness) * at.point.occlusion;
    const bool leaves = glm::dot(way, at.front) * glm::dot(ray.direction, at.front) < 0;
    if (most > kLeastShare && leaves) seen = TraceVec(bounced(way, 2, false));
    const TraceVec mirrored = model::mix(seen, hemisphere, s.roughness);
    const TraceVec ambient = 0.6f * (s.diffuse * hemisphere) + share * mirrored;
    color =
        glm_from(at.point.emissive + TraceVec(direct(ray, here)) + at.point.occlusion * ambient);
  }
  color *= alpha;

  if (through == glm::vec3(0.0f)) return {color, 1.0f};
  if (bends) {
    const glm::vec3 way = (n_v / eta - behind) * n - v / eta;
    return {color + through * bounced(glm::normalize(way), 3, !ray.inside), 1.0f};
  }
  glm::vec4 rest(0.0f);
  if (ray.passes < kMaxPasses) {
    Ray out = onward(ray.direction, 4);
    out.passes = ray.passes + 1;
    rest = arriving(out);
  }
  const float open = (through.x + through.y + through.z) / 3;
  return {color + through * glm::vec3(rest), 1 - open * (1 - rest.a)};
}

// Light that arrives along a ray.
glm::vec4 LightTracer::arriving(const Ray& ray) const {
  const auto hit = rays_.first_hit(glm::vec3(ray.origin), ray.direction, 0.0f, kUnlimited,
                                   ray.inside ? RaySides::both : RaySides::seen,
                                   ray.of_eye ? objects_ : std::span<const bool>());
  if (!hit) {
    if (ray.of_eye) return glm::vec4(0.0f);
    return {glm_from(model::sky_radiance(sky_, ray.direction.y)), 1.0f};
  }
  // A picture of its own, of one texel.
  PictureRays rays;
  glm::vec3 x, y;
  axes_across(ray.direction, x, y);
  const float width = ray.width / std::max(hit->distance, 1e-6f) + ray.spread;
  rays.first = rays.axis = ray.direction;
  rays.per_x = width * x, rays.per_y = width * y;
  return leaving(ray, surface(*hit, rays, ray.direction, ray.origin));
}

glm::vec4 LightTracer::light(const RayHit& hit, const glm::vec3& way,
                             const TraceSample& sample) const {
  const Surface at = surface(hit, picture_, way, eye_);
  Ray ray;
  const float texel = glm::length(picture_.per_x);
  if (picture_.parallel) {
    ray.direction = picture_.axis;
    ray.width = texel;
  } else {
    ray.direction = (picture_.towards_apex ? -1.0f : 1.0f) * glm::normalize(way);
    ray.spread = texel / glm::length(way);
  }
  ray.of_eye = true;
  ray.key = combine(options_.seed, sample.texel);
  ray.sample = sample.index;
  ray.light_samples = options_.light_samples;
  return leaving(ray, at);
}

}  // namespace rilievo
