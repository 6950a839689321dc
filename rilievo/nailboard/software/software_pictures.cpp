#include "rilievo/nailboard/software/software_pictures.h"

#include <string>
#include <utility>

#include "rilievo/nailboard/nailboard.h"
#include "rilievo/nailboard/software/software_nailboard_set.h"

namespace rilievo {

Result<PictureSet> make_software_pictures(std::span<const DepthImage> pictures, DepthMode mode,
                                          int delta_bits) {
  constexpr int kMaxSize = 16383;
  auto set = std::make_unique<SoftwareNailboardSet>(mode);
  PictureSet stored;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const DepthImage& picture = pictures[i];
    if (Result<> ok = validate(picture); !ok) return Error{picture.name, ok.error().reason};
    if (picture.camera.projection != Projection::perspective)
      return Error{picture.name, "only perspective pictures can be drawn as nailboards"};
    if (picture.camera.width > kMaxSize || picture.camera.height > kMaxSize)
      return Error{picture.name, "is larger than " + std::to_string(kMaxSize) + " texels a side"};
    const Nailboard board = make_nailboard(picture, delta_bits);
    SoftwareNailboard kept;
    kept.assign(board);
    const auto item = std::uint32_t(i);
    set->keep_item(item, std::move(kept), board.geometry);
    stored.instances.push_back({glm::dmat4(1.0), item, only_object(picture, item + 1)});
  }
  stored.drawable = std::move(set);
  return stored;
}

}  // namespace rilievo
