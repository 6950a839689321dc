#include "rilievo/frame/gl/stored_pictures.h"

#include <string>

namespace rilievo {
namespace {

// The object that a picture shows, if it is but one.
std::uint32_t only_object(const DepthImage& picture, std::uint32_t otherwise) {
  std::uint32_t only = kNoObject;
  for (std::uint32_t object : picture.object.texels()) {
    if (object == kNoObject || object == only) continue;
    if (only != kNoObject) return otherwise;
    only = object;
  }
  return only == kNoObject ? otherwise : only;
}

}  // namespace

Result<StoredPictures> StoredPictures::create(std::span<const DepthImage> pictures,
                                              const StoredPicturesOptions& options) {
  // Whole cells, twice over: first fit leaves gaps.
  std::size_t texels = 0;
  for (const DepthImage& picture : pictures) {
    if (Result<> ok = validate(picture); !ok) return Error{picture.name, ok.error().reason};
    if (picture.camera.projection != Projection::perspective)
      return Error{picture.name, "only perspective pictures can be drawn as nailboards"};
    const int limit = AtlasAllocator::kLayerSize;
    if (picture.camera.width > limit || picture.camera.height > limit)
      return Error{picture.name, "is larger than " + std::to_string(limit) + " texels a side"};
    const auto padded = [](int size) { return std::size_t(size + AtlasAllocator::kCell); };
    texels += 2 * padded(picture.camera.width) * padded(picture.camera.height);
  }
  constexpr std::size_t kLayerTexels =
      std::size_t(AtlasAllocator::kLayerSize) * AtlasAllocator::kLayerSize;
  // Six bytes a texel at most, and the capture buffer.
  const std::size_t bytes = (texels / kLayerTexels + 2) * kLayerTexels * 6 + kLayerTexels * 8;
  Result<PictureAtlas> atlas = PictureAtlas::create({bytes, options.delta_bits, 1});
  if (!atlas) return atlas.error();
  Result<NailboardDrawer> drawer = NailboardDrawer::create();
  if (!drawer) return drawer.error();
  StoredPictures stored(std::move(*atlas), std::move(*drawer));
  stored.options_ = options;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Nailboard board = make_nailboard(pictures[i], options.delta_bits);
    const auto slot = stored.atlas_.allocate(board.color.width(), board.color.height());
    if (!slot) return Error{pictures[i].name, "does not fit beside the other pictures"};
    stored.atlas_.write(*slot, board);
    PictureGeometry geometry = board.geometry;
    stored.atlas_.narrow(*slot, geometry);
    stored.instances_.push_back(
        {*slot, geometry, glm::dmat4(1.0), only_object(pictures[i], std::uint32_t(i + 1))});
  }
  return stored;
}

Result<> StoredPictures::draw(const Camera& camera, double) {
  camera_ = camera;
  drawer_.draw(atlas_, camera, options_.mode, instances_);
  if (options_.outlines) drawer_.draw_outlines(camera, instances_);
  return Done{};
}

Result<> StoredPictures::draw_objects() {
  drawer_.draw_objects(atlas_, camera_, options_.mode, instances_);
  return Done{};
}

FrameFigures StoredPictures::figures() const {
  FrameFigures figures;
  figures.pictures = int(instances_.size());
  figures.picture_bytes = atlas_.bytes();
  return figures;
}

}  // namespace rilievo
