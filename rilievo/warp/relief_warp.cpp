// Cf. [Oliveira, Bishop, McAllister 2000] and [Parilov, Stuerzlinger 2002, section 2].
//
// With c = origin - eye, write f in the basis a, b, c: f = k1 a + k2 b + k3 c. Then
//
//   origin + u a + v b + d f - eye = (1 + k3 d) c + (u + k1 d) a + (v + k2 d) b
//
// which is (1 + k3 d) times the ray from the eye to the point (u', v') of the plane d = 0, with u'
// and v' as in the header. The k follow by Cramer's rule.
//
// Of a perspective relief, write eye - origin = k1 a + k2 b + k3 f. Then, with d = -1 / z,
//
//   origin + z (f + u a + v b) - eye = z ((1 + k3 d) f + (u + k1 d) a + (v + k2 d) b)
#include "rilievo/warp/relief_warp.h"

namespace rilievo {

ReliefFrame relief_frame(const Camera& camera, double plane_z) {
  RILIEVO_EXPECTS(camera.projection != Projection::back_perspective);
  ReliefFrame frame;
  frame.perspective = camera.projection == Projection::perspective;
  frame.origin = frame.perspective ? camera.position() : world_from_raster(camera, {0, 0}, plane_z);
  frame.a = glm::dvec3(camera.world_from_eye[0]) *
            ((camera.window.right - camera.window.left) / camera.width);
  frame.b = glm::dvec3(camera.world_from_eye[1]) *
            ((camera.window.bottom - camera.window.top) / camera.height);
  frame.f = camera.forward();
  if (frame.perspective) frame.f = world_from_raster(camera, {0, 0}, 1) - camera.position();
  return frame;
}

std::optional<ReliefWarp> relief_warp(const ReliefFrame& frame, const glm::dvec3& eye) {
  const auto& [origin, a, b, f, perspective] = frame;
  const glm::dvec3 c = origin - eye;
  const double volume = glm::dot(glm::cross(a, b), c), unit = glm::dot(glm::cross(a, b), f);
  if (perspective) {
    const double k3 = -volume / unit;
    // An eye that has moved neither ahead nor back has its epipole infinitely far aside.
    return ReliefWarp{-glm::dot(c, glm::cross(b, f)) / unit, -glm::dot(c, glm::cross(f, a)) / unit,
                      k3 == 0 ? 1e-30 : k3};
  }
  // Both have the sign of f's side of the plane, however a and b are turned.
  if (!(volume * unit > 0)) return std::nullopt;
  return ReliefWarp{glm::dot(f, glm::cross(b, c)) / glm::dot(a, glm::cross(b, c)),
                    glm::dot(f, glm::cross(c, a)) / glm::dot(b, glm::cross(c, a)), unit / volume};
}

}  // namespace rilievo
