#include "rilievo/capture/shaders/field_shader.h"

#include "rilievo/capture/shaders/refine_picture.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/shading/shading_model.h"

namespace rilievo {
namespace {

namespace field_model = shading_model;

// In units of the field: a ray ends so near to the surface; a shadow's ray starts so far from it.
constexpr double kFieldPrecision = 1e-6, kFieldOffset = 1e-4;
// Normals are differences over so much.
constexpr double kFieldNormalStep = 1e-5;

// The rays of one picture, in the field's own space.
class FieldRays final : public RayShader {
 public:
  FieldRays(const DistanceField& field, const FieldLook& look, const Light& sun,
            const Camera& camera)
      : field_(field), look_(look), sun_(sun), camera_(camera), rays_(picture_rays(camera)) {}

  [[nodiscard]] std::optional<Seen> nearest(const glm::dvec2& raster) const override {
    const CameraRay ray = camera_ray(camera_, raster);
    const double t = along(ray.origin, ray.direction);
    if (t < 0) return std::nullopt;
    return Seen{float(ray.eye_z_start + t * ray.eye_z_step), 1};
  }

  [[nodiscard]] float farthest(const glm::dvec2& raster) const override {
    const glm::dvec3 end = world_from_raster(camera_, raster, camera_.z_far);
    const glm::dvec3 back = world_from_raster(camera_, raster, camera_.z_near) - end;
    const double t = along(end, back);
    return t < 0 ? kNoDepth : float(camera_.z_far + t * (camera_.z_near - camera_.z_far));
  }

  [[nodiscard]] glm::vec4 light(int x, int y, const glm::dvec2& place, int) const override {
    const CameraRay ray = camera_ray(camera_, {x + place.x, y + 1 - place.y});
    const double t = along(ray.origin, ray.direction);
    if (t < 0) return glm::vec4(0.0f);
    const glm::dvec3 world = ray.origin + t * ray.direction, at = own(world);
    const glm::dvec3 n = distance_normal(field_, at, kFieldNormalStep);
    field_model::SurfacePoint<float> point;
    point.base = glm::vec3(look_.base_color);
    point.normal = glm::vec3(n);
    point.relative = glm::vec3(world - camera_.position());
    point.view = view(n, world);
    point.emissive = glm::vec3(0.0f);
    point.roughness = look_.roughness, point.metallic = look_.metallic;
    point.occlusion = point.lit = 1;
    Light sun = sun_;
    const glm::dvec3 to_sun = -glm::dvec3(sun.direction);
    if (trace_field(field_, at + kFieldOffset * n, to_sun, 10, kFieldPrecision) >= 0)
      sun.intensity = glm::vec3(0.0f);
    const auto light =
        field_model::shade_point(SurfaceLights{{&sun, 1}, camera_.position(), Sky{}}, point);
    return {light.x, light.y, light.z, 1.0f};
  }

 private:
  [[nodiscard]] glm::dvec3 own(const glm::dvec3& world) const {
    return (world - look_.center) / look_.scale;
  }
  // The multiple of `way` at which it hits the surface; negative: not within it.
  [[nodiscard]] double along(const glm::dvec3& origin, const glm::dvec3& way) const {
    const double length = glm::length(way);
    const double t =
        trace_field(field_, own(origin), way / length, length / look_.scale, kFieldPrecision);
    return t < 0 ? t : t * look_.scale / length;
  }
  // As surface_at() in shading_model.inl has it.
  [[nodiscard]] glm::vec3 view(const glm::dvec3& n, const glm::dvec3& world) const {
    const glm::dvec3 axis(rays_.axis);
    if (rays_.towards_apex)
      return glm::vec3(glm::normalize(axis + std::max(0.0, 0.17 - glm::dot(n, axis)) * n));
    if (rays_.parallel) return glm::vec3(-axis);
    return glm::vec3(glm::normalize(camera_.position() - world));
  }

  const DistanceField& field_;
  const FieldLook& look_;
  const Light& sun_;
  const Camera& camera_;
  PictureRays rays_;
};

}  // namespace

Box FieldShader::bounds(std::span<const std::uint32_t>) const {
  const glm::vec3 center(look_.center);
  const float scale = float(look_.scale);
  return {center + scale * field_.bounds.min, center + scale * field_.bounds.max};
}

Result<CapturedPicture> FieldShader::capture(const CaptureRequest& request) {
  return refine_picture(FieldRays(field_, look_, sun_, request.camera), request, name());
}

}  // namespace rilievo
