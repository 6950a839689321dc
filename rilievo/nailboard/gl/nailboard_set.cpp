#include "rilievo/nailboard/gl/nailboard_set.h"

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Triangles that cost as much, on a software rasteriser with four samples a pixel: a pixel of a
// picture 5 ns, a triangle 280 ns.
constexpr CostTerms kCost{10, 0.02};

}  // namespace

Result<std::unique_ptr<NailboardSet>> NailboardSet::create(const AtlasOptions& options,
                                                           DepthMode mode) {
  Result<NailboardAtlas> atlas = NailboardAtlas::create(options);
  if (!atlas) return atlas.error();
  Result<NailboardDrawer> drawer = NailboardDrawer::create();
  if (!drawer) return drawer.error();
  return {
      std::unique_ptr<NailboardSet>(new NailboardSet(std::move(*atlas), std::move(*drawer), mode))};
}

void NailboardSet::set_item(std::uint32_t item, const AtlasSlot& slot,
                            const PictureGeometry& geometry) {
  if (item >= items_.size()) items_.resize(item + 1);
  items_[item] = {slot, geometry};
}

void NailboardSet::place(std::span<const Instance> instances) {
  placed_.clear();
  for (const Instance& instance : instances) {
    RILIEVO_EXPECTS(instance.item < items_.size());
    const Item& item = items_[instance.item];
    placed_.push_back({item.slot, item.geometry, instance.world_from_capture, instance.object,
                       instance.from, instance.to, instance.partner});
  }
}

void NailboardSet::draw(const Camera& frame, std::span<const Instance> instances, Output output) {
  place(instances);
  if (output == Output::color)
    drawer_.draw(atlas_, frame, mode_, placed_);
  else
    drawer_.draw_objects(atlas_, frame, mode_, placed_);
}

void NailboardSet::draw_outlines(const Camera& frame, std::span<const Instance> instances) {
  place(instances);
  drawer_.draw_outlines(frame, placed_);
}

ErrorModel NailboardSet::error_model(std::uint32_t item) const {
  return nailboard_error_model(items_[item].geometry);
}

CostTerms NailboardSet::cost_terms(std::uint32_t) const { return kCost; }

std::vector<DepthImage> NailboardSet::read_pictures(const Instance& instance) const {
  const Item& item = items_[instance.item];
  std::vector<DepthImage> read{depth_image_from(atlas_.read(item.slot, item.geometry))};
  Camera& camera = read.front().camera;
  if (instance.world_from_capture != glm::dmat4(1.0))
    camera.world_from_eye = instance.world_from_capture * camera.world_from_eye;
  return read;
}

}  // namespace rilievo
