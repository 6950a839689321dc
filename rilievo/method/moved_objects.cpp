#include "rilievo/method/moved_objects.h"

namespace rilievo {

MovedObjects::MovedObjects(const Scene& scene) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    if (scene.objects[i].moving) moving_.push_back(std::uint32_t(i));
  faded_.resize(moving_.size());
  boxes_.reserve(moving_.size());
  if (!moving_.empty()) placed_.emplace(scene);
}

void MovedObjects::begin_fade(double time, bool mixed) {
  if (placed_) placed_->set_time(time);
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    const Box before = faded_[i].bounds;
    faded_[i] = {placed_->poses()[moving_[i]], placed_->bounds()[moving_[i]]};
    if (mixed) faded_[i].bounds.add(before);
  }
}

std::span<const Box> MovedObjects::since(double time) {
  boxes_.clear();
  if (placed_) placed_->set_time(time);
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    const Box &bounds = placed_->bounds()[moving_[i]], &before = faded_[i].bounds;
    const bool stands = placed_->poses()[moving_[i]] == faded_[i].pose &&
                        before.min == bounds.min && before.max == bounds.max;
    if (bounds.empty() || stands) continue;
    boxes_.push_back(before);
    boxes_.back().add(bounds);
  }
  return boxes_;
}

}  // namespace rilievo
