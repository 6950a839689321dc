// Lines of sight hit a flat face in a lattice. The points of the plane that are farthest from a
// lattice are the centres of the circles through the corners of its triangles, the ones that two
// shortest vectors a and b span:
//
//   r = |a| |b| |a - b| / (2 |a x b|)          where a.b >= 0
#include "rilievo/layered_relief/hits_on_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rilievo {
namespace {

// Where a camera's lines of sight hit a face through the origin: how far from the nearest hit is a
// point of the face, at most?
double farthest_from_lattice(const Camera& camera, const glm::dvec3& normal) {
  const glm::dvec3 forward = camera.forward();
  const glm::dvec2 texel((camera.window.right - camera.window.left) / camera.width,
                         (camera.window.top - camera.window.bottom) / camera.height);
  const auto hit = [&](const glm::dvec3& aside) {
    return aside - forward * (glm::dot(aside, normal) / glm::dot(forward, normal));
  };
  glm::dvec3 a = hit(texel.x * glm::dvec3(camera.world_from_eye[0]));
  glm::dvec3 b = hit(texel.y * glm::dvec3(camera.world_from_eye[1]));
  // The shortest two vectors that span the lattice (Lagrange, Gauss).
  for (;;) {
    if (glm::dot(a, a) > glm::dot(b, b)) std::swap(a, b);
    const double times = std::round(glm::dot(a, b) / glm::dot(a, a));
    if (times == 0) break;
    b -= times * a;
  }
  if (glm::dot(a, b) < 0) b = -b;
  return glm::length(a) * glm::length(b) * glm::distance(a, b) /
         (2 * glm::length(glm::cross(a, b)));
}

}  // namespace

double farthest_from_hits(std::span<const Camera> cameras) {
  // Normals in a spiral over half of the sphere; each other one is within kSpacing of one of these.
  // As far as that turns a face, its hits move along their lines of sight, by the change of the
  // face's slope.
  constexpr int kCount = 100'000;
  constexpr double kSpacing = 0.01, kGolden = 2.39996322972865332;
  constexpr double kLeastFacing = 0.05;  // what is seen at a smaller slant counts as edge-on
  double farthest = 0;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (i + 0.5) / kCount, r = std::sqrt(1 - z * z), turn = kGolden * i;
    const glm::dvec3 normal(r * std::cos(turn), r * std::sin(turn), z);
    double least = std::numeric_limits<double>::infinity();
    for (const Camera& camera : cameras) {
      const double facing = std::abs(glm::dot(camera.forward(), normal)) - kSpacing;
      if (facing < kLeastFacing) continue;
      least = std::min(least,
                       farthest_from_lattice(camera, normal) * (1 + kSpacing / (facing * facing)));
    }
    farthest = std::max(farthest, least);
  }
  return farthest;
}

}  // namespace rilievo
