// Cf. [Schaufler 1998], section 3.1 (figure 2: what one back-perspective picture holds) and the
// open question of section 5.
//
// Spacing. A camera's texel covers (dx z)(dy z) of the plane at eye_z = z, dx and dy its extents
// on the plane at 1. The beam through it meets the surface, with normal n, in the area that has
// the same cross-section: with the ray's unit direction r and the axis a,
//
//   area |r.n| = (dx z)(dy z) |r.a|,    spacing = sqrt(area)

#include "bench/analyze_coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo::bench {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
// Rays end this much of the scene's size before the surface, so as not to meet it.
constexpr float kLiftOff = 1e-4f;

// [Vigna 2015, SplitMix64]: one good hash a number.
std::uint64_t hash(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}
double unit(std::uint64_t seed, std::uint64_t index, std::uint64_t dimension) {
  return double(hash(hash(hash(seed) + index) + dimension) >> 11) * 0x1p-53;
}

// Calls visit(object, part, triangle, corners, double_sided) for all triangles in pictures.
template <class Visit>
void for_each_triangle(const RayScene& rays, Visit visit) {
  const Scene& scene = rays.scene();
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const Model& model = scene.models[scene.objects[o].model];
    for (int p = 0; p < int(model.parts.size()); ++p) {
      const Mesh& mesh = scene.meshes[model.parts[p].mesh];
      const std::optional<bool> both = double_sided(scene, model.parts[p].mesh);
      if (!both) continue;
      const glm::mat4 place = rays.poses()[o] * model.parts[p].model_from_mesh;
      const bool mirrors = glm::determinant(glm::mat3(place)) < 0;
      for (std::uint32_t t = 0; t < mesh.triangles(); ++t) {
        glm::dvec3 c[3];
        for (int k = 0; k < 3; ++k)
          c[k] = glm::dvec3(place * glm::vec4(mesh.positions[mesh.indices[3 * t + k]], 1.0f));
        const glm::dvec3 twice = glm::cross(c[1] - c[0], c[2] - c[0]) * (mirrors ? -1.0 : 1.0);
        visit(model.parts[p].mesh, t, c, twice, *both);
      }
    }
  }
}

bool masked_out(const Scene& scene, int mesh, std::uint32_t triangle, const glm::vec2& at) {
  const int material = scene.meshes[mesh].material;
  return material >= 0 && scene.materials[material].alpha_mode == AlphaMode::mask &&
         base_color_at(scene, mesh, triangle, at).a < scene.materials[material].alpha_cutoff;
}

}  // namespace

std::vector<SurfacePoint> spread_points(const RayScene& rays, const CoverageOptions& options) {
  double area = 0;
  for_each_triangle(rays, [&](int, std::uint32_t, const glm::dvec3*, const glm::dvec3& twice,
                              bool both) { area += (both ? 1.0 : 0.5) * glm::length(twice); });
  // One point in each of `points` equal stretches of the area laid out in a row.
  std::vector<SurfacePoint> points;
  double passed = 0;
  std::uint64_t next = 0;
  const auto place_of_next = [&] {
    return (double(next) + unit(options.seed, next, 0)) * area / options.points;
  };
  for_each_triangle(rays, [&](int mesh, std::uint32_t triangle, const glm::dvec3* c,
                              const glm::dvec3& twice, bool both) {
    const double length = glm::length(twice);
    passed += (both ? 1.0 : 0.5) * length;
    for (; next < std::uint64_t(options.points) && place_of_next() < passed; ++next) {
      const double root = std::sqrt(unit(options.seed, next, 1)), v = unit(options.seed, next, 2);
      const glm::dvec2 at{root * (1 - v), root * v};
      if (masked_out(rays.scene(), mesh, triangle, at)) continue;
      const double side = both && unit(options.seed, next, 3) < 0.5 ? -1.0 : 1.0;
      points.push_back({glm::vec3(c[0] + at.x * (c[1] - c[0]) + at.y * (c[2] - c[0])),
                        glm::vec3(twice * (side / length))});
    }
  });
  return points;
}

std::vector<glm::dvec3> spread_directions(int count) {
  std::vector<glm::dvec3> directions(count);
  for (int i = 0; i < count; ++i) {
    const double y = 1 - (2 * i + 1) / double(count), r = std::sqrt(1 - y * y);
    const double angle = 2 * std::numbers::pi * i / std::numbers::phi;
    directions[i] = {r * std::cos(angle), y, r * std::sin(angle)};
  }
  return directions;
}

double sample_spacing(const RayScene& rays, const Camera& camera, const SurfacePoint& point) {
  const glm::dvec3 position(point.position), normal(point.normal);
  const glm::dvec3 raster = raster_from_world(camera, position);
  if (!(raster.z >= camera.z_near && raster.z <= camera.z_far && raster.x >= 0 && raster.y >= 0 &&
        raster.x <= camera.width && raster.y <= camera.height))
    return kNever;
  // Towards where the picture is seen from.
  const glm::dvec3 ray = glm::normalize(position - camera.position());
  const glm::dvec3 out = camera.keeps_farthest() ? ray : -ray;
  const double facing = glm::dot(normal, out);
  if (facing <= 0) return kNever;
  const double axis = glm::dot(ray, camera.forward());
  // From there: what is single-sided hides nothing behind its back.
  const double distance = camera.keeps_farthest() ? (camera.z_far - raster.z) / axis
                                                  : (raster.z - camera.z_near) / axis;
  const double lift = kLiftOff * camera.z_far;
  if (distance > lift && rays.occluded(glm::vec3(position + distance * out), glm::vec3(-out), 0.0f,
                                       float(distance - lift)))
    return kNever;
  const double dx = (camera.window.right - camera.window.left) / camera.width;
  const double dy = (camera.window.top - camera.window.bottom) / camera.height;
  return std::sqrt(dx * dy * raster.z * raster.z * axis / facing);
}

Coverage analyze_coverage(const RayScene& rays, std::span<const Camera> cameras,
                          const CoverageOptions& options) {
  RILIEVO_EXPECTS(options.points >= 1 && options.viewpoints >= 1);
  const std::vector<SurfacePoint> points = spread_points(rays, options);
  Box bounds;
  for (std::size_t o = 0; o < rays.poses().size(); ++o)
    bounds.add(
        transformed(rays.poses()[o], rays.scene().models[rays.scene().objects[o].model].bounds));
  Coverage coverage;
  coverage.radius = bounds.radius();
  const float lift = kLiftOff * bounds.radius();
  std::vector<glm::vec3> viewpoints;
  for (const glm::dvec3& d : spread_directions(options.viewpoints))
    viewpoints.push_back(bounds.center() +
                         glm::vec3(d * (options.viewpoint_radii * coverage.radius)));

  struct Found {
    int viewpoints = 0;
    int pictures = 0;
    double spacing = kNever;
  };
  std::vector<Found> found(points.size());
  parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
    const SurfacePoint& point = points[i];
    for (const glm::vec3& viewpoint : viewpoints) {
      const glm::vec3 to = viewpoint - point.position;
      const float distance = glm::length(to);
      if (glm::dot(point.normal, to) <= 0) continue;
      if (rays.occluded(viewpoint, -to / distance, 0.0f, distance - lift)) continue;
      ++found[i].viewpoints;
    }
    if (found[i].viewpoints == 0) return;
    for (const Camera& camera : cameras) {
      const double spacing = sample_spacing(rays, camera, point);
      found[i].pictures += spacing < kNever;
      found[i].spacing = std::min(found[i].spacing, spacing);
    }
  });

  std::size_t visible = 0, once = 0, twice = 0, seen = 0, seen_covered = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (found[i].viewpoints == 0) continue;
    ++visible;
    seen += std::size_t(found[i].viewpoints);
    seen_covered += found[i].pictures >= 1 ? std::size_t(found[i].viewpoints) : 0;
    once += found[i].pictures >= 1;
    twice += found[i].pictures >= 2;
    coverage.spacing.push_back(float(found[i].spacing));
    if (found[i].pictures == 0) coverage.missed.push_back(points[i]);
  }
  std::sort(coverage.spacing.begin(), coverage.spacing.end());
  if (points.empty() || visible == 0) return coverage;
  coverage.visible_share = double(visible) / double(points.size());
  coverage.covered_share = double(once) / double(visible);
  coverage.covered_seen_share = double(seen_covered) / double(seen);
  coverage.covered_twice_share = double(twice) / double(visible);
  return coverage;
}

double share_within(const Coverage& coverage, double spacing) {
  if (coverage.spacing.empty()) return 0;
  const auto end = std::upper_bound(coverage.spacing.begin(), coverage.spacing.end(), spacing);
  return double(end - coverage.spacing.begin()) / double(coverage.spacing.size());
}

}  // namespace rilievo::bench
