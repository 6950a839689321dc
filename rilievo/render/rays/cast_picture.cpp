#include "rilievo/render/rays/cast_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// Light per unit of area that arrives at `position` on a surface with normal `n`.
glm::vec3 irradiance(const Light& light, const glm::vec3& position, const glm::vec3& n) {
  if (light.kind == Light::Kind::directional)
    return light.intensity * std::max(0.0f, -glm::dot(n, light.direction));
  const glm::vec3 to = light.position - position;
  const float distance2 = std::max(glm::dot(to, to), 1e-6f);
  const glm::vec3 l = to / std::sqrt(distance2);
  float strength = 1.0f / distance2;
  if (light.kind == Light::Kind::spot)
    strength *= glm::smoothstep(std::cos(light.outer_cone), std::cos(light.inner_cone),
                                -glm::dot(l, light.direction));
  if (light.range > 0.0f) {
    const float r = distance2 / (light.range * light.range);
    strength *= std::clamp(1.0f - r * r, 0.0f, 1.0f);
  }
  return light.intensity * strength * std::max(0.0f, glm::dot(n, l));
}

}  // namespace

glm::vec4 shade_hit(const RayScene& rays, const RayHit& hit, const glm::vec3& position,
                    const glm::vec3& direction) {
  const Scene& scene = rays.scene();
  const Object& object = scene.objects[hit.object - 1];
  const Part& part = scene.models[object.model].parts[hit.part];
  const Mesh& mesh = scene.meshes[part.mesh];
  const glm::vec3 base(base_color_at(scene, part.mesh, hit.triangle, hit.barycentric));
  if (mesh.material >= 0 && scene.materials[mesh.material].unlit) return {base, 1.0f};

  glm::vec3 n = hit.normal;
  if (!mesh.normals.empty()) {
    const std::uint32_t* corner = &mesh.indices[3 * std::size_t(hit.triangle)];
    const glm::vec3 smooth = (1 - hit.barycentric.x - hit.barycentric.y) * mesh.normals[corner[0]] +
                             hit.barycentric.x * mesh.normals[corner[1]] +
                             hit.barycentric.y * mesh.normals[corner[2]];
    const glm::mat3 world_from_mesh(rays.poses()[hit.object - 1] * part.model_from_mesh);
    const glm::vec3 world = glm::transpose(glm::inverse(world_from_mesh)) * smooth;
    if (glm::dot(world, world) > 0) n = glm::normalize(world);
  }
  // Both sides of a thin sheet are lit as seen; the back of a single-sided surface has no light of
  // its own.
  const bool behind =
      glm::dot(hit.normal, direction) > 0 && !double_sided(scene, part.mesh).value_or(true);
  if (!behind && glm::dot(n, direction) > 0) n = -n;

  glm::vec3 light(0.0f);
  if (scene.lights.empty()) light = irradiance(default_sun(), position, n);
  for (const Light& each : scene.lights) light += irradiance(each, position, n);
  const glm::vec3 hemisphere =
      glm::mix(scene.sky.ground, 0.5f * (scene.sky.zenith + scene.sky.horizon), 0.5f + 0.5f * n.y);
  return {base * (light / std::numbers::pi_v<float> + 0.6f * hemisphere), 1.0f};
}

CameraRay camera_ray(const Camera& camera, const glm::dvec2& raster) {
  const double start = camera.keeps_farthest() ? camera.z_far : camera.z_near;
  const double end = camera.keeps_farthest() ? camera.z_near : camera.z_far;
  const glm::dvec3 origin = world_from_raster(camera, raster, start);
  return {origin, world_from_raster(camera, raster, end) - origin, start, end - start};
}

DepthImage cast_picture(const RayScene& rays, const Camera& camera) {
  DepthImage picture;
  picture.camera = camera;
  picture.color = ColorImage(camera.width, camera.height);
  picture.depth = Image<float>(camera.width, camera.height, kNoDepth);
  picture.object = Image<std::uint32_t>(camera.width, camera.height, kNoObject);
  parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const CameraRay ray = camera_ray(camera, {x + 0.5, y + 0.5});
      const std::optional<RayHit> hit = rays.first_hit(ray.origin, ray.direction, 0.0f, 1.0f);
      if (!hit) continue;
      const glm::vec3 position(ray.origin + double(hit->distance) * ray.direction);
      picture.color(x, y) = shade_hit(rays, *hit, position, glm::normalize(ray.direction));
      picture.depth(x, y) = float(ray.eye_z_start + hit->distance * ray.eye_z_step);
      picture.object(x, y) = hit->object;
    }
  });
  return picture;
}

}  // namespace rilievo
