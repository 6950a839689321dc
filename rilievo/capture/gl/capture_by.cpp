#include "rilievo/capture/gl/capture_by.h"

#include "rilievo/gl/context.h"

namespace rilievo {

std::size_t CaptureWithoutOpenGL::bytes(int size, int samples) {
  return PictureRasterizer::bytes(size, samples);
}

std::unique_ptr<CaptureWithoutOpenGL> CaptureWithoutOpenGL::create(CaptureBy by, const Scene& scene,
                                                                   int samples) {
  if (by == CaptureBy::opengl || (samples != 1 && samples != 4)) return nullptr;
  if (by == CaptureBy::automatic && !gl::is_software()) return nullptr;
  return std::unique_ptr<CaptureWithoutOpenGL>(new CaptureWithoutOpenGL(scene, samples));
}

const RasterPicture& CaptureWithoutOpenGL::capture(const Camera& camera,
                                                   std::span<const std::uint32_t> objects,
                                                   std::span<const glm::mat4> poses) {
  rasterizer_.draw(camera, objects, poses, samples_, picture_);
  return picture_;
}

const std::vector<float>& CaptureWithoutOpenGL::capture_farthest(
    const Camera& camera, std::span<const std::uint32_t> objects,
    std::span<const glm::mat4> poses) {
  rasterizer_.draw_farthest(camera, objects, poses, farthest_);
  return farthest_;
}

}  // namespace rilievo
