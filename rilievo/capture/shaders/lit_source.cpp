#include "rilievo/capture/shaders/lit_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "rilievo/capture/view_set.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/shading/sky_rays.h"
#include "rilievo/scene/scene.h"
#include "rilievo/warp/unmix_edges.h"

namespace rilievo {
namespace {

// Rays and the rasteriser take one or four.
int geometry_samples(int samples) { return samples >= 4 ? 4 : 1; }

// Depths that differ by a smaller share are one surface's.
constexpr float kOneSurface = 0.03f;
// A light that shows nothing at more of the surfaces, of at least so many texels, is another
// scene's.
constexpr double kMostMissing = 0.5;
constexpr int kLeastTexels = 64;
// The cosine of two directions that differ by rounding alone.
constexpr double kSameDirection = 1 - 1e-12;

// Whether an object can bend light, by its identifier; empty: none does.
std::vector<bool> bending_objects(const Scene* scene) {
  std::vector<bool> bends;
  if (!scene) return bends;
  for (std::size_t i = 0; i < scene->objects.size(); ++i)
    for (const Part& part : scene->models[std::size_t(scene->objects[i].model)].parts) {
      const Mesh& mesh = scene->meshes[std::size_t(part.mesh)];
      const Material& material = scene->materials[std::size_t(mesh.material)];
      if (!material.refracts || material.alpha_mode != AlphaMode::blend) continue;
      bends.resize(scene->objects.size() + 1);
      bends[i + 1] = true;
    }
  return bends;
}

// Adds light to a picture of geometry.
class LitPicture {
 public:
  LitPicture(const DepthImage& geometry, const DepthImage& light, LightOf kind)
      : geometry_(geometry), light_(light), by_depth_(kind == LightOf::scene) {}

  // The light of the surface at a texel; none if no texel beside has it either.
  [[nodiscard]] std::optional<glm::vec4> at(int x, int y) const {
    if (shows(x, y, geometry_.depth(x, y), true)) return light_.color(x, y);
    glm::vec4 sum(0.0f);
    int count = 0;
    for (int k = 0; k < 9; ++k) {
      const int u = x + k % 3 - 1, v = y + k / 3 - 1;
      if (k == 4 || u < 0 || v < 0 || u >= light_.camera.width || v >= light_.camera.height)
        continue;
      if (!shows(u, v, geometry_.depth(x, y), false)) continue;
      sum += light_.color(u, v), ++count;
    }
    if (count == 0) return std::nullopt;
    return sum / float(count);
  }

  // The share of the surfaces at which the light shows nothing.
  [[nodiscard]] double missing() const {
    int covered = 0, missed = 0;
    for (int y = 0; y < light_.camera.height; ++y)
      for (int x = 0; x < light_.camera.width; ++x) {
        if (!geometry_.covered(x, y)) continue;
        ++covered;
        missed += !light_.covered(x, y);
      }
    return covered < kLeastTexels ? 0.0 : double(missed) / covered;
  }

 private:
  // Is a texel's light that of the surface at `depth`? At the texel itself something in front may
  // have let it through, as a window pane does.
  [[nodiscard]] bool shows(int x, int y, float depth, bool own) const {
    if (!light_.covered(x, y) || !(light_.color(x, y).a > 0)) return false;
    if (!by_depth_) return true;
    const float off = light_.depth(x, y) - depth;
    return (own ? off : std::abs(off)) <= kOneSurface * depth;
  }

  const DepthImage& geometry_;
  const DepthImage& light_;
  bool by_depth_;
};

// The sky beside a silhouette has samples of what is in front: it gets the colour of the nearest
// open texel that no surface is next to, at most kReach away.
void unmix_sky(DepthImage& picture) {
  constexpr int kReach = 3;
  const int width = picture.camera.width, height = picture.camera.height;
  const auto open = [&](int x, int y) {
    for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u)
        if (picture.covered(u, v)) return false;
    return true;
  };
  const ColorImage before = picture.color;
  parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      if (picture.covered(x, y) || open(x, y)) continue;
      int nearest = 2 * kReach * kReach + 1;
      for (int v = std::max(0, y - kReach); v <= std::min(height - 1, y + kReach); ++v)
        for (int u = std::max(0, x - kReach); u <= std::min(width - 1, x + kReach); ++u) {
          const int far = (u - x) * (u - x) + (v - y) * (v - y);
          if (far >= nearest || picture.covered(u, v) || !open(u, v)) continue;
          nearest = far;
          picture.color(x, y) = before(u, v);
        }
    }
  });
}

// Where a picture shows a place; nothing if it does not. A texel shows what lies within three of
// its widths, as warps link surfaces.
std::optional<glm::vec4> seen_at(const DepthImage& picture, const glm::dvec3& place) {
  const Camera& camera = picture.camera;
  const glm::dvec3 raster = raster_from_world(camera, place);
  const int x = int(std::floor(raster.x)), y = int(std::floor(raster.y));
  if (!(raster.z > 0) || x < 0 || y < 0 || x >= camera.width || y >= camera.height)
    return std::nullopt;
  if (!picture.covered(x, y)) return std::nullopt;
  const double room =
      3 * texel_angle(camera) * (camera.projection == Projection::parallel ? 1.0 : raster.z);
  if (std::abs(double(picture.depth(x, y)) - raster.z) > room) return std::nullopt;
  return picture.color(x, y);
}

// The colour of a place for those who look at it along `towards` (unit, from the place): of those
// pictures that show it, the one from the nearest direction.
std::optional<glm::vec4> nearest_view(std::span<const DepthImage* const> pictures,
                                      const glm::dvec3& place, const glm::dvec3& towards) {
  std::optional<glm::vec4> color;
  double best = -2;
  for (const DepthImage* picture : pictures) {
    const double cosine = glm::dot(glm::normalize(picture->camera.position() - place), towards);
    if (cosine <= best) continue;
    const std::optional<glm::vec4> seen = seen_at(*picture, place);
    if (!seen || !(seen->a > 0)) continue;
    best = cosine;
    // Of the whole texel: an edge is its surface's.
    color = *seen / seen->a;
  }
  return color;
}

}  // namespace

LitSource::LitSource(CaptureSource& geometry, CaptureSource& light, const LitOptions& options)
    : geometry_(geometry), light_(light), options_(options) {
  if (options.light == LightOf::scene) bends_ = bending_objects(geometry.scene());
}

Box LitSource::bounds(std::span<const std::uint32_t> objects) const {
  // Glass is no part of what rays capture.
  return bends_.empty() ? geometry_.bounds(objects) : light_.bounds(objects);
}

// A picture that both sources can take; `samples` of the light.
Result<CapturedPicture> LitSource::lit(const CaptureRequest& request, int samples) {
  CaptureRequest of_geometry = request, of_light = request;
  of_geometry.samples = geometry_samples(request.samples);
  of_geometry.with_sky = false;
  of_geometry.identifiers = true;
  of_light.samples = samples;
  of_light.farthest = false;
  of_light.identifiers = true;
  if (options_.light == LightOf::scene) of_light.with_sky = false;
  Result<CapturedPicture> captured = geometry_.capture(of_geometry);
  if (!captured) return captured;
  DepthImage& picture = captured->picture;
  const Result<CapturedPicture> light = light_.capture(of_light);
  if (!light) return light.error();
  const LitPicture lit(picture, light->picture, options_.light);
  if (const double missing = options_.may_miss ? 0 : lit.missing(); missing > kMostMissing)
    return Error{std::string(light_.name()),
                 fmt::format("shows nothing at {:.0f} % of the surfaces: is it of another scene?",
                             100 * missing)};
  const int width = request.camera.width, height = request.camera.height;
  if (!bends_.empty())
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::uint32_t glass = light->picture.object(x, y);
        if (glass == kNoObject || !bends_[glass]) continue;
        if (picture.covered(x, y) && picture.depth(x, y) <= light->picture.depth(x, y)) continue;
        picture.depth(x, y) = light->picture.depth(x, y);
        picture.object(x, y) = glass;
      }
  const Scene* scene = geometry_.scene();
  const SkyRays rays(request.camera);
  const ColorImage own = std::move(picture.color);
  picture.color = ColorImage(width, height, glm::vec4(0));
  parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      glm::vec4& color = picture.color(x, y);
      if (picture.covered(x, y)) color = lit.at(x, y).value_or(own(x, y));
      if (!request.with_sky) continue;
      // A program's sky is opaque, if it has one.
      if (!picture.covered(x, y) && options_.light == LightOf::program)
        color = light->picture.color(x, y);
      const glm::vec3 sky = scene ? rays.radiance(scene->sky, x, height - 1 - y) : glm::vec3(0);
      color = glm::vec4(glm::vec3(color) + (1 - color.a) * sky, 1.0f);
    }
  });
  if (options_.light == LightOf::program) {
    unmix_edges(picture);
    if (request.with_sky) unmix_sky(picture);
  }
  if (!request.identifiers) picture.object = {};
  return captured;
}

// The picture from a direction, taken once.
Result<const DepthImage*> LitSource::around(const glm::dvec3& direction,
                                            std::span<const std::uint32_t> objects, int size,
                                            int samples) {
  for (const Around& known : around_)
    if (glm::dot(known.direction, direction) > kSameDirection && known.size == size &&
        known.samples == samples && std::ranges::equal(known.objects, objects))
      return known.picture.get();
  const Result<Camera> camera = view_camera(geometry_.bounds(objects), direction,
                                            {.projection = Projection::perspective, .size = size});
  if (!camera) return camera.error();
  Result<CapturedPicture> captured =
      lit({.camera = *camera, .objects = objects, .samples = samples}, samples);
  if (!captured) return captured.error();
  around_.push_back({direction,
                     {objects.begin(), objects.end()},
                     size,
                     samples,
                     std::make_unique<DepthImage>(std::move(captured->picture))});
  return around_.back().picture.get();
}

Result<std::vector<const DepthImage*>> LitSource::all_around(const glm::dvec3& direction,
                                                             std::span<const std::uint32_t> objects,
                                                             int size, int samples) {
  std::vector<glm::dvec3> directions = make_view_set({.spread = ViewSpread::faces_12}).directions;
  directions.insert(directions.begin(), direction);
  std::vector<const DepthImage*> pictures;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const int of_it = i > 0 && options_.around_samples > 0 ? options_.around_samples : samples;
    const Result<const DepthImage*> picture = around(directions[i], objects, size, of_it);
    if (!picture) return picture.error();
    pictures.push_back(*picture);
  }
  return pictures;
}

Result<CapturedPicture> LitSource::capture(const CaptureRequest& request) {
  const Camera& camera = request.camera;
  if (options_.light == LightOf::scene || !camera.keeps_farthest())
    return lit(request, light_samples(request.samples));
  CaptureRequest of_geometry = request;
  of_geometry.samples = geometry_samples(request.samples);
  Result<CapturedPicture> captured = geometry_.capture(of_geometry);
  if (!captured) return captured;
  DepthImage& picture = captured->picture;
  // It looks towards the viewers whom it serves.
  const Result<std::vector<const DepthImage*>> pictures =
      all_around(camera.forward(), request.objects, std::max(camera.width, camera.height),
                 light_samples(request.samples));
  if (!pictures) return pictures.error();
  parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      if (!picture.covered(x, y)) continue;
      const glm::dvec3 place =
          world_from_raster(camera, {x + 0.5, y + 0.5}, double(picture.depth(x, y)));
      const auto color = nearest_view(*pictures, place, glm::normalize(place - camera.position()));
      if (color) picture.color(x, y) = picture.color(x, y).a * *color;
    }
  });
  return captured;
}

Result<LayeredDepthImage> LitSource::capture_layers(const LayersRequest& request) {
  LayersRequest of_light = request;
  of_light.samples = light_samples(request.samples);
  if (options_.light == LightOf::scene) return light_.capture_layers(of_light);
  Result<LayeredDepthImage> layers = geometry_.capture_layers(request);
  if (!layers) return layers;
  const Camera& camera = request.camera;
  const bool parallel = camera.projection == Projection::parallel;
  const glm::dvec3 back = -camera.forward();
  const Result<std::vector<const DepthImage*>> pictures =
      all_around(back, request.objects, std::max(camera.width, camera.height), of_light.samples);
  if (!pictures) return pictures.error();
  parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const std::size_t texel = std::size_t(y) * std::size_t(camera.width) + std::size_t(x);
      for (std::uint64_t s = layers->first[texel]; s < layers->first[texel + 1]; ++s) {
        LayerSample& sample = layers->samples[s];
        const glm::dvec3 place =
            world_from_raster(camera, {x + 0.5, y + 0.5}, double(sample.depth));
        const auto color = nearest_view(
            *pictures, place, parallel ? back : glm::normalize(camera.position() - place));
        if (color) sample.color = sample.color.a * *color;
      }
    }
  });
  return layers;
}

}  // namespace rilievo
