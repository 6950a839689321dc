#include "rilievo/render/shading/stroke_points.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

glm::dvec3 placed(const SurfacePlacement& placement, const glm::vec3& p) {
  return glm::dvec3(glm::dmat4(placement.relative_from_mesh) * glm::dvec4(p, 1));
}

// The place in the raster, and the distance along the axis.
glm::dvec3 in_raster(const PictureRays& rays, const glm::dvec3& p) {
  const double z = glm::dot(p, glm::dvec3(rays.axis));
  const glm::dvec3 per_x(rays.per_x), per_y(rays.per_y);
  const glm::dvec3 off = (rays.parallel ? p : p / z) - glm::dvec3(rays.first);
  return {glm::dot(off, per_x) / glm::dot(per_x, per_x),
          glm::dot(off, per_y) / glm::dot(per_y, per_y), z};
}

// The ray's point at a distance along the axis.
glm::vec3 at_depth(const PictureRays& rays, const glm::vec3& ray, double z) {
  const glm::dvec3 axis(rays.axis), through(ray);
  return glm::vec3(rays.parallel ? through + (z - glm::dot(through, axis)) * axis
                                 : z / glm::dot(through, axis) * through);
}

StrokePoint line_at(const PictureRays& rays, const glm::vec3& ray, const Mesh& mesh,
                    const SurfacePlacement& placement, const std::uint32_t* ends) {
  StrokePoint out;
  std::copy_n(ends, 2, out.vertex);
  glm::dvec3 p[2] = {placed(placement, mesh.positions[ends[0]]),
                     placed(placement, mesh.positions[ends[1]])};
  double from = 0, to = 1;  // what of it lies before the eye
  const glm::dvec3 axis(rays.axis);
  if (!rays.parallel) {
    const double z[2] = {glm::dot(p[0], axis), glm::dot(p[1], axis)};
    const double least = 1e-6 * std::max(z[0], z[1]);
    if (z[0] < least) from = (least - z[0]) / (z[1] - z[0]);
    if (z[1] < least) to = (least - z[0]) / (z[1] - z[0]);
    const glm::dvec3 along = p[1] - p[0], first = p[0];
    p[0] = first + from * along, p[1] = first + to * along;
  }
  const glm::dvec3 a = in_raster(rays, p[0]), b = in_raster(rays, p[1]);
  const glm::dvec3 at = in_raster(rays, glm::dvec3(ray));
  const glm::dvec2 along = glm::dvec2(b) - glm::dvec2(a);
  const double length2 = glm::dot(along, along);
  double s = length2 > 1e-12 ? glm::dot(glm::dvec2(at) - glm::dvec2(a), along) / length2 : 0;
  s = std::clamp(s, 0.0, 1.0);
  double z;
  if (rays.parallel) {
    z = a.z + s * (b.z - a.z);
  } else {  // 1 / z is what is affine in the raster
    const double of_a = (1 - s) / a.z, of_b = s / b.z;
    z = 1 / (of_a + of_b);
    s = of_b * z;
  }
  out.share = float(from + s * (to - from));
  out.relative = at_depth(rays, ray, z);
  return out;
}

}  // namespace

StrokePoint stroke_at(const PictureRays& rays, const glm::vec3& ray, const Mesh& mesh,
                      const SurfacePlacement& placement, std::uint32_t index) {
  RILIEVO_EXPECTS(mesh.primitive != Primitive::triangles);
  if (mesh.primitive == Primitive::lines)
    return line_at(rays, ray, mesh, placement, &mesh.indices[2 * std::size_t(index)]);
  const std::uint32_t vertex = mesh.indices[index];
  const glm::dvec3 centre = placed(placement, mesh.positions[vertex]);
  StrokePoint out;
  out.vertex[0] = out.vertex[1] = vertex;
  const double towards = glm::dot(glm::dvec3(ray), centre);
  if (rays.parallel || mesh.width <= 0 || towards <= 0)
    out.relative = at_depth(rays, ray, glm::dot(centre, glm::dvec3(rays.axis)));
  else
    out.relative = glm::vec3(glm::dot(centre, centre) / towards * glm::dvec3(ray));
  return out;
}

FacingCorners facing_corners(const PictureRays& rays, const glm::vec3& relative) {
  const glm::vec3 along = rays.parallel ? rays.axis : relative / glm::length(relative);
  const glm::vec3 other = std::abs(along.y) < 0.7f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const float size = 0.5f * std::max(glm::length(relative), 1e-6f);
  const glm::vec3 x = size * glm::normalize(glm::cross(along, other)), y = glm::cross(x, along);
  return {{relative + x, relative - 0.5f * x + 0.8f * y, relative - 0.5f * x - 0.8f * y}};
}

SurfacePlacement unplaced(const SurfacePlacement& placement) {
  SurfacePlacement out = placement;
  out.relative_from_mesh = glm::mat4(1.0f);
  if (!placement.code_from_position) return out;
  const glm::dmat4 m(placement.relative_from_mesh);
  const glm::dmat3 inverse = glm::inverse(glm::dmat3(m));
  const glm::mat4x3& code = *placement.code_from_position;
  const glm::dmat3 turned =
      glm::dmat3(glm::dvec3(code[0]), glm::dvec3(code[1]), glm::dvec3(code[2])) * inverse;
  const glm::dvec3 origin = glm::dvec3(code[3]) - turned * glm::dvec3(m[3]);
  // A flat placement has no inverse, and shows no code.
  if (!std::isfinite(glm::dot(origin, origin))) return out;
  out.code_from_position = glm::mat4x3(glm::vec3(turned[0]), glm::vec3(turned[1]),
                                       glm::vec3(turned[2]), glm::vec3(origin));
  return out;
}

}  // namespace rilievo
