#include "rilievo/nailboard/sample_error.h"

#include <cmath>
#include <limits>

namespace rilievo {

void append_sample_errors(const Nailboard& picture, const Camera& frame, int step,
                          std::vector<float>& errors_px) {
  const Camera& capture = picture.geometry.capture;
  const int bits = picture.geometry.delta_bits;
  const glm::dmat4 frame_clip = clip_from_world(frame);
  struct Place {
    glm::dvec2 px{0.0};
    bool in_front = false, inside = false;  // of the near plane; the frame
  };
  const auto project = [&](const glm::dvec3& world) {
    const glm::dvec4 clip = frame_clip * glm::dvec4(world, 1);
    Place place;
    place.in_front = clip.w >= frame.z_near;
    if (!place.in_front) return place;
    place.px = {(0.5 + 0.5 * clip.x / clip.w) * frame.width,
                (0.5 - 0.5 * clip.y / clip.w) * frame.height};
    place.inside = place.px.x >= 0 && place.px.y >= 0 && place.px.x <= frame.width &&
                   place.px.y <= frame.height;
    return place;
  };
  for (int y = 0; y < capture.height; y += step)
    for (int x = 0; x < capture.width; x += step) {
      if (picture.delta(x, y) == delta_transparent(bits) || picture.color(x, y).a == 0) continue;
      const glm::dvec2 raster(x + 0.5, y + 0.5);
      const Place drawn = project(world_from_raster(capture, raster, picture.geometry.plane_z));
      const double eye_z =
          eye_z_from(DepthKind::window_z, decode_delta(picture.delta(x, y), bits), capture, raster);
      const Place truth = project(world_from_raster(capture, raster, eye_z));
      if (!drawn.inside && !truth.inside) continue;
      errors_px.push_back(drawn.in_front && truth.in_front
                              ? float(glm::length(drawn.px - truth.px))
                              : std::numeric_limits<float>::infinity());
    }
}

}  // namespace rilievo
