#include "rilievo/draw/layered_frames.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>

namespace rilievo {
namespace {

// An eye nearer than so many radii to the centre of the ball around an object sees sides of it that
// the nearest pictures were not made for.
constexpr double kNearRadii = 1.2;

// Objects that one impostor serves, ascending; the first is the one that is baked.
struct Group {
  std::vector<std::uint32_t> objects;
  double triangles = 0;  // drawn, all objects together
};

// Same model, and the same pose but for a translation.
using GroupKey = std::array<float, 10>;
GroupKey key_of(int model, const glm::mat4& pose) {
  GroupKey key{};
  for (int i = 0; i < 9; ++i) key[std::size_t(i)] = pose[i / 3][i % 3];
  key[9] = float(model);
  return key;
}

bool is_invertible(const glm::mat4& pose) {
  const double d = glm::determinant(glm::dmat3(pose));
  return std::isfinite(d) && d != 0;
}

// Heavy objects, those first whose impostor saves most triangles.
std::vector<Group> heavy_groups(const SceneRenderer& renderer, std::uint64_t min_triangles) {
  const Scene& scene = renderer.scene();
  std::map<GroupKey, Group> by_key;
  for (std::uint32_t object = 0; object < scene.objects.size(); ++object) {
    const int model = scene.objects[object].model;
    const glm::mat4& pose = renderer.poses()[object];
    const std::uint64_t triangles = scene.models[std::size_t(model)].triangles;
    if (triangles < min_triangles || !renderer.has_opaque_parts(object) || !is_invertible(pose))
      continue;
    Group& group = by_key[key_of(model, pose)];
    group.objects.push_back(object);
    group.triangles += double(triangles);
  }
  std::vector<Group> groups;
  for (auto& [key, group] : by_key) groups.push_back(std::move(group));
  std::sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
    return a.triangles != b.triangles ? a.triangles > b.triangles
                                      : a.objects.front() < b.objects.front();
  });
  return groups;
}

// By how much a motion scales, if it does so alike in all directions.
std::optional<double> uniform_scale(const glm::dmat4& motion) {
  const glm::dmat3 m(motion);
  const glm::dmat3 square = glm::transpose(m) * m;
  const double scale2 = (square[0][0] + square[1][1] + square[2][2]) / 3;
  // Poses are floats: their rounding is no stretch.
  constexpr double kRounding = 1e-4;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(square[i][k] - (i == k ? scale2 : 0)) <= kRounding * scale2))
        return std::nullopt;
  if (glm::determinant(m) <= 0) return std::nullopt;
  return std::sqrt(scale2);
}

// The size of a view's texels where they show the centre, the coarsest view's.
double texel_at(const LayeredImpostor& impostor, const glm::dvec3& center) {
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
  BakeOptions bake = options.bake;
  bake.fills = options.layered.method == LayeredMethod::slices;
  const int views = int(make_view_set(bake.views).directions.size());
  const std::size_t bytes =
      layered_texture_bytes(views, bake.camera.size, bake.camera.size, options.layered.method);
  std::vector<Group> groups = heavy_groups(renderer, options.min_triangles);
  groups.resize(std::min(groups.size(), options.max_bytes / bytes));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::uint32_t baked = groups[g].objects.front();
    if (options.bake.progress)
      bake.progress = [&](int done, int) {
        options.bake.progress(int(g) * views + done, int(groups.size()) * views);
      };
    Result<LayeredImpostor> impostor = bake_layered(renderer, {&baked, 1}, bake);
    if (!impostor) continue;
    const glm::dvec3 center(impostor->bounds.center());
    const double radius = impostor->bounds.radius(), texel = texel_at(*impostor, center);
    Result<LayeredPictures> pictures = LayeredPictures::create(std::move(*impostor));
    if (!pictures) return pictures.error();
    pictures->keep_only(options.layered.method);
    for (const std::uint32_t object : groups[g].objects)
      frames.impostor_of_[object] = int(frames.impostors_.size());
    frames.figures_.picture_bytes += pictures->bytes();
    frames.impostors_.push_back({std::move(*pictures),
                                 glm::inverse(glm::dmat4(renderer.poses()[baked])), center, radius,
                                 texel});
    frames.captures_ += views;
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
  const glm::dmat4 motion = glm::dmat4(renderer_.poses()[object]) * impostor.object_from_impostor;
  const std::optional<double> scale = uniform_scale(motion);
  if (!scale) return std::nullopt;
  const glm::dvec3 center(motion * glm::dvec4(impostor.center, 1));
  const double distance = glm::length(center - camera.position());
  if (distance < kNearRadii * *scale * impostor.radius) return std::nullopt;
  if (*scale * impostor.texel > options_.max_texel_px * texel_angle(camera) * distance)
    return std::nullopt;
  return LayeredInstance{motion, object + 1};
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
    impostors_[std::size_t(impostor_of_[object])].instances.push_back(*instance);
    ++figures_.pictures;
  }
  figures_.polygons = int(polygons_.size());

  for (Impostor& impostor : impostors_)
    if (!impostor.instances.empty())
      drawer_.draw(impostor.pictures, camera, impostor.instances, options_.layered);
  renderer_.draw_opaque(camera, polygons_, OutputEncoding::srgb);
  renderer_.draw_sky(camera, OutputEncoding::srgb);
  renderer_.draw_blended(camera, visible_, OutputEncoding::srgb);
  return Done{};
}

Result<> LayeredFrames::draw_objects() {
  renderer_.set_time(time_);
  for (Impostor& impostor : impostors_)
    if (!impostor.instances.empty())
      drawer_.draw_objects(impostor.pictures, camera_, impostor.instances, options_.layered);
  renderer_.draw_objects(camera_, polygons_);
  return Done{};
}

}  // namespace rilievo
