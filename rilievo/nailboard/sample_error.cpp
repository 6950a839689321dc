#include "rilievo/nailboard/sample_error.h"

#include <cmath>

namespace rilievo {

void append_sample_errors(const Nailboard& picture, const Camera& frame, int step,
                          std::vector<float>& errors_px) {
  const Camera& capture = picture.geometry.capture;
  const int bits = picture.geometry.delta_bits;
  const glm::dmat4 frame_clip = clip_from_world(frame);
  // Pixels of a world point, or something outside the frame if it lies behind the eye.
  const auto project = [&](const glm::dvec3& world) {
    const glm::dvec4 clip = frame_clip * glm::dvec4(world, 1);
    if (clip.w <= 0) return glm::dvec2(-1e9);
    return glm::dvec2((0.5 + 0.5 * clip.x / clip.w) * frame.width,
                      (0.5 - 0.5 * clip.y / clip.w) * frame.height);
  };
  for (int y = 0; y < capture.height; y += step)
    for (int x = 0; x < capture.width; x += step) {
      if (picture.delta(x, y) == delta_transparent(bits) || picture.color(x, y).a == 0) continue;
      const glm::dvec2 raster(x + 0.5, y + 0.5);
      const glm::dvec2 drawn =
          project(world_from_raster(capture, raster, picture.geometry.plane_z));
      if (drawn.x < 0 || drawn.y < 0 || drawn.x > frame.width || drawn.y > frame.height) continue;
      const double eye_z =
          eye_z_from(DepthKind::window_z, decode_delta(picture.delta(x, y), bits), capture, raster);
      const glm::dvec2 truth = project(world_from_raster(capture, raster, eye_z));
      errors_px.push_back(float(glm::length(drawn - truth)));
    }
}

}  // namespace rilievo
