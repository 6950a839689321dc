#include "rilievo/capture/coarse_capture.h"

#include <utility>

namespace rilievo {

Result<std::unique_ptr<CoarseCapture>> CoarseCapture::create(const Scene& scene) {
  Result<RayScene> rays = RayScene::create(scene);
  if (!rays) return rays.error();
  return {std::unique_ptr<CoarseCapture>(new CoarseCapture(std::move(*rays)))};
}

}  // namespace rilievo
