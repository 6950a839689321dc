#include "rilievo/nailboard/software/software_nailboard_set.h"

#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/nailboard/error_model.h"

namespace rilievo {

void SoftwareNailboardSet::set_item(std::uint32_t item, const SoftwareNailboard& picture,
                                    const PictureGeometry& geometry) {
  if (item >= items_.size()) items_.resize(item + 1);
  items_[item] = {&picture, geometry};
}

void SoftwareNailboardSet::keep_item(std::uint32_t item, SoftwareNailboard picture,
                                     const PictureGeometry& geometry) {
  kept_.push_back(std::move(picture));
  set_item(item, kept_.back(), geometry);
}

void SoftwareNailboardSet::place(std::span<const Instance> instances) {
  placed_.clear();
  for (const Instance& instance : instances) {
    RILIEVO_EXPECTS(instance.item < items_.size());
    const Item& item = items_[instance.item];
    placed_.push_back({item.picture, item.geometry, instance.world_from_capture, instance.object,
                       instance.from, instance.to});
  }
}

void SoftwareNailboardSet::draw(const Camera& frame, std::span<const Instance> instances, Output) {
  place(instances);
  composer_.place(frame, mode_, placed_);
}

void SoftwareNailboardSet::draw_outlines(const Camera& frame, std::span<const Instance> instances) {
  place(instances);
  place_outlines(frame, placed_, outlines_);
}

ErrorModel SoftwareNailboardSet::error_model(std::uint32_t item) const {
  return nailboard_error_model(items_[item].geometry);
}

CostTerms SoftwareNailboardSet::cost_terms(std::uint32_t) const {
  // Of a picture's pixel 1 ns, of a triangle 280 ns: see CacheOptions::cost.
  return {10, 0.004};
}

std::size_t SoftwareNailboardSet::bytes() const {
  std::size_t bytes = 0;
  for (const Item& item : items_) bytes += item.picture ? item.picture->bytes() : 0;
  return bytes;
}

std::vector<DepthImage> SoftwareNailboardSet::read_pictures(const Instance& instance) const {
  const Item& item = items_[instance.item];
  std::vector<DepthImage> read{depth_image_from(item.picture->copy(item.geometry))};
  Camera& camera = read.front().camera;
  if (instance.world_from_capture != glm::dmat4(1.0))
    camera.world_from_eye = instance.world_from_capture * camera.world_from_eye;
  return read;
}

}  // namespace rilievo
