#include "rilievo/cache/gl/picture_frames.h"

#include <cmath>

#include "rilievo/capture/picture_camera.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/gl/context.h"

namespace rilievo {
namespace {

// What an object did between two poses.
glm::dmat4 motion_between(const glm::mat4& then, const glm::mat4& now) {
  if (then == now) return glm::dmat4(1.0);
  return glm::dmat4(now) * glm::inverse(glm::dmat4(then));
}

}  // namespace

PictureFrames::PictureFrames(SceneRenderer& renderer, NailboardCapture nailboards,
                             const PictureFramesOptions& options)
    : SceneFrames(renderer), options_(options), nailboards_(std::move(nailboards)) {
  pictures_.resize(renderer.scene().objects.size());
  content().sets.push_back({&nailboards_.set(), {}});
  outlines_ = options.outlines;
}

Result<PictureFrames> PictureFrames::create(SceneRenderer& renderer,
                                            const PictureFramesOptions& options) {
  Result<NailboardCapture> nailboards = NailboardCapture::create(
      renderer, options.capture_by, {options.max_bytes, options.delta_bits, options.samples},
      options.mode);
  if (!nailboards) return nailboards.error();
  return PictureFrames(renderer, std::move(*nailboards), options);
}

bool PictureFrames::is_valid(const Picture& picture, const Camera& frame,
                             const glm::dmat4& motion) const {
  // A moving object is a still one seen by an eye that moves the other way.
  const glm::dvec3 eye = glm::dvec3(glm::inverse(motion) * glm::dvec4(frame.position(), 1));
  const glm::dvec3 capture_eye = picture.geometry.capture.position();
  const double way = glm::length(eye - capture_eye);
  const double distance = glm::length(picture.center - capture_eye);
  if (way > options_.max_angle * distance) return false;
  // A narrower field of view or a larger frame asks for finer texels.
  return texel_angle(picture.geometry.capture) * options_.texels_per_pixel <=
         1.01 * texel_angle(frame);
}

std::optional<AtlasSlot> PictureFrames::make_room(int width, int height) {
  for (;;) {
    if (std::optional<AtlasSlot> slot = nailboards_.atlas().allocate(width, height)) return slot;
    // Let go of the picture that was not drawn for longest; never of one that this frame needs.
    std::optional<Picture>* oldest = nullptr;
    for (std::optional<Picture>& picture : pictures_)
      if (picture && picture->last_drawn < frame_ &&
          (!oldest || picture->last_drawn < (*oldest)->last_drawn))
        oldest = &picture;
    if (!oldest) return std::nullopt;
    nailboards_.atlas().free((*oldest)->slot);
    oldest->reset();
  }
}

bool PictureFrames::capture(std::uint32_t object, const Camera& frame) {
  const Box& bounds = renderer().object_bounds(object);
  const std::optional<Camera> camera = picture_camera(
      frame, bounds, {options_.texels_per_pixel, nailboards_.atlas().max_picture_size(), 0.25});
  std::optional<Picture>& picture = pictures_[object];
  if (picture) {
    nailboards_.atlas().free(picture->slot);
    picture.reset();
  }
  if (!camera) return false;
  const std::optional<AtlasSlot> slot = make_room(camera->width, camera->height);
  if (!slot) return false;
  nailboards_.capture(*camera, {&object, 1}, *slot);
  picture = Picture{*slot, picture_geometry(*camera), renderer().poses()[object],
                    glm::dvec3(bounds.center()), frame_};
  picture->geometry.delta_bits = options_.delta_bits;
  picture->geometry.depth_mode = options_.mode;
  nailboards_.atlas().narrow(*slot, picture->geometry);
  return true;
}

Result<> PictureFrames::choose(const Camera& camera, FrameContent& content, FrameStats& stats) {
  ++frame_;
  visible_.clear();
  renderer().cull(camera, visible_);
  const Stopwatch watch;
  const Scene& scene = renderer().scene();
  for (std::uint32_t object : visible_) {
    const Model& model = scene.models[std::size_t(scene.objects[object].model)];
    if (model.triangles < options_.min_triangles || !renderer().has_opaque_parts(object)) {
      content.polygons.push_back(object);
      continue;
    }
    std::optional<Picture>& picture = pictures_[object];
    glm::dmat4 motion(1.0);
    if (picture) motion = motion_between(picture->pose, renderer().poses()[object]);
    if (!picture || !is_valid(*picture, camera, motion)) {
      if (!capture(object, camera)) {
        content.polygons.push_back(object);
        continue;
      }
      motion = glm::dmat4(1.0);
      ++stats.captures;
    }
    picture->last_drawn = frame_;
    nailboards_.set().set_item(object, picture->slot, picture->geometry);
    content.sets[0].instances.push_back({motion, object, object + 1});
  }
  if (stats.captures) gl::finish();
  stats.capture_ms = stats.captures ? watch.ms() : 0;
  stats.picture_bytes = nailboards_.set().bytes();
  return Done{};
}

std::vector<DepthImage> PictureFrames::read_pictures() const {
  std::vector<DepthImage> read;
  for (const Instance& instance : content().sets[0].instances) {
    read.push_back(std::move(nailboards_.set().read_pictures(instance).front()));
    DepthImage& picture = read.back();
    const std::string& name = renderer().scene().objects[instance.object - 1].name;
    picture.name = std::to_string(instance.object) + (name.empty() ? "" : " " + name);
    picture.object = Image<std::uint32_t>(picture.depth.width(), picture.depth.height());
    for (std::size_t i = 0; i < picture.depth.texels().size(); ++i)
      if (picture.depth.texels()[i] != kNoDepth) picture.object.texels()[i] = instance.object;
  }
  return read;
}

}  // namespace rilievo
