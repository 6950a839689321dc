#include "rilievo/keyframes/software/keyframe_frames.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "rilievo/capture/raster_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/core/color.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/on_this_thread.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/core/thread_watch.h"
#include "rilievo/keyframes/cheaper_way.h"
#include "rilievo/keyframes/keyframe_bound.h"
#include "rilievo/keyframes/software/keyframe_tiles.h"
#include "rilievo/keyframes/software/sampled_loss.h"
#include "rilievo/keyframes/software/software_painter.h"
#include "rilievo/keyframes/software/torn_blocks.h"
#include "rilievo/keyframes/software/unshown_objects.h"
#include "rilievo/render/raster/frame_raster.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/software/sky_tiles.h"

namespace rilievo {
namespace {

static_assert(Keyframe::kMostRows == SampleRaster::kMaxSize);

// The share of the last frame in the mean of what frames take besides keyframes.
constexpr double kNewestBesides = 0.1;

DepthImage picture_of(const Keyframe& key, std::string name) {
  DepthImage picture;
  picture.name = std::move(name);
  picture.camera = key.camera;
  picture.color = ColorImage(key.camera.width, key.camera.height);
  picture.depth = Image<float>(key.camera.width, key.camera.height, kNoDepth);
  picture.object = key.object;
  const std::array<float, 256>& linear = linear_of_srgb_bytes();
  const int scale = key.quarters() ? 2 : 1;
  for (int y = 0; y < key.camera.height; ++y)
    for (int x = 0; x < key.camera.width; ++x) {
      // The mean of those quarters that show the surface; one of them does.
      glm::vec3 sum(0);
      int count = 0;
      for (int i = 0; i < scale * scale; ++i) {
        const std::uint32_t color = key.color(scale * x + i % 2, scale * y + i / 2);
        if (color >> 30 != std::uint32_t(Quarter::own)) continue;
        sum += glm::vec3(linear[color & 255], linear[color >> 8 & 255], linear[color >> 16 & 255]);
        ++count;
      }
      picture.color(x, y) = glm::vec4(sum / float(count), 1);
      const float w = key.inverse_z(x, y);
      if (w > 0) picture.depth(x, y) = 1 / w;
    }
  return picture;
}

}  // namespace

struct KeyframeFrames::State {
  const Scene& scene;
  KeyframeFramesOptions options;
  PlacedScene placed;
  RayScene rays;
  RaySource ray_source;
  std::optional<RasterSource> raster_source;
  std::unique_ptr<CaptureSource> own_source;
  std::optional<RaySource> light_rays;  // for its light
  std::vector<bool> moves, polygon;     // by object
  std::optional<NearObjects> near;
  UnshownObjects unshown;
  TornBlocks torn;
  bool any_still = false;
  // Do keyframes show the scene's sky? A source of its own may have another.
  bool scene_sky = false;
  std::optional<KeyframeProducer> producer;
  std::optional<CheaperWay> cheaper;  // where polygons show the same and time matters
  bool warps = false;                 // the last frame shows keyframes
  bool made_now = false;              // a keyframe was made for the last frame
  bool making_beside = false;         // it is polygons, and keyframes are being made
  double allowed_ms = 0;              // see allow_keyframe_ms()
  double pace_ms = 0;                 // see set_pace()
  double besides_ms = 0;              // of a frame: what is not for keyframes; 0: not known
  int besides_frames = 0;             // that were measured for that

  std::unique_ptr<KeyframePainter> painter;
  WarpedFrame warped;
  Image<std::uint32_t> shown;
  SkyTiles sky;
  KeyframeTiles keyframe_tiles;
  std::vector<std::uint32_t> in_view, still, live, blended_in_view;
  Camera camera;
  FrameStats stats;
  KeyframeShares shares;
  std::optional<SampledLoss> loss;  // none: nobody asked

  State(const Scene& scene, RayScene made_rays, const KeyframeFramesOptions& options);
  void make_producer();
  void find_view(std::span<const WarpedKeyframe> keyframes);
  void divide_view(bool any_keyframes);
  Result<> look_for_unshown();
  Result<> warp(double time);
  void take_memory();
  std::size_t find_holes();
  [[nodiscard]] float nearest_of(std::span<const std::uint32_t> objects) const;
  Result<> warp_from(std::span<const WarpedKeyframe> keyframes);
  void note_besides(double ms);
  [[nodiscard]] double share_ms() const;
};

KeyframeFrames::State::State(const Scene& scene, RayScene made_rays,
                             const KeyframeFramesOptions& options)
    : scene(scene),
      options(options),
      placed(scene),
      rays(std::move(made_rays)),
      ray_source(rays),
      moves(scene.objects.size()),
      polygon(scene.objects.size()),
      unshown(placed, rays, options.near.triangles),
      torn(rays, options.gap_px),
      sky(scene.sky),
      keyframe_tiles(rays, sky) {}

void KeyframeFrames::State::make_producer() {
  std::vector<std::uint32_t> objects;
  bool any_moves = false;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    moves[i] = scene.objects[i].moving;
    any_moves = any_moves || moves[i];
    if (!moves[i]) objects.push_back(i);
  }
  any_still = !objects.empty();
  if (any_still && !own_source && options.keyframes.keyframe_ms > 0 &&
      options.polygons_where_cheaper)
    cheaper.emplace(!painter || painter->draws_as_source());
  CaptureSource* source = own_source.get();
  std::unique_ptr<FrameRaster> visibility;
  if (!source && options.by == KeyframesBy::raster) {
    source = &raster_source.emplace(placed);
    near.emplace(placed, objects, options.near);
    visibility = std::make_unique<FrameRaster>(scene, raster_source->materials());
  }
  if (!painter)
    painter = std::make_unique<SoftwarePainter>(scene, options.samples, std::move(visibility));
  if (!source) source = &ray_source;
  if (!any_moves) objects.clear();  // all: sources leave out what they do not see
  scene_sky = !own_source || options.keyframes.sky;
  if (own_source) options.keyframes.light_rays = &light_rays.emplace(rays);
  producer.emplace(*source, ray_source, options.keyframes, std::move(objects),
                   near ? &*near : nullptr);
}

// What is seen as polygons, all of it if there are no keyframes, and what is warped.
void KeyframeFrames::State::find_view(std::span<const WarpedKeyframe> keyframes) {
  in_view.clear();
  placed.cull(camera, in_view);
  polygon = moves;
  for (const std::uint32_t object : producer->left_out()) polygon[object] = true;
  divide_view(!keyframes.empty());
  if (keyframes.empty()) return;
  const std::span<const std::uint32_t> unshown = this->unshown.begin(camera, keyframes, still);
  for (const std::uint32_t object : unshown) polygon[object] = true;
  producer->hide(this->unshown.grown());
  if (!unshown.empty()) divide_view(true);
}

void KeyframeFrames::State::divide_view(bool any_keyframes) {
  still.clear(), live.clear(), blended_in_view.clear();
  for (const std::uint32_t object : in_view) {
    (polygon[object] || !any_keyframes ? live : still).push_back(object);
    if (placed.has_blended_parts(object)) blended_in_view.push_back(object);
  }
}

// Warps the frame, unless polygons are drawn instead: see `warps`.
Result<> KeyframeFrames::State::warp(double time) {
  std::span<const WarpedKeyframe> from = producer->follow(camera, time);
  const double most = options.most_filled * camera.width * camera.height;
  if (!from.empty()) {
    if (Result<> done = warp_from(from); !done) return done;
  }
  // After a jump nearly all are holes: these are not worth finding.
  const bool fails = from.empty() || double(keyframe_tiles.least_open(warped)) > most ||
                     double(find_holes()) > most;
  if (fails && !from.empty() && cheaper && cheaper->leave_keyframes(producer->frame_ms())) {
    warps = false, shares.cast = 0;
    return Done{};
  }
  if (fails) {
    if (!producer->any() && options.keyframes.keyframe_ms > 0)
      keyframe_tiles.take_memory(camera.width, camera.height, std::size_t(most));
    take_memory();
    made_now = true;
    Result<std::span<const WarpedKeyframe>> made = producer->make_now();
    if (!made) return made.error();
    if (Result<> done = warp_from(*made); !done) return done;
    (void)find_holes();
  }
  return Done{};
}

// Of polygons, before the first keyframe, so that no frame that is timed touches a new page: most
// of it depends on the frame's size, and one object makes them take it.
void KeyframeFrames::State::take_memory() {
  if (!near || producer->any()) return;
  find_view({});
  painter->take_memory({live.data(), std::min<std::size_t>(live.size(), 1)});
}

// Those that rays have to fill.
std::size_t KeyframeFrames::State::find_holes() {
  const Stopwatch watch;
  const std::size_t open = keyframe_tiles.find_holes(camera, warped, still, options.most_fine);
  shares.cast = double(open) / (double(camera.width) * camera.height);
  shares.fill_ms += watch.ms();
  return open;
}

// 1 / eye_z of the nearest place that they may reach.
float KeyframeFrames::State::nearest_of(std::span<const std::uint32_t> objects) const {
  double nearest = camera.z_far;
  for (const std::uint32_t object : objects)
    for (const glm::vec3& corner : placed.bounds()[object].corners())
      nearest =
          std::min(nearest, glm::dot(glm::dvec3(corner) - camera.position(), camera.forward()));
  return float(1 / std::max(nearest, camera.z_near));
}

// Polygons first: what they cover is not warped.
Result<> KeyframeFrames::State::warp_from(std::span<const WarpedKeyframe> keyframes) {
  const Stopwatch watch;
  find_view(keyframes);
  if (Result<> done = painter->place(live); !done) return done;
  const double polygons_ms = watch.ms();
  const float nearest = live.empty() ? 0 : nearest_of(still);
  if (Result<> done = painter->warp(keyframes, nearest, scene_sky, warped); !done) return done;
  shares.polygons_ms += polygons_ms;
  shares.warp_ms += watch.ms() - polygons_ms;
  if (Result<> done = look_for_unshown(); !done) return done;
  const Stopwatch look;
  (void)torn.look(camera, keyframes, still, warped);
  shares.polygons_ms += look.ms();
  return Done{};
}

// What nobody knew of is placed over what was warped.
Result<> KeyframeFrames::State::look_for_unshown() {
  const Stopwatch watch;
  const std::span<const std::uint32_t> unshown = this->unshown.look(warped);
  for (const std::uint32_t object : unshown) polygon[object] = true;
  if (!unshown.empty()) {
    divide_view(true);
    if (Result<> done = painter->place(live); !done) return done;
  }
  shares.polygons_ms += watch.ms();
  return Done{};
}

// A frame took that, without what it spent on keyframes. The first one touches memory for the first
// time.
void KeyframeFrames::State::note_besides(double ms) {
  ++besides_frames;
  if (besides_frames > 1)
    besides_ms += (ms - besides_ms) * (besides_frames > 2 ? kNewestBesides : 1);
}

// Of a frame, for keyframes.
double KeyframeFrames::State::share_ms() const {
  const double share = options.keyframe_share * besides_ms;
  return pace_ms > 0 ? std::clamp(pace_ms - besides_ms, 0.0, share) : share;
}

KeyframeFrames::KeyframeFrames(std::unique_ptr<State> state) : state_(std::move(state)) {}
KeyframeFrames::~KeyframeFrames() = default;

Result<std::unique_ptr<KeyframeFrames>> KeyframeFrames::create(
    const Scene& scene, const KeyframeFramesOptions& options) {
  return create(scene, {}, options);
}

Result<std::unique_ptr<KeyframeFrames>> KeyframeFrames::create(
    const Scene& scene, const MakeSource& make, const KeyframeFramesOptions& options,
    std::unique_ptr<KeyframePainter> painter) {
  Result<RayScene> rays = RayScene::create(scene);
  if (!rays) return rays.error();
  auto state = std::make_unique<State>(scene, std::move(*rays), options);
  if (make) {
    Result<std::unique_ptr<CaptureSource>> made = make(state->rays);
    if (!made) return made.error();
    state->own_source = std::move(*made);
  }
  state->painter = std::move(painter);
  state->make_producer();
  return {std::unique_ptr<KeyframeFrames>(new KeyframeFrames(std::move(state)))};
}

Result<> KeyframeFrames::draw(const Camera& camera, double time) {
  State& s = *state_;
  const Stopwatch all;
  const ThreadWatch processor;
  CheaperWay::Way way = s.cheaper ? s.cheaper->next() : CheaperWay::Way::keyframes;
  s.warps = s.any_still && way == CheaperWay::Way::keyframes;
  s.camera = camera;
  s.placed.set_time(time);
  s.shares = {};
  s.made_now = false;
  s.stats.captures = 0, s.stats.capture_ms = 0;
  s.painter->begin(camera, s.placed, time);
  const bool followed = s.warps;
  if (s.warps) {
    if (Result<> done = s.warp(time); !done) return done;
    if (!s.warps) way = s.cheaper->next();
  }
  s.shares.direct = s.any_still && !s.warps;
  if (s.warps) {
    const Stopwatch watch;
    s.keyframe_tiles.place(s.options.samples, s.still, s.producer->chosen());
    s.shares.fill_ms += watch.ms();
    s.shares.filled = double(s.warped.holes()) / (double(camera.width) * camera.height);
  } else {
    s.find_view({});
    if (Result<> done = s.painter->place(s.live); !done) return done;
  }
  const Stopwatch tiles;
  s.shares.live = int(s.live.size());
  s.sky.place(camera);
  const KeyframeContent content{s.warps ? &s.keyframe_tiles : nullptr, &s.sky, s.blended_in_view};
  if (Result<> done = s.painter->draw(content); !done) return done;
  if (s.cheaper) s.painter->finish();
  s.shares.tiles_ms = tiles.ms();
  if (s.warps && !s.made_now) {
    // Beside frames this thread draws alone, and waits for them.
    s.note_besides(beside_frames() ? processor.ms() / threads_of_frames() : all.ms());
  }
  if (s.any_still && way != CheaperWay::Way::polygons) {
    // Beside polygons nobody asked for the keyframes at hand.
    if (!s.warps) {
      if (!s.making_beside) s.producer->forget();
      if (!followed) (void)s.producer->follow(camera, time);
    }
    const Result<> done =
        s.producer->work(s.shares.fill_ms, s.allowed_ms, s.warps ? s.share_ms() : 0);
    if (!done) return done;
  }
  s.making_beside = way == CheaperWay::Way::both;

  const KeyframeWork work = s.producer->take_work();
  s.shares.keyframe_ms = work.ms;
  s.shares.completed = work.completed;
  s.shares.coarse = work.coarse > 0;
  s.stats.captures = work.completed + work.coarse;
  s.stats.capture_ms = work.ms;
  s.stats.picture_bytes = s.producer->bytes();
  const KeyframeBound bound =
      s.warps ? bound_keyframes(s.producer->chosen(), camera) : KeyframeBound{};
  s.stats.bound_px = bound.error_px, s.stats.gap_px = bound.gap_px;
  s.stats.polygons = int(s.live.size());
  s.stats.filled_share = s.shares.filled;
  s.stats.live_share = live_share();
  s.stats.late = 0;
  if (s.warps)
    for (const WarpedKeyframe& one : s.producer->chosen())
      s.stats.late += one.keyframe->coarse && !one.spare;
  s.stats.by_kind.clear();
  s.stats.by_kind.emplace_back("keyframe", s.warps ? int(s.producer->chosen().size()) : 0);
  if (s.cheaper) {
    const double ms = all.ms() - (way == CheaperWay::Way::both ? work.ms : 0);
    s.cheaper->add(ms, s.producer->frame_ms(), s.producer->has_all());
  }
  return Done{};
}

Result<> KeyframeFrames::draw_objects() {
  State& s = *state_;
  if (s.warps) {
    warp_objects(s.producer->chosen(), s.camera, s.warped, s.shown);
    s.keyframe_tiles.place_objects(s.shown, s.still);
  }
  return s.painter->draw_objects(s.warps ? &s.keyframe_tiles : nullptr);
}

void KeyframeFrames::allow_keyframe_ms(double ms) { state_->allowed_ms = ms; }

void KeyframeFrames::set_pace(double ms) { state_->pace_ms = ms; }

Result<> KeyframeFrames::prepare(const Camera& camera, double time, bool anew, double allowed_ms) {
  State& s = *state_;
  if (!s.any_still) return Done{};
  if (anew && !s.options.keyframes.beside) s.producer->forget();
  s.placed.set_time(time);
  (void)s.producer->follow(camera, time);
  Result<> done = s.producer->work(0, allowed_ms);
  (void)s.producer->take_work();
  if (s.options.keyframes.beside) return done;
  s.producer->take_complete();
  if (s.producer->has_two()) s.producer->take_memory();
  return done;
}

void KeyframeFrames::follow(const Camera& camera, double time) {
  State& s = *state_;
  if (!s.any_still) return;
  s.placed.set_time(time);
  (void)s.producer->follow(camera, time);
}

void KeyframeFrames::reserve(const Camera& camera, double time) {
  State& s = *state_;
  if (!s.any_still) return;
  s.placed.set_time(time);
  s.camera = camera;
  s.painter->begin(camera, s.placed, time);
  s.producer->forget();
  s.take_memory();
  s.producer->reserve(camera, time);
}

bool KeyframeFrames::any() const { return state_->producer->any(); }

double KeyframeFrames::least_frames_for_one() const {
  const KeyframeFramesOptions& options = state_->options;
  return options.keyframe_share > 0 ? options.keyframes.interval
                                    : state_->producer->frames_for_one();
}

Result<> KeyframeFrames::look_from(const Camera& camera, double time) {
  State& s = *state_;
  RILIEVO_EXPECTS(!s.any_still || s.producer->any());
  s.warps = s.any_still;
  if (!s.warps) return Done{};
  s.camera = camera;
  s.placed.set_time(time);
  s.painter->begin(camera, s.placed, time);
  return s.warp_from(s.producer->choose_for(camera));
}

std::optional<double> KeyframeFrames::sample_loss(int looks) {
  State& s = *state_;
  if (!s.loss) s.loss.emplace(s.rays);
  if (s.warps) s.loss->add(s.camera, s.still, s.warped.color.texels(), looks);
  return s.loss->known() ? std::optional(s.loss->loss_db()) : std::nullopt;
}

void KeyframeFrames::forget_loss() {
  if (state_->loss) state_->loss->forget();
}

const RayScene& KeyframeFrames::rays() const { return state_->rays; }

std::uint64_t KeyframeFrames::made_count() const { return state_->producer->made_count(); }

bool KeyframeFrames::making() const { return state_->producer->making(); }

bool KeyframeFrames::prepared() const { return !state_->any_still || state_->producer->has_all(); }

const SoftwareTarget* KeyframeFrames::software_target() const { return state_->painter->target(); }
const FrameStats& KeyframeFrames::stats() const { return state_->stats; }
const KeyframeShares& KeyframeFrames::shares() const { return state_->shares; }

double KeyframeFrames::live_share() const {
  const State& s = *state_;
  return s.warps ? s.painter->polygon_share(s.warped) : 1;
}

std::vector<DepthImage> KeyframeFrames::read_pictures() const {
  std::vector<DepthImage> pictures;
  for (const WarpedKeyframe& one : state_->producer->chosen())
    pictures.push_back(picture_of(*one.keyframe, "keyframe " + std::to_string(pictures.size())));
  return pictures;
}

}  // namespace rilievo
