#include "rilievo/cache/gl/picture_frames.h"

#include <chrono>
#include <cmath>

#include "rilievo/capture/picture_camera.h"
#include "rilievo/gl/context.h"
#include "rilievo/nailboard/sample_error.h"

namespace rilievo {
namespace {

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

// What an object did between two poses.
glm::dmat4 motion_between(const glm::mat4& then, const glm::mat4& now) {
  if (then == now) return glm::dmat4(1.0);
  return glm::dmat4(now) * glm::inverse(glm::dmat4(then));
}

}  // namespace

Result<PictureFrames> PictureFrames::create(SceneRenderer& renderer,
                                            const PictureFramesOptions& options) {
  Result<PictureAtlas> atlas = PictureAtlas::create(
      {options.max_bytes, options.delta_bits, options.samples,
       rasterized_scene(options.capture_by, renderer.scene(), options.samples)});
  if (!atlas) return atlas.error();
  Result<NailboardDrawer> drawer = NailboardDrawer::create();
  if (!drawer) return drawer.error();
  PictureFrames frames(renderer, std::move(*atlas), std::move(*drawer));
  frames.options_ = options;
  frames.pictures_.resize(renderer.scene().objects.size());
  return frames;
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
    if (std::optional<AtlasSlot> slot = atlas_.allocate(width, height)) return slot;
    // Let go of the picture that was not drawn for longest; never of one that this frame needs.
    std::optional<Picture>* oldest = nullptr;
    for (std::optional<Picture>& picture : pictures_)
      if (picture && picture->last_drawn < frame_ &&
          (!oldest || picture->last_drawn < (*oldest)->last_drawn))
        oldest = &picture;
    if (!oldest) return std::nullopt;
    atlas_.free((*oldest)->slot);
    oldest->reset();
  }
}

bool PictureFrames::capture(std::uint32_t object, const Camera& frame) {
  const Box& bounds = renderer_.object_bounds(object);
  const std::optional<Camera> camera =
      picture_camera(frame, bounds, {options_.texels_per_pixel, atlas_.max_picture_size(), 0.25});
  std::optional<Picture>& picture = pictures_[object];
  if (picture) {
    atlas_.free(picture->slot);
    picture.reset();
  }
  if (!camera) return false;
  const std::optional<AtlasSlot> slot = make_room(camera->width, camera->height);
  if (!slot) return false;
  atlas_.capture(renderer_, *camera, {&object, 1}, *slot);
  picture = Picture{*slot, picture_geometry(*camera), renderer_.poses()[object],
                    glm::dvec3(bounds.center()), frame_};
  picture->geometry.delta_bits = options_.delta_bits;
  picture->geometry.depth_mode = options_.mode;
  atlas_.narrow(*slot, picture->geometry);
  return true;
}

Result<> PictureFrames::draw(const Camera& camera, double time) {
  GLint framebuffer = 0, viewport[4];
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  glGetIntegerv(GL_VIEWPORT, viewport);

  camera_ = camera;
  time_ = time;
  ++frame_;
  figures_ = {};
  renderer_.set_time(time);
  visible_.clear();
  renderer_.cull(camera, visible_);

  // Captures first: they need the framebuffer for themselves.
  const auto start = std::chrono::steady_clock::now();
  polygons_.clear();
  instances_.clear();
  const Scene& scene = renderer_.scene();
  for (std::uint32_t object : visible_) {
    const Model& model = scene.models[std::size_t(scene.objects[object].model)];
    if (model.triangles < options_.min_triangles || !renderer_.has_opaque_parts(object)) {
      polygons_.push_back(object);
      continue;
    }
    std::optional<Picture>& picture = pictures_[object];
    glm::dmat4 motion(1.0);
    if (picture) motion = motion_between(picture->pose, renderer_.poses()[object]);
    if (!picture || !is_valid(*picture, camera, motion)) {
      if (!capture(object, camera)) {
        polygons_.push_back(object);
        continue;
      }
      motion = glm::dmat4(1.0);
      ++figures_.captures;
    }
    picture->last_drawn = frame_;
    instances_.push_back({picture->slot, picture->geometry, motion, object + 1});
  }
  if (figures_.captures) gl::finish();
  figures_.capture_ms = figures_.captures ? milliseconds_since(start) : 0;

  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(framebuffer));
  glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
  // Pictures before polygons: their shading is the cheaper one, and it hides the polygons behind.
  drawer_.draw(atlas_, camera, options_.mode, instances_);
  renderer_.draw_opaque(camera, polygons_, OutputEncoding::srgb);
  renderer_.draw_sky(camera, OutputEncoding::srgb);
  renderer_.draw_blended(camera, visible_, OutputEncoding::srgb);
  if (options_.outlines) drawer_.draw_outlines(camera, instances_);

  figures_.polygons = int(polygons_.size());
  figures_.pictures = int(instances_.size());
  figures_.picture_bytes = atlas_.bytes();
  return Done{};
}

Result<> PictureFrames::draw_objects() {
  renderer_.set_time(time_);
  drawer_.draw_objects(atlas_, camera_, options_.mode, instances_);
  renderer_.draw_objects(camera_, polygons_);
  return Done{};
}

void PictureFrames::append_errors(int step, std::vector<float>& errors_px) const {
  for (const NailboardInstance& instance : instances_) {
    Camera frame = camera_;
    frame.world_from_eye = glm::inverse(instance.world_now_from_capture) * frame.world_from_eye;
    append_sample_errors(atlas_.read(instance.slot, instance.geometry), frame, step, errors_px);
  }
}

std::vector<DepthImage> PictureFrames::read_pictures() const {
  std::vector<DepthImage> read;
  for (const NailboardInstance& instance : instances_) {
    read.push_back(depth_image_from(atlas_.read(instance.slot, instance.geometry)));
    Camera& camera = read.back().camera;
    if (instance.world_now_from_capture != glm::dmat4(1.0))
      camera.world_from_eye = instance.world_now_from_capture * camera.world_from_eye;
    const std::string& name = renderer_.scene().objects[instance.object - 1].name;
    read.back().name = std::to_string(instance.object) + (name.empty() ? "" : " " + name);
    read.back().object = Image<std::uint32_t>(instance.slot.width, instance.slot.height);
    for (std::size_t i = 0; i < read.back().depth.texels().size(); ++i)
      if (read.back().depth.texels()[i] != kNoDepth)
        read.back().object.texels()[i] = instance.object;
  }
  return read;
}

}  // namespace rilievo
