#include "rilievo/capture/gl/capture_by.h"

#include "rilievo/gl/context.h"

namespace rilievo {

std::unique_ptr<CaptureWithoutOpenGL> make_capturer(CaptureBy by, const Scene& scene, int samples) {
  if (by == CaptureBy::opengl || (samples != 1 && samples != 4)) return nullptr;
  if (by == CaptureBy::automatic && !gl::is_software()) return nullptr;
  return std::make_unique<CaptureWithoutOpenGL>(scene, samples);
}

}  // namespace rilievo
