#include "rilievo/nailboard/picture_rays.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

RayPolygon all_rays(const ImageWindow& w) {
  RayPolygon polygon;
  polygon.corner[0] = {w.left, w.bottom};
  polygon.corner[1] = {w.right, w.bottom};
  polygon.corner[2] = {w.right, w.top};
  polygon.corner[3] = {w.left, w.top};
  polygon.size = 4;
  return polygon;
}

// Keeps the rays with n.r >= least (Sutherland and Hodgman).
void cut(RayPolygon& polygon, const glm::dvec3& n, double least) {
  std::array<double, 12> above;
  bool all = true;
  for (int i = 0; i < polygon.size; ++i) {
    const glm::dvec2& c = polygon.corner[std::size_t(i)];
    above[std::size_t(i)] = n.x * c.x + n.y * c.y - n.z - least;
    all &= above[std::size_t(i)] >= 0;
  }
  if (all) return;
  RayPolygon kept;
  for (int i = 0; i < polygon.size; ++i) {
    const auto here = std::size_t(i), next = std::size_t((i + 1) % polygon.size);
    const glm::dvec2 &a = polygon.corner[here], &b = polygon.corner[next];
    if (above[here] >= 0) kept.corner[std::size_t(kept.size++)] = a;
    if ((above[here] >= 0) != (above[next] >= 0))
      kept.corner[std::size_t(kept.size++)] =
          a + (b - a) * (above[here] / (above[here] - above[next]));
  }
  polygon = kept;
}

}  // namespace

ViewOfPicture view_of(const Camera& frame, const PictureGeometry& picture,
                      const RigidMotion& motion) {
  // Rows of the frame's axes act on world now; pull them back to the capture's eye space.
  const glm::dmat4 now_from_capture = motion.now_from_then * picture.capture.world_from_eye;
  const glm::dmat3 to_rows = glm::transpose(glm::dmat3(now_from_capture));
  const ImageWindow& w = frame.window;
  ViewOfPicture v;
  v.x = to_rows * glm::dvec3(frame.world_from_eye[0]) * (frame.width / (w.right - w.left));
  v.y = to_rows * glm::dvec3(frame.world_from_eye[1]) * (frame.height / (w.top - w.bottom));
  v.f = to_rows * -glm::dvec3(frame.world_from_eye[2]);
  const glm::dvec3 offset = frame.position() - glm::dvec3(now_from_capture[3]);
  v.eye = glm::inverse(glm::dmat3(now_from_capture)) * offset;
  v.t = glm::dot(v.f, v.eye);
  return v;
}

bool is_rigid(const glm::dmat4& m) {
  const glm::dmat3 axes(m);
  const glm::dmat3 gram = glm::transpose(axes) * axes;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (!(std::abs(gram[c][r] - (c == r ? 1.0 : 0.0)) <= 1e-4)) return false;
  return glm::determinant(axes) > 0;
}

RayPolygon rays_in_frame(const PictureGeometry& picture, const Camera& frame,
                         const ViewOfPicture& view, double front, double back,
                         const glm::dvec2& half) {
  RayPolygon polygon = all_rays(picture.capture.window);
  const ImageWindow& w = frame.window;
  const double px = frame.width / (w.right - w.left), py = frame.height / (w.top - w.bottom);
  // Inside the frame: n.(d r - e) >= least.
  const std::array<glm::dvec3, 5> normals{
      view.x - px * w.left * view.f, px * w.right * view.f - view.x,
      view.y - py * w.bottom * view.f, py * w.top * view.f - view.y, view.f};
  const std::array<double, 5> least{0, 0, 0, 0, frame.z_near};
  for (std::size_t i = 0; i < normals.size() && polygon.size > 0; ++i) {
    const glm::dvec3& n = normals[i];
    // n.r >= (n.e + least) / d: weakest at one end of the depths.
    const double offset = glm::dot(n, view.eye) + least[i];
    const double slack = std::abs(n.x) * half.x + std::abs(n.y) * half.y;
    // A hair for rounding, so that no sample on the frame's border is missed.
    const double hair = 1e-12 * (glm::length(n) + std::abs(offset) / front);
    cut(polygon, n, std::min(offset / front, offset / back) - slack - hair);
  }
  return polygon;
}

}  // namespace rilievo
