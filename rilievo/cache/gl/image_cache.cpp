#include "rilievo/cache/gl/image_cache.h"

#include <algorithm>
#include <chrono>

#include "rilievo/core/expects.h"
#include "rilievo/gl/context.h"
#include "rilievo/gl/state_guard.h"
#include "rilievo/nailboard/sample_error.h"
#include "rilievo/render/draw_list.h"

namespace rilievo {

namespace {

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

}  // namespace

Result<ImageCache> ImageCache::create(SceneRenderer& renderer, const ImageCacheOptions& options) {
  Result<PictureAtlas> atlas = PictureAtlas::create(
      {options.max_bytes, options.delta_bits, options.samples,
       rasterized_scene(options.capture_by, renderer.scene(), options.samples)});
  if (!atlas) return atlas.error();
  Result<NailboardDrawer> drawer = NailboardDrawer::create();
  if (!drawer) return drawer.error();
  ImageCache cache(renderer, std::move(*atlas), std::move(*drawer));
  cache.options_ = options;
  cache.build();
  return cache;
}

void ImageCache::build() {
  const Scene& scene = renderer_.scene();
  std::vector<Box> boxes;
  std::vector<std::uint64_t> triangles;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    if (renderer_.has_blended_parts(i)) blended_.push_back(i);
    if (!renderer_.has_opaque_parts(i)) continue;
    const std::uint64_t count = scene.models[std::size_t(scene.objects[i].model)].triangles;
    if (scene.objects[i].moving) {
      moving_objects_.push_back(i);
      MovingObject moving;
      moving.triangles = count;
      moving.box = renderer_.object_bounds(i);
      moving.world_from_object = glm::dmat4(renderer_.poses()[i]);
      moving_.push_back(moving);
    } else {
      static_objects_.push_back(i);
      boxes.push_back(renderer_.object_bounds(i));
      triangles.push_back(count);
    }
  }
  hierarchy_ = build_hierarchy(boxes, triangles);

  policy_ = atlas_.captures_by_rasterizer() ? rasterized_cache_options() : CacheOptions{};
  policy_.max_texels = atlas_.max_picture_size();
  policy_.texel_cell = AtlasAllocator::kCell;
  policy_.delta_bits = options_.delta_bits;
  policy_.depth_mode = options_.depth_mode;
  policy_.bytes_per_texel = options_.delta_bits > 8 ? 6 : 5;
  // First fit leaves gaps between pictures: plan for less than there is, and refuse what does not
  // fit.
  policy_.memory_bytes = std::uint64_t(atlas_.allocator().layers()) * AtlasAllocator::kLayerSize *
                         AtlasAllocator::kLayerSize * std::uint64_t(policy_.bytes_per_texel);
}

// Where BakedObjects has the index of what is baked of an opaque object.
std::uint32_t& ImageCache::baked_name(std::uint32_t object) {
  const bool moving = renderer_.scene().objects[object].moving;
  const std::vector<std::uint32_t>& objects = moving ? moving_objects_ : static_objects_;
  const auto found = std::lower_bound(objects.begin(), objects.end(), object);
  RILIEVO_EXPECTS(found != objects.end() && *found == object);
  return (moving ? baked_objects_.of_moving
                 : baked_objects_.of_static)[std::size_t(found - objects.begin())];
}

void ImageCache::name_baked() {
  plan_.baked.clear();  // names of before
  baked_objects_.of_static.assign(static_objects_.size(), 0);
  baked_objects_.of_moving.assign(moving_objects_.size(), 0);
  for (std::size_t i = 0; i < baked_objects_.objects.size(); ++i)
    baked_name(baked_objects_.objects[i].object) = std::uint32_t(i + 1);
}

Result<> ImageCache::add_baked(std::vector<ObjectImpostor> impostors,
                               const LayeredOptions& options) {
  RILIEVO_EXPECTS(baked_.empty());
  Result<LayeredDrawer> drawer = LayeredDrawer::create();
  if (!drawer) return drawer.error();
  layered_drawer_ = std::move(*drawer);
  layered_options_ = options;
  for (ObjectImpostor& impostor : impostors) {
    const LayeredImpostor& layered = impostor.pictures.impostor();
    BakedObject baked{impostor.error, impostor.raggedness, 0, layered.bounds};
    if (options.method == LayeredMethod::slices) {
      std::size_t slices = 0;
      for (const std::vector<Slice>& of_view : layered.slices) slices += of_view.size();
      baked.slices = std::max(1, int(slices / layered.slices.size()));
    }
    baked.impostor = std::uint32_t(baked_.size());
    for (const std::uint32_t object : impostor.objects) {
      const std::optional<glm::dmat4> motion = motion_of(impostor, renderer_.poses()[object]);
      if (!motion) continue;
      baked.object = object;
      baked.world_from_impostor = *motion;
      baked_objects_.objects.push_back(baked);
    }
    baked_bytes_ += impostor.pictures.bytes();
    baked_.push_back({std::move(impostor)});
  }
  name_baked();
  return Done{};
}

void ImageCache::update_moving() {
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    const std::uint32_t object = moving_objects_[i];
    const glm::dmat4 now(renderer_.poses()[object]);
    moving_[i].now_from_last = now == moving_[i].world_from_object
                                   ? glm::dmat4(1.0)
                                   : now * glm::inverse(moving_[i].world_from_object);
    moving_[i].world_from_object = now;
    moving_[i].box = renderer_.object_bounds(object);
  }
  for (std::size_t i = 0; i < baked_objects_.objects.size(); ++i) {
    BakedObject& baked = baked_objects_.objects[i];
    if (!renderer_.scene().objects[baked.object].moving) continue;
    const std::optional<glm::dmat4> motion =
        motion_of(baked_[baked.impostor].impostor, renderer_.poses()[baked.object]);
    baked_name(baked.object) = motion ? std::uint32_t(i + 1) : 0;
    if (motion) baked.world_from_impostor = *motion;
  }
}

void ImageCache::objects_of(Entity entity, std::vector<std::uint32_t>& objects) const {
  objects.clear();
  if (entity >= hierarchy_.nodes.size()) {
    objects.push_back(moving_objects_[entity - hierarchy_.nodes.size()]);
    return;
  }
  const HierarchyNode& node = hierarchy_.nodes[entity];
  for (std::uint32_t i = 0; i < node.count; ++i)
    objects.push_back(static_objects_[hierarchy_.order[node.first + i]]);
}

glm::dmat4 ImageCache::motion_since_capture(const Picture& picture) const {
  if (picture.entity < hierarchy_.nodes.size()) return glm::dmat4(1.0);
  const glm::dmat4& now = moving_[picture.entity - hierarchy_.nodes.size()].world_from_object;
  if (now == picture.world_from_object) return glm::dmat4(1.0);
  return now * glm::inverse(picture.world_from_object);
}

void ImageCache::release(std::uint32_t slot) {
  if (slot >= held_.size() || !held_[slot].slot) return;
  atlas_.free(*held_[slot].slot);
  held_[slot].slot.reset();
}

void ImageCache::plan(const Camera& camera) {
  const FrameView view = follow(motion_, camera);
  policy_.error_px = options_.error_px;
  policy_.fade_frames = options_.fade_frames;
  if (options_.capture_ms > 0 && triangles_per_ms_ > 0)
    policy_.capture_triangles = std::uint64_t(options_.capture_ms * triangles_per_ms_);
  plan_frame(hierarchy_, moving_, state_, view, policy_, scratch_, plan_, baked_objects_);
}

void ImageCache::carry_out_captures() {
  for (std::uint32_t slot : plan_.evictions) release(slot);
  if (plan_.captures.empty()) return;
  const auto start = std::chrono::steady_clock::now();
  std::uint64_t triangles = 0;
  for (std::size_t i = 0; i < plan_.captures.size(); ++i) {
    const Capture& capture = plan_.captures[i];
    const Camera& camera = capture.geometry.capture;
    const std::optional<AtlasSlot> slot = atlas_.allocate(camera.width, camera.height);
    if (!slot) {
      refuse_capture(plan_, i, hierarchy_, moving_);
      continue;
    }
    if (capture.slot >= held_.size()) held_.resize(capture.slot + 1);
    Held& held = held_[capture.slot];
    held.slot = slot;
    held.objects_captured = false;
    held.camera = camera;
    objects_of(capture.entity, held.objects);
    atlas_.capture(renderer_, camera, held.objects, *slot);
    triangles += capture.triangles;
    ++figures_.captures;
  }
  for (std::size_t i = 0; i < plan_.captures.size(); ++i)
    if (const Capture& capture = plan_.captures[i]; capture.picture.held)
      if (const auto range = delta_range(atlas_.blocks(*held_[capture.slot].slot)))
        if (!narrow_capture(plan_, i, camera_, *range, policy_)) {
          refuse_capture(plan_, i, hierarchy_, moving_);
          release(capture.slot);
        }
  gl::finish();
  figures_.capture_ms = milliseconds_since(start);
  if (triangles > 0 && figures_.capture_ms > 0) {
    const double now = double(triangles) / figures_.capture_ms;
    // The first measurement includes the driver's warm-up; later ones smooth it away.
    triangles_per_ms_ = triangles_per_ms_ > 0 ? 0.8 * triangles_per_ms_ + 0.2 * now : now;
  }
}

void ImageCache::collect() {
  instances_.clear();
  for (std::size_t i = 0; i < plan_.pictures.size(); ++i) {
    const DrawnPicture& drawn = plan_.pictures[i];
    const Picture& picture = state_.slots[drawn.slot];
    const Held& held = held_[drawn.slot];
    const std::uint32_t object = held.objects.size() == 1 ? held.objects[0] + 1 : kNoObject;
    instances_.push_back({*held.slot, picture.geometry, motion_since_capture(picture), object,
                          drawn.from, drawn.to});
    // A picture that fades in, and then the one that it replaces.
    if (drawn.from > 0 && drawn.to >= 1 && i > 0 && plan_.pictures[i - 1].to == drawn.from &&
        plan_.pictures[i - 1].from <= 0 &&
        state_.slots[plan_.pictures[i - 1].slot].entity == picture.entity) {
      instances_[i].partner = std::uint32_t(i - 1);
      instances_[i - 1].partner = std::uint32_t(i);
    }
  }
  polygons_.clear();
  shares_.clear();
  const auto add = [&](std::uint32_t object, float from, float to) {
    if (from <= 0 && to >= 1)
      polygons_.push_back(object);
    else
      shares_.push_back({object, from, to});
  };
  for (const DrawnObject& drawn : plan_.polygons)
    add(static_objects_[drawn.object], drawn.from, drawn.to);
  for (const DrawnObject& drawn : plan_.moving_polygons)
    add(moving_objects_[drawn.object], drawn.from, drawn.to);
  for (Baked& baked : baked_) baked.instances.clear();
  for (const DrawnBaked& drawn : plan_.baked) {
    const BakedObject& object = baked_objects_.objects[drawn.baked];
    baked_[object.impostor].instances.push_back({object.world_from_impostor, object.object + 1});
  }
}

Result<> ImageCache::draw(const Camera& camera, double time) {
  const gl::StateGuard guard;
  camera_ = camera;
  time_ = time;
  figures_ = {};
  renderer_.set_time(time);
  update_moving();
  plan(camera);
  carry_out_captures();
  commit(plan_, state_);
  collect();

  guard.bind_frame();
  drawer_.draw(atlas_, camera, options_.depth_mode, instances_);
  layered_options_.outlines = options_.outlines;
  for (Baked& baked : baked_)
    if (!baked.instances.empty())
      layered_drawer_->draw(baked.impostor.pictures, camera, baked.instances, layered_options_);
  renderer_.draw_opaque(camera, polygons_, OutputEncoding::srgb);
  renderer_.draw_shares(camera, shares_, OutputEncoding::srgb);
  if (options_.sky) renderer_.draw_sky(camera, OutputEncoding::srgb);
  visible_blended_.clear();
  const Frustum frustum = frustum_of(camera);
  for (std::uint32_t object : blended_)
    if (may_touch(frustum, renderer_.object_bounds(object))) visible_blended_.push_back(object);
  renderer_.draw_blended(camera, visible_blended_, OutputEncoding::srgb);
  if (options_.outlines) drawer_.draw_outlines(camera, instances_);

  figures_.polygons = int(polygons_.size() + shares_.size());
  figures_.pictures = plan_.single;
  figures_.hierarchy = plan_.hierarchy;
  figures_.layered = int(plan_.baked.size());
  figures_.bound_px = plan_.bound_px;
  figures_.picture_bytes = atlas_.bytes() + baked_bytes_;
  return Done{};
}

Result<> ImageCache::draw_objects() {
  const gl::StateGuard guard;
  renderer_.set_time(time_);
  // Identifiers of pictures of several objects, where no probe has asked for them before.
  for (const DrawnPicture& drawn : plan_.pictures) {
    Held& held = held_[drawn.slot];
    if (held.objects.size() == 1 || held.objects_captured) continue;
    atlas_.capture_objects(renderer_, held.camera, held.objects, *held.slot);
    held.objects_captured = true;
  }
  guard.bind_frame();
  drawer_.draw_objects(atlas_, camera_, options_.depth_mode, instances_);
  for (Baked& baked : baked_)
    if (!baked.instances.empty())
      layered_drawer_->draw_objects(baked.impostor.pictures, camera_, baked.instances,
                                    layered_options_);
  renderer_.draw_objects(camera_, polygons_);
  // What fades is there all the while.
  faded_.clear();
  for (const PixelShare& share : shares_) faded_.push_back(share.object);
  std::sort(faded_.begin(), faded_.end());
  faded_.erase(std::unique(faded_.begin(), faded_.end()), faded_.end());
  renderer_.draw_objects(camera_, faded_);
  return Done{};
}

void ImageCache::invalidate() {
  std::vector<std::uint32_t> evictions;
  rilievo::invalidate(state_, evictions);
  for (std::uint32_t slot : evictions) release(slot);
  plan_.baked.clear();
  baked_.clear();
  baked_objects_ = {};
  baked_bytes_ = 0;
}

void ImageCache::invalidate_object(std::uint32_t object) {
  const auto place_in = [&](const std::vector<std::uint32_t>& objects) {
    const auto found = std::lower_bound(objects.begin(), objects.end(), object);
    const bool here = found != objects.end() && *found == object;
    return here ? std::optional(std::uint32_t(found - objects.begin())) : std::nullopt;
  };
  std::vector<std::uint32_t> evictions;
  if (const auto moving = place_in(moving_objects_))
    invalidate_moving(hierarchy_, *moving, state_, evictions);
  else if (const auto still = place_in(static_objects_))
    rilievo::invalidate(hierarchy_, *still, state_, evictions);
  for (std::uint32_t slot : evictions) release(slot);
  if (std::erase_if(baked_objects_.objects,
                    [&](const BakedObject& baked) { return baked.object == object; }) > 0)
    name_baked();
}

std::vector<ImageCache::Shown> ImageCache::shown() const {
  std::vector<Shown> shown;
  for (const DrawnPicture& drawn : plan_.pictures) {
    const Picture& picture = state_.slots[drawn.slot];
    shown.push_back({picture.geometry, motion_since_capture(picture), drawn.bound_px,
                     held_[drawn.slot].objects, *held_[drawn.slot].slot});
  }
  return shown;
}

void ImageCache::append_errors(int step, std::vector<float>& errors_px) const {
  for (const NailboardInstance& instance : instances_) {
    Camera frame = camera_;
    frame.world_from_eye = glm::inverse(instance.world_now_from_capture) * frame.world_from_eye;
    append_sample_errors(atlas_.read(instance.slot, instance.geometry), frame, step, errors_px);
  }
}

std::vector<DepthImage> ImageCache::read_pictures() const {
  std::vector<DepthImage> read;
  for (const Shown& picture : shown()) {
    read.push_back(depth_image_from(atlas_.read(picture.slot, picture.geometry)));
    read.back().name =
        std::to_string(read.size()) + " of " + std::to_string(picture.objects.size()) + " objects";
  }
  return read;
}

}  // namespace rilievo
