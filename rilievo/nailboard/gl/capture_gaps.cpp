#include "rilievo/nailboard/gl/capture_gaps.h"

#include "rilievo/capture/gl/capture_picture.h"
#include "rilievo/nailboard/raster_gaps.h"

namespace rilievo {

GapTable capture_gaps(SceneRenderer& renderer, CaptureWithoutOpenGL* capturer, const Camera& camera,
                      std::span<const std::uint32_t> objects) {
  if (capturer) return raster_gaps(*capturer, camera, objects, renderer.poses());
  const Result<Image<float>> nearest = capture_nearest(renderer, camera, objects);
  const Result<Image<float>> farthest = capture_farthest(renderer, camera, objects);
  if (!nearest.ok() || !farthest.ok()) return unknown_gaps(camera);
  return make_gap_table(*nearest, *farthest);
}

}  // namespace rilievo
