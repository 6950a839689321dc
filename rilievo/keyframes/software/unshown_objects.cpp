#include "rilievo/keyframes/software/unshown_objects.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <iterator>

#include "rilievo/core/box_distance.h"
#include "rilievo/core/box_view.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// Of one object, at most; and of so many pixels for each ray one is expected to be of use.
constexpr int kMostRays = 64, kTries = 4;
// An object that fills fewer pixels is not looked for.
constexpr double kLeastPixels = 16;

// All of them if nothing moves.
std::vector<std::uint32_t> still_objects(const Scene& scene) {
  std::vector<std::uint32_t> objects;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i)
    if (!scene.objects[i].moving) objects.push_back(i);
  return objects;
}

}  // namespace

UnshownObjects::UnshownObjects(const PlacedScene& placed, const RayScene& rays, double triangles)
    : placed_(placed),
      rays_(rays),
      still_(placed.scene(), still_objects(placed.scene())),
      triangles_(triangles) {}

std::span<const std::uint32_t> UnshownObjects::begin(const Camera& frame,
                                                     std::span<const WarpedKeyframe> keyframes,
                                                     std::span<const std::uint32_t> objects) {
  frame_ = frame;
  shown_.clear(), hidden_before_.swap(hidden_), hidden_.clear(), grown_.clear();
  for (const WarpedKeyframe& one : keyframes) {
    scratch_.clear();
    std::ranges::set_union(shown_, one.keyframe->shown, std::back_inserter(scratch_));
    shown_.swap(scratch_);
  }
  std::ranges::set_difference(objects, shown_, std::back_inserter(hidden_));
  // What blends is in no keyframe.
  std::erase_if(hidden_, [&](std::uint32_t object) { return !placed_.has_opaque_parts(object); });
  const glm::dvec3 eye = frame.position();
  double way = 0;
  for (const WarpedKeyframe& one : keyframes)
    way = std::max(way, glm::distance(one.keyframe->camera.position(), eye));
  for (const std::uint32_t object : objects) {
    const Box& box = placed_.bounds()[object];
    const double distance = distance_to(box, eye);
    // No keyframe's eye was farther from it than that and the way.
    if (distance + way <= kMostGrown * distance) continue;
    double least = HUGE_VAL;
    for (const WarpedKeyframe& one : keyframes)
      if (std::ranges::binary_search(one.keyframe->shown, object))
        least = std::min(least, distance_to(box, one.keyframe->camera.position()));
    if (least < HUGE_VAL && least > kMostGrown * distance) grown_.push_back(object);
  }
  scratch_.clear();
  std::ranges::set_intersection(seen_, hidden_, std::back_inserter(scratch_));
  seen_.swap(scratch_);
  choose();
  return found_;
}

std::span<const std::uint32_t> UnshownObjects::look(const WarpedFrame& warped) {
  pixels_.clear();
  // Those that keyframes showed a frame ago are probably seen.
  scratch_.clear();
  std::ranges::set_difference(hidden_, hidden_before_, std::back_inserter(scratch_));
  look_for(scratch_, 0, kNewRays, warped);
  look_for(hidden_, next_, kRays, warped);
  next_ += kRays;
  if (pixels_.empty()) return {};
  hits_.resize(pixels_.size());
  parallel_for(0, int(pixels_.size()), [&](int i) {
    const std::optional<RayHit> hit = hit_at_pixel(rays_, frame_, pixels_[std::size_t(i)], still_);
    hits_[std::size_t(i)] = hit ? hit->object : kNoObject;
  });
  const std::size_t before = seen_.size();
  for (const std::uint32_t hit : hits_)
    if (hit != kNoObject && std::ranges::binary_search(hidden_, hit - 1)) seen_.push_back(hit - 1);
  std::ranges::sort(seen_);
  seen_.erase(std::unique(seen_.begin(), seen_.end()), seen_.end());
  if (seen_.size() == before) return {};
  choose();
  return found_;
}

// From the first on, around.
void UnshownObjects::look_for(std::span<const std::uint32_t> objects, std::size_t first, int rays,
                              const WarpedFrame& warped) {
  if (objects.empty()) return;
  const std::size_t count = std::min(objects.size(), std::size_t(rays));
  const int each = std::min(rays / int(count), kMostRays);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t object = objects[(first + i) % objects.size()];
    if (!std::ranges::binary_search(seen_, object)) aim(object, each, warped);
  }
}

// Chooses pixels where it may be seen: they show something farther than its nearest place. What is
// in holes will be drawn anyway.
void UnshownObjects::aim(std::uint32_t object, int rays, const WarpedFrame& warped) {
  const BoxView view =
      view_of_box(eye_from_world(frame_), placed_.bounds()[object], Projection::perspective);
  const RasterRect rect = rect_of_box(frame_, view);
  if (rect.empty() || (rect.right - rect.left) * (rect.bottom - rect.top) < kLeastPixels) return;
  const float nearest = view.nearest > frame_.z_near ? float(1 / view.nearest) : HUGE_VALF;
  const auto between = [&](double low, double high, int size) {
    return std::min(int(random_.between(float(low), float(high))), size - 1);
  };
  for (int i = 0; i < kTries * rays && rays > 0; ++i) {
    const int x = between(rect.left, rect.right, frame_.width),
              y = between(rect.top, rect.bottom, frame_.height);
    const std::uint32_t color = warped.color(x, y);
    if (color == 0 || color == kCoveredPixel || warped.inverse_z(x, y) > nearest) continue;
    pixels_.push_back({std::uint16_t(x), std::uint16_t(y)});
    --rays;
  }
}

// The nearest of those that are seen or have grown too much, as many as triangles allow.
void UnshownObjects::choose() {
  chosen_.clear();
  for (const std::vector<std::uint32_t>* list : {&seen_, &grown_})
    for (const std::uint32_t object : *list)
      chosen_.push_back({distance_to(placed_.bounds()[object], frame_.position()), object});
  take_nearest(placed_.scene(), triangles_, chosen_, found_);
  drawn_grown_.clear();
  std::ranges::set_intersection(found_, grown_, std::back_inserter(drawn_grown_));
}

}  // namespace rilievo
