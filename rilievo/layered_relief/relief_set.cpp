#include "rilievo/layered_relief/relief_set.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "rilievo/render/rays/cast_layers.h"

namespace rilievo {
namespace {

glm::dvec3 center_of(const LayeredRelief& relief) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const glm::dvec3& corner : relief.hull)
    low = glm::min(low, corner), high = glm::max(high, corner);
  const glm::dvec3 middle = 0.5 * (low + high);
  return relief.frame().world(middle.x, middle.y, middle.z);
}

// Between the way to the eye and the way the relief faces; infinite if it cannot be warped.
double angle_to(const LayeredRelief& relief, const glm::dvec3& eye) {
  const auto warp = relief_warp(relief.frame(), eye);
  if (!warp || !relief_rectangle(relief, *warp)) return std::numeric_limits<double>::infinity();
  const glm::dvec3 towards = glm::normalize(eye - center_of(relief));
  return std::acos(std::clamp(glm::dot(towards, -relief.camera.forward()), -1.0, 1.0));
}

}  // namespace

double relief_stretch(const LayeredRelief& relief, const glm::dvec3& eye) {
  const auto warp = relief_warp(relief.frame(), eye);
  const auto rectangle = warp ? relief_rectangle(relief, *warp) : std::nullopt;
  if (!rectangle) return std::numeric_limits<double>::infinity();
  glm::dvec2 low(1e300), high(-1e300);
  for (const glm::dvec3& corner : relief.hull)
    low = glm::min(low, glm::dvec2(corner)), high = glm::max(high, glm::dvec2(corner));
  const glm::dvec2 now = rectangle->max - rectangle->min, source = high - low;
  return now.x * now.y / (source.x * source.y);
}

int pick_relief(const ReliefSet& set, const glm::dvec3& eye, int current, double hold) {
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < int(set.reliefs.size()); ++i) {
    const double angle = angle_to(set.reliefs[std::size_t(i)], eye) - (i == current ? hold : 0.0);
    if (angle < least) least = angle, best = i;
  }
  // None wholly: the first one in part.
  for (int i = 0; i < int(set.reliefs.size()) && best < 0; ++i)
    if (relief_warp(set.reliefs[std::size_t(i)].frame(), eye)) best = i;
  return best;
}

Result<std::vector<glm::dvec3>> relief_directions(int count) {
  switch (count) {
    case 1:
      return std::vector<glm::dvec3>{{0, 0, 1}};
    case 2:
      return std::vector<glm::dvec3>{{0, 0, 1}, {0, 0, -1}};
    case 6:
      return std::vector<glm::dvec3>{{0, 0, 1},  {0, 0, -1}, {1, 0, 0},
                                     {-1, 0, 0}, {0, 1, 0},  {0, -1, 0}};
    case 12:
      return make_view_set({.spread = ViewSpread::faces_12}).directions;
    case 20:
      return make_view_set({.spread = ViewSpread::vertices_20}).directions;
    case 32:
      return make_view_set({.spread = ViewSpread::both_32}).directions;
    default:
      return Error{"", "the number of directions must be 1, 2, 6, 12, 20 or 32, not " +
                           std::to_string(count)};
  }
}

Result<Camera> relief_camera(const Box& box, const glm::dvec3& direction, int size, double ball) {
  RILIEVO_EXPECTS(ball == 0 || ball >= 1);
  const glm::dvec3 eye = glm::dvec3(box.center()) + 3.0 * double(box.radius()) * direction;
  Result<Camera> camera = tight_camera(Projection::parallel, eye, {0, 1, 0}, box);
  if (!camera) return camera;
  ImageWindow& w = camera->window;
  if (ball > 0) {
    // A point has a window too.
    const double half = std::max(ball * double(box.radius()), 0.5 * (w.right - w.left));
    w = {-half, half, -half, half};
    camera->width = camera->height = size;
    return camera;
  }
  const double step = std::max(w.right - w.left, w.top - w.bottom) / size;
  camera->width = std::clamp(int(std::ceil((w.right - w.left) / step - 1e-9)), 1, size);
  camera->height = std::clamp(int(std::ceil((w.top - w.bottom) / step - 1e-9)), 1, size);
  w.right = w.left + step * camera->width;
  w.bottom = w.top - step * camera->height;
  return camera;
}

double relief_splat_scale(double texel, double largest) {
  return std::sqrt(std::clamp(largest / texel, 1.0, 2.0));
}

Result<ReliefSet> bake_reliefs(const RayScene& scene, std::span<const glm::dvec3> directions,
                               const ReliefBakeOptions& options) {
  ReliefSet set;
  Box box;
  for (std::size_t i = 0; i < scene.poses().size(); ++i)
    box.add(transformed(scene.poses()[i],
                        scene.scene().models[std::size_t(scene.scene().objects[i].model)].bounds));
  for (const glm::dvec3& direction : directions) {
    const Result<Camera> camera = relief_camera(box, direction, options.size, options.ball);
    if (!camera) return camera.error();
    LayeredDepthImage layers =
        cast_layers(scene, *camera, {.merge = options.merge_texels * texel_angle(*camera)});
    layers.name = scene.scene().name;
    Result<LayeredRelief> relief = build_layered_relief(layers, options.relief);
    if (!relief) return relief.error();
    relief->merged_d = std::max(relief->merged_d, options.merge_texels * texel_angle(*camera));
    set.reliefs.push_back(*std::move(relief));
  }
  return set;
}

}  // namespace rilievo
