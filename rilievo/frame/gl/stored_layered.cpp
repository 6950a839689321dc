#include "rilievo/frame/gl/stored_layered.h"

#include <span>

namespace rilievo {
namespace {

// If the pictures show but one object, it is this.
std::uint32_t some_object(const LayeredImpostor& impostor) {
  for (const DepthImage& picture : impostor.pictures)
    for (const std::uint32_t object : picture.object.texels())
      if (object != kNoObject) return object;
  return 1;
}

}  // namespace

Result<StoredLayered> StoredLayered::create(LayeredImpostor impostor,
                                            const LayeredOptions& options) {
  const std::uint32_t object = some_object(impostor);
  Result<LayeredPictures> pictures = LayeredPictures::create(std::move(impostor));
  if (!pictures) return pictures.error();
  pictures->keep_only(options.method);
  Result<LayeredDrawer> drawer = LayeredDrawer::create();
  if (!drawer) return drawer.error();
  StoredLayered stored(std::move(*pictures), std::move(*drawer));
  stored.options_ = options;
  stored.instance_.object = object;
  return stored;
}

Result<> StoredLayered::draw(const Camera& camera, double) {
  camera_ = camera;
  drawer_.draw(pictures_, camera, std::span(&instance_, 1), options_);
  return Done{};
}

Result<> StoredLayered::draw_objects() {
  drawer_.draw_objects(pictures_, camera_, std::span(&instance_, 1), options_);
  return Done{};
}

FrameFigures StoredLayered::figures() const {
  FrameFigures figures;
  figures.layered = 1;
  figures.picture_bytes = pictures_.bytes();
  return figures;
}

}  // namespace rilievo
