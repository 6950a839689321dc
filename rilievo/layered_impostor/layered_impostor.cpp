// Cf. [Schaufler 1998], sections 3.2 to 3.5.
//
// How we differ: slices divide the range that the samples take, not the whole frustum, and stand
// evenly in eye_z (see SliceSpacing). The paper's texel has the depth of its sample, so that a
// surface steeper than a slice a texel is torn unless the overlap is large, and a large overlap
// swells every outline; here it has the depths of its piece of surface. The paper's alpha test
// needs a power of two of layers; here any number will do.

#include "rilievo/layered_impostor/layered_impostor.h"

#include <algorithm>
#include <cmath>

#include "rilievo/layered_impostor/see_through.h"
#include "rilievo/layered_impostor/visual_hull.h"
#include "rilievo/warp/texel_links.h"

namespace rilievo {
namespace {

struct Range {
  float nearest = kNoDepth, farthest = -kNoDepth;
};

// Neighbours of more are not looked for in reasonable time, nor would anybody want them.
constexpr std::size_t kMaxViews = 1024;
constexpr double kSameDirection = 1e-3;

// The bounds between layers: edge[i] to edge[i + 1] is layer i, or between, for fractions.
float layer_edge(const Range& range, const SliceOptions& options, float i) {
  const float t = i / float(options.layers);
  if (options.spacing == SliceSpacing::eye_z)
    return range.nearest + t * (range.farthest - range.nearest);
  // window_z is affine in 1 / eye_z.
  const float q = 1 / range.nearest + t * (1 / range.farthest - 1 / range.nearest);
  return q > 0 ? 1 / q : kNoDepth;
}

bool lacks_samples(const DepthImage& picture) {
  for (int y = 0; y < picture.depth.height(); ++y)
    for (int x = 0; x < picture.depth.width(); ++x)
      if (!picture.covered(x, y) && picture.color(x, y).a > 0) return true;
  return false;
}

// Of the samples: their pieces may reach over the edge of a picture that is tight around the
// object.
bool holds(const Camera& camera, const Box& bounds) {
  constexpr double kSlack = 2;
  for (const glm::vec3& corner : bounds.corners()) {
    const glm::dvec3 at = raster_from_world(camera, glm::dvec3(corner));
    if (!(at.z > 0) || at.x < -kSlack || at.y < -kSlack || at.x > camera.width + kSlack ||
        at.y > camera.height + kSlack)
      return false;
  }
  return true;
}

}  // namespace

// Which neighbours are one surface? What lies between two samples is off by up to half their step
// in depth, the more the steeper the surface is to the view. Where views lie all around, another
// view sees it better then: one within the covering angle, and what the camera's perspective adds,
// of facing it. So the surface ends where it is steeper than that, and pixels look it up in other
// views. Frames of a teapot and a jug are as near to the truth as without a limit, or nearer; with
// smaller limits, slices are not.
LinkOptions view_links(const ViewSet& views) {
  constexpr double kAllAround = 0.8;  // radians: 12 views and more
  if (covering_angle(views) > kAllAround) return {};
  LinkOptions links;
  links.gentle = 4.0f;
  links.steepest = 5.0f;
  return links;
}

glm::dvec3 view_direction(const Camera& camera) {
  return glm::normalize(camera.keeps_farthest() ? camera.forward() : -camera.forward());
}

DepthInterval piece_interval(const SurfaceTexel& texel, const SliceOptions& options) {
  return options.pieces ? depth_interval(texel) : DepthInterval{1 / texel.q, 1 / texel.q};
}

DepthInterval sliced_interval(const SurfaceTexel& texel, const SliceOptions& options) {
  DepthInterval interval = piece_interval(texel, options);
  if (!options.pieces || texel.inside == 0) return interval;
  interval.front = std::min(interval.front, texel.inside);
  interval.back = std::max(interval.back, texel.inside);
  return interval;
}

std::vector<Slice> slice_surface(const TexelSurface& surface, const SliceOptions& options) {
  RILIEVO_EXPECTS(options.layers >= 1 && options.layers <= 4096);
  RILIEVO_EXPECTS(options.overlap >= 0 && options.overlap <= float(options.layers));
  Range range;
  for (const SurfaceTexel& texel : surface.texels.texels()) {
    if (texel.q == 0) continue;
    const DepthInterval interval = piece_interval(texel, options);
    range.nearest = std::min(range.nearest, interval.front);
    range.farthest = std::max(range.farthest, interval.back);
  }
  if (range.nearest == kNoDepth) return {};
  // Intervals are half open: the last must hold the farthest sample.
  range.farthest = std::nextafter(range.farthest * 1.000001f, kNoDepth);

  std::vector<Slice> slices(options.layers);
  const float reach = 0.5f * options.overlap;
  for (int i = 0; i < options.layers; ++i) {
    slices[i].layer = i;
    slices[i].eye_z = layer_edge(range, options, float(i) + 0.5f);
    slices[i].front = layer_edge(range, options, std::max(0.0f, float(i) - reach));
    slices[i].back =
        layer_edge(range, options, std::min(float(options.layers), float(i) + 1 + reach));
  }
  // Rounding must not leave a gap at either end.
  slices.front().front = range.nearest;
  slices.back().back = range.farthest;

  // Both ends ascend with the layer: the layers of a texel are one run.
  for (int y = 0; y < surface.texels.height(); ++y)
    for (int x = 0; x < surface.texels.width(); ++x) {
      const SurfaceTexel& texel = surface.texels(x, y);
      if (texel.q == 0) continue;
      const DepthInterval interval = sliced_interval(texel, options);
      auto slice = std::partition_point(slices.begin(), slices.end(),
                                        [&](const Slice& s) { return s.back <= interval.front; });
      for (; slice != slices.end() && shows(*slice, interval); ++slice) {
        TexelRect& r = slice->rect;
        r = r.x1 == 0 ? TexelRect{x, y, x + 1, y + 1}
                      : TexelRect{std::min(r.x0, x), std::min(r.y0, y), std::max(r.x1, x + 1),
                                  std::max(r.y1, y + 1)};
      }
    }
  std::erase_if(slices, [](const Slice& s) { return s.rect.x1 == 0; });
  return slices;
}

Result<LayeredImpostor> make_layered_impostor(std::vector<DepthImage> pictures,
                                              const SliceOptions& options) {
  if (pictures.empty()) return Error{"layered impostor", "there is no picture"};
  if (pictures.size() > kMaxViews)
    return Error{"layered impostor", "it has more than " + std::to_string(kMaxViews) + " views"};
  LayeredImpostor impostor;
  impostor.slicing = options;
  std::vector<glm::dvec3> directions;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const DepthImage& picture = pictures[i];
    const std::string where = "picture " + std::to_string(i);
    if (Result<> valid = validate(picture); !valid) return Error{where, valid.error().message()};
    if (picture.camera.projection == Projection::parallel)
      return Error{where, "its camera is parallel"};
    directions.push_back(view_direction(picture.camera));
    for (std::size_t k = 0; k < i; ++k)
      if (glm::length(directions[k] - directions[i]) < kSameDirection)
        return Error{where, "it looks the same way as picture " + std::to_string(k)};
  }
  impostor.views = view_set_from_directions(std::move(directions));

  const LinkOptions links = view_links(impostor.views);
  Box samples;  // without the pieces around them, which reach over the edges
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const DepthImage& picture = pictures[i];
    const Image<float> eye_z = eye_z_of(picture);
    for (float d : eye_z.texels())
      if (!(d > 0)) return Error{"picture " + std::to_string(i), "a sample lies behind the camera"};
    TexelSurface surface = make_texel_surface(picture, links);
    for (int y = 0; y < eye_z.height(); ++y)
      for (int x = 0; x < eye_z.width(); ++x) {
        if (eye_z(x, y) == kNoDepth) continue;
        samples.add(
            glm::vec3(world_from_raster(picture.camera, {x + 0.5, y + 0.5}, double(eye_z(x, y)))));
        // A sample stands for a piece of surface over its whole texel.
        const DepthInterval interval = depth_interval(surface.texels(x, y));
        for (int corner = 0; corner < 8; ++corner)
          impostor.bounds.add(
              glm::vec3(world_from_raster(picture.camera, {x + (corner & 1), y + (corner >> 1 & 1)},
                                          corner & 4 ? interval.front : interval.back)));
      }
    impostor.surfaces.push_back(std::move(surface));
  }
  if (impostor.bounds.empty()) return Error{"layered impostor", "all pictures are empty"};
  for (const DepthImage& picture : pictures)
    impostor.complete.push_back(holds(picture.camera, samples) && !lacks_samples(picture));
  // What hardly anybody looks at hides nothing of itself; and pictures that leave parts out, as
  // photographs do, do not know what is inside.
  if (options.pieces && impostor.surfaces.size() >= 4 &&
      std::find(impostor.complete.begin(), impostor.complete.end(), false) ==
          impostor.complete.end())
    find_visual_hulls(impostor.surfaces);
  impostor.sees_through = find_seeing_through(impostor.views, impostor.surfaces);
  for (std::size_t i = 0; i < pictures.size(); ++i)
    if (!impostor.complete[i])
      impostor.sees_through[i] = false;
    else if (impostor.sees_through[i])
      impostor.complete[i] = false;
  for (const TexelSurface& surface : impostor.surfaces)
    impostor.slices.push_back(slice_surface(surface, options));
  // A file's parts may name objects or not; here all do or none does.
  if (std::any_of(pictures.begin(), pictures.end(),
                  [](const DepthImage& picture) { return !picture.object.empty(); }))
    for (DepthImage& picture : pictures)
      if (picture.object.empty())
        picture.object =
            Image<std::uint32_t>(picture.camera.width, picture.camera.height, kNoObject);
  impostor.pictures = std::move(pictures);
  return impostor;
}

std::vector<FillSlices> neighbor_pairs(const ViewSet& views) {
  std::vector<FillSlices> pairs;
  for (const auto& edge : views.edges) {
    pairs.push_back({edge[0], edge[1], {}});
    pairs.push_back({edge[1], edge[0], {}});
  }
  std::sort(pairs.begin(), pairs.end(), [](const FillSlices& a, const FillSlices& b) {
    return std::pair(a.view, a.neighbor) < std::pair(b.view, b.neighbor);
  });
  return pairs;
}

LayeredStats analyze_layered_impostor(const LayeredImpostor& impostor) {
  LayeredStats stats;
  double full = 0, kept = 0;
  for (std::size_t v = 0; v < impostor.pictures.size(); ++v) {
    const DepthImage& picture = impostor.pictures[v];
    const std::size_t texels = picture.depth.texels().size();
    for (float d : picture.depth.texels()) stats.covered_texels += d != kNoDepth;
    stats.slices += impostor.slices[v].size();
    full += double(texels) * impostor.slicing.layers;
    for (const Slice& slice : impostor.slices[v]) kept += double(slice.rect.area());
    stats.paper_bytes += 4 * texels;
  }
  stats.empty_slices =
      std::size_t(impostor.slicing.layers) * impostor.pictures.size() - stats.slices;
  stats.fill_share = kept / full;
  stats.fill_saved = 1 - stats.fill_share;
  for (const FillSlices& fill : impostor.fills) {
    double texels = 0, all = 0;
    for (const FillSlice& slice : fill.slices) texels += double(slice.rect.area());
    for (const Slice& slice : impostor.slices[fill.neighbor]) all += double(slice.rect.area());
    stats.hole_slices += double(fill.slices.size()) / double(impostor.fills.size());
    if (all > 0) stats.hole_fill_share += texels / all / double(impostor.fills.size());
  }
  return stats;
}

}  // namespace rilievo
