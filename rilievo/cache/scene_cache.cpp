#include "rilievo/cache/scene_cache.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "rilievo/cache/prices/use_machine.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/linear_maps.h"

namespace rilievo {
NailboardStoreOptions store_options(const ImageCacheOptions& options) {
  return {options.max_bytes, options.delta_bits, options.depth_mode, options.samples,
          options.capture_by};
}

SceneCache::SceneCache(const PlacedScene& placed, std::unique_ptr<NailboardStore> store,
                       const ImageCacheOptions& options, std::unique_ptr<LeveledBackend> levels,
                       const Scene* finest)
    : levels_(std::move(levels)),
      placed_(placed),
      store_(std::move(store)),
      finest_(finest ? *finest : placed.scene()),
      options_(options) {
  build();
}

Result<std::unique_ptr<SceneCache>> SceneCache::create(Backend& backend,
                                                       const ImageCacheOptions& options) {
  const bool software = backend.drawn_by() == DrawnBy::software;
  if (options.levels && !software)
    return Error{"--levels", "the cache draws levels of detail without OpenGL only"};
  std::unique_ptr<LeveledBackend> levels;
  if (options.levels) {
    auto made = LeveledBackend::create(backend, make_bounded_object_levels(backend.scene()));
    if (!made) return made.error();
    levels = std::move(*made);
  }
  Backend& of = levels ? levels->backend() : backend;
  Result<std::unique_ptr<NailboardStore>> store = of.make_store(store_options(options));
  if (!store) return software ? Error{"--memory-mb", store.error().reason} : store.error();
  if (options.machine)
    if (Result<> known =
            expect_costs(*options.machine, backend.drawn_by(), (*store)->rasterizer() != nullptr);
        !known)
      return known.error();
  return std::make_unique<SceneCache>(of.placed(), std::move(*store), options, std::move(levels),
                                      &backend.scene());
}

Result<CachedFrames> make_cached_frames(Backend& backend, const ImageCacheOptions& options) {
  Result<std::unique_ptr<SceneCache>> made = SceneCache::create(backend, options);
  if (!made) return made.error();
  CachedFrames cached;
  cached.cache = made->get();
  Backend& of = cached.cache->level_backend() ? *cached.cache->level_backend() : backend;
  Result<std::unique_ptr<FrameSource>> frames = of.make_frames(std::move(*made));
  if (!frames) return frames.error();
  cached.frames = std::move(*frames);
  return cached;
}

void SceneCache::add_sets(FrameContent& content) {
  content.sets.push_back({&store_->pictures(), {}});
  for (const ObjectDrawable& drawable : drawables_)
    content.sets.push_back({drawable.drawable.get(), {}});
  sets_changed_ = false;
}

void SceneCache::build() {
  const Scene& scene = placed_.scene();
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    if (!placed_.has_opaque_parts(i)) continue;
    const std::uint64_t count = scene.models[std::size_t(scene.objects[i].model)].triangles;
    if (scene.objects[i].moving) {
      moving_objects_.push_back(i);
      MovingObject moving;
      moving.triangles = count;
      moving.box = placed_.bounds()[i];
      moving.world_from_object = glm::dmat4(placed_.poses()[i]);
      moving.polygons_only = !is_invertible(glm::dmat3(moving.world_from_object));
      moving_.push_back(moving);
    } else {
      static_objects_.push_back(i);
    }
  }
  build_tree({});

  const bool rasterizes = store_->rasterizer() != nullptr;
  policy_ = rasterizes ? rasterized_cache_options() : CacheOptions{};
  if (options_.machine)
    use_machine(*options_.machine, store_->drawn_by(), rasterizes, policy_, clock_);
  else if (store_->drawn_by() == DrawnBy::software)
    use_machine(builtin_software_costs(), DrawnBy::software, true, policy_, clock_);
  policy_.max_texels = store_->max_picture_size();
  policy_.texel_cell = store_->texel_cell();
  policy_.delta_bits = options_.delta_bits;
  policy_.fallback_bits = store_->written_bits();
  policy_.depth_mode = options_.depth_mode;
  policy_.bytes_per_texel = options_.delta_bits > 8 ? 6 : 5;
  // First fit leaves gaps between pictures: plan for less than there is, and refuse what does not
  // fit.
  policy_.memory_bytes = store_->max_texels() * std::uint64_t(policy_.bytes_per_texel);
  unlimited_ = policy_;
  set_budget();  // rays are built before the first frame
}

void SceneCache::build_tree(std::span<const std::uint32_t> apart) {
  const Scene& scene = placed_.scene();
  std::vector<Box> boxes;
  std::vector<std::uint64_t> triangles;
  std::vector<std::uint8_t> is_apart;
  for (const std::uint32_t object : static_objects_) {
    boxes.push_back(placed_.bounds()[object]);
    triangles.push_back(scene.models[std::size_t(scene.objects[object].model)].triangles);
    is_apart.push_back(std::binary_search(apart.begin(), apart.end(), object));
  }
  hierarchy_ = build_hierarchy(boxes, triangles, is_apart);
  leaf_of_.assign(static_objects_.size(), 0);
  for (Entity e = 0; e < hierarchy_.nodes.size(); ++e)
    if (hierarchy_.nodes[e].leaf()) leaf_of_[hierarchy_.order[hierarchy_.nodes[e].first]] = e;
  if (levels_) build_levels();
}

// What each step of the table leaves of each node: of one object, then of both children.
void SceneCache::build_levels() {
  const auto levels_of = [&](std::uint32_t object) -> const std::vector<ModelLevel>& {
    return levels_->levels().leveled.levels[std::size_t(levels_->levels().model_of[object])];
  };
  level_table_ = {INFINITY, {}};
  for (const std::uint32_t object : static_objects_)
    if (const auto& levels = levels_of(object); levels.size() > 1 && levels[1].error > 0)
      level_table_.first =
          std::min(level_table_.first, levels[1].error * largest_stretch(placed_.poses()[object]));
  if (!(level_table_.first > 0 && std::isfinite(level_table_.first))) return;
  level_table_.of_node.resize(hierarchy_.nodes.size());
  for (Entity e = Entity(hierarchy_.nodes.size()); e-- > 0;) {
    const HierarchyNode& node = hierarchy_.nodes[e];
    for (int step = 0; step < LevelTable::kSteps; ++step) {
      LevelTable::Level& entry = level_table_.of_node[e][std::size_t(step)];
      if (!node.leaf()) {
        const LevelTable::Level &a = level_table_.of_node[e + 1][std::size_t(step)],
                                &b = level_table_.of_node[node.second_child][std::size_t(step)];
        entry = {a.triangles + b.triangles, std::max(a.error, b.error)};
        continue;
      }
      const std::uint32_t object = static_objects_[hierarchy_.order[node.first]];
      const double stretch = largest_stretch(placed_.poses()[object]);
      const ModelLevel& level =
          choose_level(levels_of(object), level_table_.first * std::exp2(0.5 * step) / stretch);
      // Rounded up: show_level() chooses the same again, and the bound holds.
      entry = {float(levels_->levels().leveled.scene.models[std::size_t(level.model)].triangles),
               level.error > 0 ? std::nextafter(float(level.error * stretch), INFINITY) : 0.0f};
    }
  }
}

void SceneCache::show_levels(std::span<const std::uint32_t> objects, double error) {
  if (!levels_) return;
  for (const std::uint32_t object : objects)
    show_level(object, placed_.poses()[object], error, levels_->levels());
}

void SceneCache::show_polygon_levels() {
  if (!levels_) return;
  for (const DrawnObject& drawn : plan_.polygons)
    show_levels({&static_objects_[drawn.object], 1}, double(drawn.level_error));
}

// Of an opaque object.
Entity SceneCache::entity_of(std::uint32_t object) const {
  const bool moving = placed_.scene().objects[object].moving;
  const std::vector<std::uint32_t>& objects = moving ? moving_objects_ : static_objects_;
  const auto found = std::lower_bound(objects.begin(), objects.end(), object);
  RILIEVO_EXPECTS(found != objects.end() && *found == object);
  const auto i = std::size_t(found - objects.begin());
  return moving ? Entity(hierarchy_.nodes.size() + i) : leaf_of_[i];
}

void SceneCache::index_alternatives() {
  plan_.alternatives.clear();  // indices of before
  alternatives_.of_entity.assign(hierarchy_.nodes.size() + moving_.size(), {});
  for (std::size_t i = 0; i < alternatives_.list.size(); ++i) {
    const Alternative& one = alternatives_.list[i];
    const Entity entity =
        drawables_[one.drawable].together ? *hierarchy_.apart : entity_of(one.object);
    alternatives_.of_entity[entity].push_back(std::uint32_t(i));
  }
}

void SceneCache::add_drawable(ObjectDrawable drawable) {
  Alternative alternative{drawable.drawable->error_model(0),
                          terms_for(drawable.drawable->cost_terms(0), policy_.cost)};
  alternative.drawable = std::uint32_t(drawables_.size());
  for (const std::uint32_t object : drawable.objects) {
    // What shows all objects at once was baked where they are.
    const std::optional<glm::dmat4> motion =
        drawable.together ? glm::dmat4(1.0) : motion_of(drawable, placed_.poses()[object]);
    if (!motion) continue;
    alternative.object = object;
    alternative.world_from_capture = *motion;
    alternatives_.list.push_back(alternative);
    if (drawable.together) break;
  }
  alternative_bytes_ += drawable.drawable->bytes();
  drawables_.push_back(std::move(drawable));
  sets_changed_ = true;
}

void SceneCache::add_surroundings(std::unique_ptr<Drawable> drawable,
                                  std::unique_ptr<DrawableFactory> factory,
                                  std::vector<std::uint32_t> objects) {
  RILIEVO_EXPECTS(held_.empty() && !objects.empty());
  build_tree(objects);
  factories_.push_back(std::move(factory));
  add_drawable({std::move(drawable), std::move(objects), glm::dmat4(1.0), true});
  index_alternatives();
}

void SceneCache::add_alternatives(std::vector<ObjectDrawable> drawables,
                                  std::unique_ptr<DrawableFactory> factory) {
  factories_.push_back(std::move(factory));
  for (ObjectDrawable& drawable : drawables) add_drawable(std::move(drawable));
  index_alternatives();
}

void SceneCache::update_moving() {
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    const std::uint32_t object = moving_objects_[i];
    const glm::dmat4 now(placed_.poses()[object]);
    MovingObject& moving = moving_[i];
    moving.now_from_last = glm::dmat4(1.0);
    if (now != moving.world_from_object) {
      const bool had_inverse = !moving.polygons_only;
      // Of what is flattened, the pose does not tell what moves with it.
      moving.polygons_only = !is_invertible(glm::dmat3(now));
      if (had_inverse && !moving.polygons_only)
        moving.now_from_last = now * glm::inverse(moving.world_from_object);
      moving.world_from_object = now;
    }
    moving.box = placed_.bounds()[object];
  }
  for (Alternative& alternative : alternatives_.list) {
    if (!placed_.scene().objects[alternative.object].moving) continue;
    const std::optional<glm::dmat4> motion =
        motion_of(drawables_[alternative.drawable], placed_.poses()[alternative.object]);
    alternative.present = motion.has_value();
    if (motion) alternative.world_from_capture = *motion;
  }
}

void SceneCache::objects_of(Entity entity, std::vector<std::uint32_t>& objects) const {
  objects.clear();
  if (entity >= hierarchy_.nodes.size()) {
    objects.push_back(moving_objects_[entity - hierarchy_.nodes.size()]);
    return;
  }
  const HierarchyNode& node = hierarchy_.nodes[entity];
  for (std::uint32_t i = 0; i < node.count; ++i)
    objects.push_back(static_objects_[hierarchy_.order[node.first + i]]);
}

glm::dmat4 SceneCache::motion_since_capture(const Picture& picture) const {
  if (picture.entity < hierarchy_.nodes.size()) return glm::dmat4(1.0);
  const glm::dmat4& now = moving_[picture.entity - hierarchy_.nodes.size()].world_from_object;
  if (now == picture.world_from_object) return glm::dmat4(1.0);
  return motion_since(picture, hierarchy_, moving_);
}

void SceneCache::follow_options() {
  policy_.error_px = options_.error_px;
  policy_.gap_px = options_.gap_px;
  policy_.spikes.late = std::max(1.0, options_.late);
  policy_.spikes.catch_up = options_.catch_up;
  policy_.fade_frames = options_.fade_frames;
  set_budget();
}

// Can a frame cost more than its floor? By polygons, if it shows all of the scene.
bool SceneCache::may_spike() const {
  return options_.max_spike > 0 && !hierarchy_.nodes.empty() &&
         double(hierarchy_.nodes[0].triangles) > policy_.spikes.floor;
}

// Of time where it is given; of triangles that take as long where rays lack memory or OpenGL
// captures.
void SceneCache::set_budget() {
  policy_.capture_cost = unlimited_.capture_cost;
  policy_.capture_triangles = unlimited_.capture_triangles;
  policy_.picture_triangles = unlimited_.picture_triangles;
  // Whoever limits what frames take wants none that takes twice as long, even where memory does not
  // suffice for the coarse picture that the limits rely on.
  const bool limited = options_.capture_ms > 0 || options_.max_spike > 0;
  policy_.capture_share = limited ? 0 : unlimited_.capture_share;
  if (!casts_ && (options_.capture_ms > 0 || may_spike())) {
    if (store_->rasterizer())
      if (auto coarse = CoarseCapture::create(finest_)) coarse_ = std::move(*coarse);
    casts_ = true;
  }
  policy_.spikes.max_spike = coarse_ ? options_.max_spike : 0;
  if (!(options_.capture_ms > 0)) return;
  if (coarse_) {
    clock_.pass_frame();
    clock_.set_budget(options_.capture_ms, unlimited_, policy_);
  } else if (cost_per_ms_ > 0) {
    policy_.capture_triangles =
        std::uint64_t(options_.capture_ms * cost_per_ms_ / policy_.cost.capture_triangle);
  }
}

void SceneCache::collect(FrameContent& content) {
  std::vector<Instance>& instances = content.sets[0].instances;
  for (std::size_t i = 0; i < plan_.pictures.size(); ++i) {
    const DrawnPicture& drawn = plan_.pictures[i];
    const Picture& picture = state_.slots[drawn.slot];
    const Held& held = held_[drawn.slot];
    store_->show(stored(drawn.slot), picture.geometry);
    const std::uint32_t object = held.objects.size() == 1 ? held.objects[0] + 1 : kNoObject;
    instances.push_back(
        {motion_since_capture(picture), stored(drawn.slot), object, drawn.from, drawn.to});
    // A picture that fades in, and then the one that it replaces.
    if (drawn.from > 0 && drawn.to >= 1 && i > 0 && plan_.pictures[i - 1].to == drawn.from &&
        plan_.pictures[i - 1].from <= 0 &&
        state_.slots[plan_.pictures[i - 1].slot].entity == picture.entity) {
      instances[i].partner = std::uint32_t(i - 1);
      instances[i - 1].partner = std::uint32_t(i);
    }
  }
  if (fallback_.held) {
    store_->show(kFallbackSlot, plan_.fallback.geometry);
    instances.push_back({glm::dmat4(1.0), kFallbackSlot, kNoObject, 0, 1});
  }
  const auto add = [&](std::uint32_t object, float from, float to) {
    if (from <= 0 && to >= 1)
      content.polygons.push_back(object);
    else
      content.fading.push_back({object, from, to});
  };
  for (const DrawnObject& drawn : plan_.polygons)
    add(static_objects_[drawn.object], drawn.from, drawn.to);
  for (const DrawnObject& drawn : plan_.moving_polygons)
    add(moving_objects_[drawn.object], drawn.from, drawn.to);
  for (const DrawnAlternative& drawn : plan_.alternatives) {
    const Alternative& alternative = alternatives_.list[drawn.alternative];
    const bool together = drawables_[alternative.drawable].together;
    content.sets[1 + alternative.drawable].instances.push_back(
        {alternative.world_from_capture, 0, together ? kNoObject : alternative.object + 1});
  }
}

Result<> SceneCache::choose(const Camera& camera, [[maybe_unused]] const PlacedScene& placed,
                            FrameContent& content, FrameStats& stats) {
  RILIEVO_EXPECTS(&placed == &placed_);
  if (sets_changed_) {
    content.sets.clear();
    add_sets(content);
  }
  retired_.clear();
  retired_factories_.clear();
  content.outlines = options_.outlines;
  content.sky = options_.sky;
  update_moving();
  follow_options();
  adopt_captures(camera, stats);
  if (fallback_.held) store_->free(kFallbackSlot);
  fallback_.held = false;
  stats_ = &stats;
  plan_frame({hierarchy_, moving_, alternatives_, level_table_}, state_, follow(motion_, camera),
             policy_, *this, scratch_, plan_);
  if (captures_beside(policy_)) order_captures();
  commit(plan_, state_);
  collect(content);
  show_polygon_levels();
  stats.bound_px = plan_.bound_px;
  stats.gap_px = plan_.gap_px;
  stats.picture_bytes = store_->bytes() + alternative_bytes_;
  since_choice_ = {};
  return Done{};
}

void SceneCache::drawn(const FrameWork* work, FrameStats&) {
  if (!work) return;
  if (!plan_.pictures.empty() || fallback_.held) store_->find_seen_shares(seen_shares_);
  learn(work->polygons, seen_shares_);
}

void SceneCache::learn(std::span<const ObjectWork> work, std::span<const float> seen_shares) {
  if (captures_beside(policy_))
    clock_.drawing.learn(plan_.cost - plan_.fallback_cost, since_choice_.ms());
  if (!options_.learn) return;
  learn_seen(plan_, seen_shares, state_);
  work_of_.resize(placed_.scene().objects.size());
  for (const ObjectWork& one : work) work_of_[one.object] = one;
  const CostModel& price = policy_.cost;
  polygon_costs_.clear();
  const auto add = [&](Entity entity, std::uint32_t object, const DrawnObject& drawn) {
    if (!(drawn.expected_cost > 0) || drawn.from > 0 || drawn.to < 1) return;
    const ObjectWork& done = work_of_[object];
    polygon_costs_.push_back({entity, double(drawn.expected_cost),
                              price.object + price.projected_triangle * double(done.projected) +
                                  price.filled_triangle * double(done.filled) +
                                  price.shaded_pixel * double(done.shaded)});
  };
  for (const DrawnObject& drawn : plan_.polygons)
    add(leaf_of_[drawn.object], static_objects_[drawn.object], drawn);
  for (const DrawnObject& drawn : plan_.moving_polygons)
    add(Entity(hierarchy_.nodes.size() + drawn.object), moving_objects_[drawn.object], drawn);
  learn_polygons(polygon_costs_, state_);
}

// Identifiers of pictures of several objects, where no probe has asked for them before.
void SceneCache::prepare_objects() {
  if (fallback_.held && !fallback_.objects_captured) {
    // Not as other pictures: it may show objects that reach behind the eye.
    store_->write_objects(kFallbackSlot, coarse_->capture_objects(fallback_.camera));
    fallback_.objects_captured = true;
  }
  for (const DrawnPicture& drawn : plan_.pictures) {
    Held& held = held_[drawn.slot];
    if (held.objects.size() == 1 || held.objects_captured) continue;
    finish_captures();  // they use the rasteriser
    show_levels(held.objects, state_.slots[drawn.slot].level_error);
    store_->capture_objects(stored(drawn.slot), held.camera, held.objects);
    held.objects_captured = true;
  }
  show_polygon_levels();
}

// They are drawn from until the next frame.
void SceneCache::retire_drawables() {
  for (ObjectDrawable& drawable : drawables_) retired_.push_back(std::move(drawable));
  for (auto& factory : factories_) retired_factories_.push_back(std::move(factory));
  drawables_.clear();
  factories_.clear();
  alternative_bytes_ = 0;
  sets_changed_ = true;
}

void SceneCache::invalidate() {
  std::vector<std::uint32_t> evictions;
  rilievo::invalidate(state_, evictions);
  for (std::uint32_t slot : evictions) release(slot);
  alternatives_.list.clear();
  index_alternatives();
  retire_drawables();
}

void SceneCache::invalidate_object(std::uint32_t object) {
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
  if (std::erase_if(alternatives_.list, [&](const Alternative& one) {
        const ObjectDrawable& drawable = drawables_[one.drawable];
        return one.object == object ||
               (drawable.together &&
                std::binary_search(drawable.objects.begin(), drawable.objects.end(), object));
      }) > 0)
    index_alternatives();
}

std::vector<SceneCache::Shown> SceneCache::shown() const {
  std::vector<Shown> shown;
  for (const DrawnPicture& drawn : plan_.pictures) {
    const Picture& picture = state_.slots[drawn.slot];
    shown.push_back({picture.geometry, motion_since_capture(picture), drawn.bound_px,
                     held_[drawn.slot].objects, stored(drawn.slot)});
  }
  if (fallback_.held)
    shown.push_back({plan_.fallback.geometry, glm::dmat4(1.0), plan_.fallback.bound_px,
                     fallback_.objects, kFallbackSlot});
  return shown;
}

std::vector<DepthImage> SceneCache::read_pictures(const FrameContent&) const {
  std::vector<DepthImage> read;
  for (const Shown& one : shown()) {
    read.push_back(depth_image_from(store_->read(one.slot, one.geometry)));
    read.back().name =
        std::to_string(read.size()) + " of " + std::to_string(one.objects.size()) + " objects";
  }
  return read;
}

}  // namespace rilievo
