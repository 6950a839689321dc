#include "rilievo/nailboard/gl/atlas_pictures.h"

#include <optional>
#include <string>
#include <utility>

#include "rilievo/nailboard/gl/nailboard_set.h"

namespace rilievo {

Result<PictureSet> make_atlas_pictures(std::span<const DepthImage> pictures, DepthMode mode,
                                       int delta_bits) {
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
  Result<std::unique_ptr<NailboardSet>> set = NailboardSet::create({bytes, delta_bits, 1}, mode);
  if (!set) return set.error();
  PictureSet stored;
  NailboardAtlas& atlas = (*set)->atlas();
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Nailboard board = make_nailboard(pictures[i], delta_bits);
    const auto slot = atlas.allocate(board.color.width(), board.color.height());
    if (!slot) return Error{pictures[i].name, "does not fit beside the other pictures"};
    atlas.write(*slot, board);
    PictureGeometry geometry = board.geometry;
    atlas.narrow(*slot, geometry);
    const auto item = std::uint32_t(i);
    (*set)->set_item(item, *slot, geometry);
    stored.instances.push_back({glm::dmat4(1.0), item, only_object(pictures[i], item + 1)});
  }
  stored.drawable = std::move(*set);
  return stored;
}

}  // namespace rilievo
