#include "rilievo/frame/software/software_stored_frames.h"

#include <string>
#include <utility>

#include "rilievo/frame/stored_objects.h"
#include "rilievo/nailboard/nailboard.h"
#include "rilievo/nailboard/software/software_nailboard_set.h"

namespace rilievo {

SoftwareStoredFrames::SoftwareStoredFrames(const Scene& sky, int samples,
                                           std::unique_ptr<Drawable> drawable,
                                           std::vector<Instance> instances, bool outlines,
                                           std::unique_ptr<DrawableFactory> factory)
    : SoftwareFrames(sky, samples),
      factory_(std::move(factory)),
      drawable_(std::move(drawable)),
      instances_(std::move(instances)) {
  content().sets.push_back({drawable_.get(), {}});
  outlines_ = outlines;
}

Result<> SoftwareStoredFrames::choose(const Camera&, FrameContent& content, FrameStats& stats) {
  content.sets[0].instances = instances_;
  stats.picture_bytes = drawable_->bytes();
  return Done{};
}

Result<SoftwarePictures> make_software_pictures(std::span<const DepthImage> pictures,
                                                DepthMode mode, int delta_bits) {
  constexpr int kMost = 16383;
  auto set = std::make_unique<SoftwareNailboardSet>(mode);
  SoftwarePictures stored;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const DepthImage& picture = pictures[i];
    if (Result<> ok = validate(picture); !ok) return Error{picture.name, ok.error().reason};
    if (picture.camera.projection != Projection::perspective)
      return Error{picture.name, "only perspective pictures can be drawn as nailboards"};
    if (picture.camera.width > kMost || picture.camera.height > kMost)
      return Error{picture.name, "is larger than " + std::to_string(kMost) + " texels a side"};
    const Nailboard board = make_nailboard(picture, delta_bits);
    SoftwareNailboard kept;
    kept.assign(board);
    const auto item = std::uint32_t(i);
    set->keep_item(item, std::move(kept), board.geometry);
    stored.instances.push_back({glm::dmat4(1.0), item, only_object(picture, item + 1)});
  }
  stored.set = std::move(set);
  return stored;
}

}  // namespace rilievo
