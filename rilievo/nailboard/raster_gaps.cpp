#include "rilievo/nailboard/raster_gaps.h"

#include <vector>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Of window_z, rows from the bottom, 1 where there is nothing.
Image<float> eye_z_of(const std::vector<float>& window_z, const Camera& camera) {
  Image<float> eye_z(camera.width, camera.height);
  const double near = 1 / camera.z_near, per_z = 1 / camera.z_near - 1 / camera.z_far;
  for (int y = 0; y < camera.height; ++y) {
    const float* from =
        window_z.data() + std::size_t(camera.height - 1 - y) * std::size_t(camera.width);
    float* to = eye_z.row(y).data();
    for (int x = 0; x < camera.width; ++x)
      to[x] = from[x] < 1 ? float(1 / (near - double(from[x]) * per_z)) : kNoDepth;
  }
  return eye_z;
}

}  // namespace

GapTable raster_gaps(CaptureWithoutOpenGL& capturer, const Camera& camera,
                     std::span<const std::uint32_t> objects, std::span<const glm::mat4> poses) {
  const RasterPicture& picture = capturer.picture();
  RILIEVO_EXPECTS(picture.width == camera.width && picture.height == camera.height);
  return make_gap_table(eye_z_of(picture.depth, camera),
                        eye_z_of(capturer.capture_farthest(camera, objects, poses), camera));
}

}  // namespace rilievo
