#include "rilievo/capture/deep_image_source.h"

namespace rilievo {

Box DeepImageSource::bounds(std::span<const std::uint32_t>) const {
  Box box;
  for (const LayeredDepthImage& layers : pictures_) {
    const Camera& camera = layers.camera;
    for (std::size_t i = 0; i + 1 < layers.first.size(); ++i) {
      const glm::dvec2 at(double(i % std::size_t(camera.width)) + 0.5,
                          double(i / std::size_t(camera.width)) + 0.5);
      for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s)
        box.add(glm::vec3(world_from_raster(
            camera, at, eye_z_from(layers.depth_kind, layers.samples[s].depth, camera, at))));
    }
  }
  return box;
}

Result<CapturedPicture> DeepImageSource::capture(const CaptureRequest&) {
  return Error{name_, "is a deep image: no other pictures are taken of it"};
}

}  // namespace rilievo
