#include "rilievo/frame/gl/layered_frames.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace rilievo {
namespace {

// The size of a view's texels where they show the centre, the coarsest view's.
double texel_of(const LayeredImpostor& impostor) {
  const glm::dvec3 center(impostor.bounds.center());
  double texel = 0;
  for (const DepthImage& picture : impostor.pictures) {
    const Camera& c = picture.camera;
    const double eye_z = glm::dot(center - c.position(), c.forward());
    const double w = (c.window.right - c.window.left) / c.width;
    const double h = (c.window.top - c.window.bottom) / c.height;
    texel = std::max(texel, eye_z * std::max(w, h));
  }
  return texel;
}

}  // namespace

Result<LayeredFrames> LayeredFrames::create(SceneRenderer& renderer,
                                            const LayeredFramesOptions& options) {
  Result<LayeredDrawer> drawer = LayeredDrawer::create();
  if (!drawer) return drawer.error();
  LayeredFrames frames(renderer, std::move(*drawer));
  frames.options_ = options;
  frames.impostor_of_.assign(renderer.scene().objects.size(), -1);

  const auto start = std::chrono::steady_clock::now();
  ObjectImpostorOptions bake = options.impostors;
  bake.method = options.layered.method;
  Result<std::vector<ObjectImpostor>> baked = bake_object_impostors(renderer, bake);
  if (!baked) return baked.error();
  for (ObjectImpostor& object : *baked) {
    const LayeredImpostor& impostor = object.pictures.impostor();
    for (const std::uint32_t served : object.objects)
      frames.impostor_of_[served] = int(frames.impostors_.size());
    frames.figures_.picture_bytes += object.pictures.bytes();
    frames.captures_ += int(impostor.pictures.size());
    const double texel = texel_of(impostor);
    frames.impostors_.push_back({std::move(object), texel});
  }
  frames.capture_ms_ =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return frames;
}

std::optional<LayeredInstance> LayeredFrames::instance_of(std::uint32_t object,
                                                          const Camera& camera) const {
  const int i = impostor_of_[object];
  if (i < 0) return std::nullopt;
  const Impostor& impostor = impostors_[std::size_t(i)];
  const std::optional<glm::dmat4> motion = motion_of(impostor.baked, renderer_.poses()[object]);
  const Box& bounds = impostor.baked.pictures.impostor().bounds;
  if (!motion || !is_served(bounds, *motion, camera)) return std::nullopt;
  const double scale = glm::length(glm::dvec3((*motion)[0]));
  const glm::dvec3 center(*motion * glm::dvec4(bounds.center(), 1));
  const double distance = glm::length(center - camera.position());
  if (scale * impostor.texel > options_.max_texel_px * texel_angle(camera) * distance)
    return std::nullopt;
  return LayeredInstance{*motion, object + 1};
}

Result<> LayeredFrames::draw(const Camera& camera, double time) {
  camera_ = camera;
  time_ = time;
  renderer_.set_time(time);
  visible_.clear();
  renderer_.cull(camera, visible_);
  polygons_.clear();
  for (Impostor& impostor : impostors_) impostor.instances.clear();
  figures_ = {captures_, capture_ms_, figures_.picture_bytes};
  captures_ = 0;
  capture_ms_ = 0;
  for (const std::uint32_t object : visible_) {
    const std::optional<LayeredInstance> instance = instance_of(object, camera);
    if (!instance) {
      polygons_.push_back(object);
      continue;
    }
    Impostor& impostor = impostors_[std::size_t(impostor_of_[object])];
    impostor.instances.push_back(*instance);
    ++figures_.layered;
    const LayeredError error = bound_layered_error(
        impostor.baked.error, options_.layered.method == LayeredMethod::slices,
        impostor.baked.pictures.impostor().bounds, instance->world_from_impostor, camera);
    figures_.bound_px = std::max(figures_.bound_px, error.total_px);
  }
  figures_.polygons = int(polygons_.size());

  for (Impostor& impostor : impostors_)
    if (!impostor.instances.empty())
      drawer_.draw(impostor.baked.pictures, camera, impostor.instances, options_.layered);
  renderer_.draw_opaque(camera, polygons_, OutputEncoding::srgb);
  renderer_.draw_sky(camera, OutputEncoding::srgb);
  renderer_.draw_blended(camera, visible_, OutputEncoding::srgb);
  return Done{};
}

Result<> LayeredFrames::draw_objects() {
  renderer_.set_time(time_);
  for (Impostor& impostor : impostors_)
    if (!impostor.instances.empty())
      drawer_.draw_objects(impostor.baked.pictures, camera_, impostor.instances, options_.layered);
  renderer_.draw_objects(camera_, polygons_);
  return Done{};
}

}  // namespace rilievo
