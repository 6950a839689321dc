#include "rilievo/method/pictures.h"

#include <string>
#include <utility>

#include "rilievo/capture/picture_camera.h"
#include "rilievo/core/linear_maps.h"
#include "rilievo/core/stopwatch.h"

namespace rilievo {
namespace {

// What an object did between two poses.
glm::dmat4 motion_between(const glm::mat4& then, const glm::mat4& now) {
  if (then == now) return glm::dmat4(1.0);
  return glm::dmat4(now) * glm::inverse(glm::dmat4(then));
}

}  // namespace

NailboardStoreOptions store_options(const PictureFramesOptions& options) {
  return {options.max_bytes, options.delta_bits, options.mode, options.samples, options.capture_by};
}

PictureChooser::PictureChooser(const PlacedScene& placed, std::unique_ptr<NailboardStore> store,
                               const PictureFramesOptions& options)
    : placed_(placed), store_(std::move(store)), options_(options) {
  pictures_.resize(placed.scene().objects.size());
}

void PictureChooser::add_sets(FrameContent& content) {
  content.sets.push_back({&store_->pictures(), {}});
}

bool PictureChooser::is_valid(const Picture& picture, const Camera& frame,
                              const glm::dmat4& motion) const {
  if (!is_invertible(glm::dmat3(motion))) return false;  // flattened, now or then
  // A moving object is a still one seen by an eye that moves the other way.
  const glm::dvec3 eye = glm::dvec3(glm::inverse(motion) * glm::dvec4(frame.position(), 1));
  const glm::dvec3 capture_eye = picture.geometry.capture.position();
  const double way = glm::length(eye - capture_eye);
  const double distance = glm::length(picture.center - capture_eye);
  if (!(way <= options_.max_angle * distance)) return false;
  // A narrower field of view or a larger frame asks for finer texels.
  return texel_angle(picture.geometry.capture) * options_.texels_per_pixel <=
         1.01 * texel_angle(frame);
}

bool PictureChooser::make_room(std::uint32_t object, const Camera& camera) {
  while (!store_->allocate(object, camera.width, camera.height)) {
    // Let go of the picture that was not drawn for longest; never of one that this frame needs.
    std::optional<Picture>* oldest = nullptr;
    for (std::optional<Picture>& picture : pictures_)
      if (picture && picture->last_drawn < frame_ &&
          (!oldest || picture->last_drawn < (*oldest)->last_drawn))
        oldest = &picture;
    if (!oldest) return false;
    store_->free(std::uint32_t(oldest - pictures_.data()));
    oldest->reset();
  }
  return true;
}

bool PictureChooser::capture(std::uint32_t object, const Camera& frame) {
  const Box& bounds = placed_.bounds()[object];
  const std::optional<Camera> camera =
      picture_camera(frame, bounds, {options_.texels_per_pixel, store_->max_picture_size(), 0.25});
  std::optional<Picture>& picture = pictures_[object];
  if (picture) {
    store_->free(object);
    picture.reset();
  }
  if (!camera || !make_room(object, *camera)) return false;
  store_->capture(object, *camera, {&object, 1});
  picture = Picture{picture_geometry(*camera), placed_.poses()[object], glm::dvec3(bounds.center()),
                    frame_};
  picture->geometry.strokes = placed_.stroke_size({&object, 1});
  picture->geometry.delta_bits = options_.delta_bits;
  picture->geometry.depth_mode = options_.mode;
  captured_.push_back(object);
  return true;
}

// Once all captures are asked for: the first one that is read waits for them.
void PictureChooser::narrow_captured() {
  for (const std::uint32_t object : captured_)
    if (const auto range = store_->delta_range(object))
      narrow_slab(pictures_[object]->geometry, *range);
  store_->finish();
}

Result<> PictureChooser::choose(const Camera& camera, const PlacedScene& placed,
                                FrameContent& content, FrameStats& stats) {
  ++frame_;
  content.outlines = options_.outlines;
  visible_.clear();
  captured_.clear();
  placed.cull(camera, visible_);
  const Stopwatch watch;
  const Scene& scene = placed.scene();
  std::vector<Instance>& instances = content.sets[0].instances;
  // First the pictures that hold: what is captured makes none of them go.
  for (const std::uint32_t object : visible_)
    if (std::optional<Picture>& picture = pictures_[object];
        picture &&
        is_valid(*picture, camera, motion_between(picture->pose, placed.poses()[object])))
      picture->last_drawn = frame_;
  for (const std::uint32_t object : visible_) {
    const Model& model = scene.models[std::size_t(scene.objects[object].model)];
    if (model.triangles < options_.min_triangles || !placed.has_opaque_parts(object)) {
      content.polygons.push_back(object);
      continue;
    }
    const std::optional<Picture>& picture = pictures_[object];
    const bool holds = picture && picture->last_drawn == frame_;
    if (!holds && !capture(object, camera)) {
      content.polygons.push_back(object);
      continue;
    }
    instances.push_back(
        {motion_between(picture->pose, placed.poses()[object]), object, object + 1});
  }
  if (!captured_.empty()) narrow_captured();
  for (const Instance& instance : instances)
    store_->show(instance.item, pictures_[instance.item]->geometry);
  stats.captures = int(captured_.size());
  stats.capture_ms = stats.captures ? watch.ms() : 0;
  stats.picture_bytes = store_->bytes();
  if (instances.empty()) stats.bound_px = 0;
  return Done{};
}

std::vector<DepthImage> PictureChooser::read_pictures(const FrameContent& content) const {
  std::vector<DepthImage> read;
  for (const Instance& instance : content.sets[0].instances) {
    read.push_back(std::move(store_->pictures().read_pictures(instance).front()));
    DepthImage& picture = read.back();
    const std::string& name = placed_.scene().objects[instance.object - 1].name;
    picture.name = std::to_string(instance.object) + (name.empty() ? "" : " " + name);
    picture.object = Image<std::uint32_t>(picture.depth.width(), picture.depth.height());
    for (std::size_t i = 0; i < picture.depth.texels().size(); ++i)
      if (picture.depth.texels()[i] != kNoDepth) picture.object.texels()[i] = instance.object;
  }
  return read;
}

Result<std::unique_ptr<FrameSource>> make_picture_frames(Backend& backend,
                                                         const PictureFramesOptions& options) {
  Result<std::unique_ptr<NailboardStore>> store = backend.make_store(store_options(options));
  if (!store) return store.error();
  return backend.make_frames(
      std::make_unique<PictureChooser>(backend.placed(), std::move(*store), options));
}

}  // namespace rilievo
