#include "rilievo/layered_relief/relief_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "rilievo/layered_relief/merge_layers.h"
#include "rilievo/layered_relief/share_samples.h"

namespace rilievo {
namespace {

// A perspective picture with depths as eye_z; without what lies behind the eye, infinitely far, or
// beyond `max_depth` (0: nothing does). `nearest`: of its samples.
LayeredDepthImage by_eye_z(const LayeredDepthImage& layers, double max_depth, double& nearest) {
  LayeredDepthImage out;
  out.name = layers.name;
  out.camera = layers.camera;
  out.depth_kind = DepthKind::eye_z;
  out.first = {0};
  nearest = std::numeric_limits<double>::infinity();
  const auto width = std::size_t(layers.camera.width);
  for (std::size_t i = 0; i + 1 < layers.first.size(); ++i) {
    const glm::dvec2 at(double(i % width) + 0.5, double(i / width) + 0.5);
    for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s) {
      LayerSample sample = layers.samples[s];
      const double z = eye_z_from(layers.depth_kind, double(sample.depth), layers.camera, at);
      if (!(z > 0) || !std::isfinite(z) || (max_depth > 0 && z > max_depth)) continue;
      nearest = std::min(nearest, z);
      sample.depth = sample.back = float(z);
      out.samples.push_back(sample);
    }
    out.first.push_back(out.samples.size());
  }
  return out;
}

bool has_square_texels(const Camera& camera) {
  const ImageWindow& w = camera.window;
  const double wide = (w.right - w.left) / camera.width, high = (w.top - w.bottom) / camera.height;
  return std::abs(wide - high) <= 1e-6 * wide;
}

}  // namespace

Box bounds_of(const ReliefPictures& pictures) {
  Box box;
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    const LayeredDepthImage& layers = picture.layers;
    const auto width = std::size_t(layers.camera.width);
    for (std::size_t i = 0; i + 1 < layers.first.size(); ++i) {
      const glm::dvec2 at(double(i % width) + 0.5, double(i / width) + 0.5);
      for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s)
        box.add(glm::vec3(world_from_raster(
            layers.camera, at,
            eye_z_from(layers.depth_kind, layers.samples[s].depth, layers.camera, at))));
    }
  }
  return box;
}

std::uint32_t only_object(const ReliefPictures& pictures) {
  std::uint32_t only = kNoObject;
  for (const ReliefPictures::Picture& picture : pictures.pictures)
    for (const LayerSample& sample : picture.layers.samples) {
      if (sample.object == kNoObject || sample.object == only) continue;
      if (only != kNoObject) return kNoObject;
      only = sample.object;
    }
  return only;
}

Result<ReliefPictures> capture_relief_pictures(CaptureSource& source,
                                               std::span<const std::uint32_t> objects,
                                               const ReliefCaptureOptions& options,
                                               const ReliefProgress& progress) {
  const Result<std::vector<glm::dvec3>> directions = relief_directions(options.textures);
  if (!directions) return directions.error();
  const Box box = source.bounds(objects);
  if (box.empty()) return Error{std::string(source.name()), "has nothing to take pictures of"};
  ReliefPictures made;
  for (const glm::dvec3& direction : *directions) {
    const Result<Camera> camera = relief_camera(box, direction, options.size, options.ball);
    if (!camera) return camera.error();
    const double merge = options.merge_texels * texel_angle(*camera);
    Result<LayeredDepthImage> layers =
        source.capture_layers({.camera = *camera, .objects = objects, .merge = merge});
    if (!layers) return layers.error();
    if (progress) progress(int(made.pictures.size()) + 1, int(directions->size()));
    made.pictures.push_back({*std::move(layers), merge, 0, 0});
  }
  if (options.share_texels > 0) share_samples(made, options.share_texels);
  made.bounds = bounds_of(made);
  if (made.bounds.empty()) return Error{std::string(source.name()), "shows nothing"};
  made.strokes = source.stroke_size(objects);
  return made;
}

Result<ReliefPictures> adopt_relief_pictures(std::span<const LayeredDepthImage> deep,
                                             const ReliefCaptureOptions& options) {
  ReliefPictures made;
  for (const LayeredDepthImage& layers : deep) {
    if (layers.camera.projection == Projection::back_perspective)
      return Error{layers.name, "is a back-perspective deep image, which cannot be warped"};
    ReliefPictures::Picture picture;
    double per_metre = 1;
    if (layers.camera.projection == Projection::parallel) {
      picture.layers = layers;
      picture.merged = options.merge_texels * texel_angle(layers.camera);
      if (layers.depth_kind == DepthKind::window_z)
        per_metre = 1 / (layers.camera.z_far - layers.camera.z_near);
    } else {
      double nearest = 0;
      // Fog becomes surfaces while its lines of sight are still those that it was seen along.
      picture.layers = by_eye_z(gather_layers(layers, LayeredReliefOptions{}.least_alpha),
                                options.max_depth, nearest);
      // Texels are as large as where they are smallest.
      picture.merged = options.merge_texels * texel_angle(layers.camera) * nearest;
    }
    picture.layers = merge_layers(picture.layers, picture.merged * per_metre);
    made.pictures.push_back(std::move(picture));
  }
  made.bounds = bounds_of(made);
  if (made.bounds.empty()) return Error{"", "shows nothing"};
  return made;
}

Result<ReliefSet> make_relief_set(const ReliefPictures& pictures, bool identifiers) {
  ReliefSet set;
  // Texels of perspective pictures have no size of their own, and of those that are not square one
  // number does not tell how large splats are. Empty pictures make no relief.
  double largest = 0;
  bool parallel = true;
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    if (!picture.layers.samples.empty())
      largest = std::max(largest, texel_angle(picture.layers.camera));
    parallel = parallel && picture.layers.camera.projection == Projection::parallel &&
               has_square_texels(picture.layers.camera);
  }
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    Result<LayeredRelief> relief =
        build_layered_relief(picture.layers, {.identifiers = identifiers});
    if (!relief) {
      // Seen from this side there is nothing, as of a wall from beside.
      if (picture.layers.samples.empty()) continue;
      return relief.error();
    }
    relief->merged_d = std::max(relief->merged_d, picture.merged);
    if (parallel)
      relief->splat_scale = relief_splat_scale(texel_angle(picture.layers.camera), largest);
    set.reliefs.push_back(*std::move(relief));
  }
  if (set.reliefs.empty()) return Error{"", "has no samples"};
  return set;
}

}  // namespace rilievo
