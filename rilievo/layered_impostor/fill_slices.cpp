// Cf. [Schaufler 1998], section 3.5, "Avoiding holes".
//
// How we differ: the paper draws the slices of both views together and keeps those of the
// neighbour that show. Two stacks of slices stand for one surface and fight for it, so that nearly
// all of them show somewhere. Here holes are told from surface by the walk that needs no slices:
// a ray that meets the view's surface, or meets nothing without having passed behind an edge, saw
// no hole. And of a slice only the rectangle that shows is kept.

#include <algorithm>
#include <span>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_impostor/pixel_march.h"
#include "rilievo/layered_impostor/warp.h"

namespace rilievo {
namespace {

void add_texel(const glm::ivec2& texel, TexelRect& rect) {
  rect = rect.x1 == 0 ? TexelRect{texel.x, texel.y, texel.x + 1, texel.y + 1}
                      : TexelRect{std::min(rect.x0, texel.x), std::min(rect.y0, texel.y),
                                  std::max(rect.x1, texel.x + 1), std::max(rect.y1, texel.y + 1)};
}

// A view's holes as an eye on the border of its region sees them, and the neighbours that may fill
// them.
struct BorderEye {
  glm::dvec3 direction{0.0};
  std::vector<FillSlices*> fills;
};

// Of the pairs of one view. Two pairs share the eye between three views.
std::vector<BorderEye> border_eyes(const ViewSet& views, std::span<FillSlices> pairs) {
  const auto& d = views.directions;
  std::vector<BorderEye> eyes;
  for (FillSlices& pair : pairs)
    eyes.push_back({d[std::size_t(pair.view)] + d[std::size_t(pair.neighbor)], {&pair}});
  for (const auto& t : views.triangles) {
    BorderEye eye{d[std::size_t(t[0])] + d[std::size_t(t[1])] + d[std::size_t(t[2])], {}};
    for (FillSlices& pair : pairs)
      if (std::count(t.begin(), t.end(), pair.view) &&
          std::count(t.begin(), t.end(), pair.neighbor))
        eye.fills.push_back(&pair);
    if (!eye.fills.empty()) eyes.push_back(std::move(eye));
  }
  // Two opposite views have nothing between them.
  std::erase_if(eyes, [](const BorderEye& eye) { return glm::length(eye.direction) < 1e-6; });
  return eyes;
}

// The neighbours' slices that hold what the camera sees of them through the view's holes, one list
// of rectangles for each of the eye's pairs.
void find_from(const LayeredImpostor& impostor, const Camera& camera, const BorderEye& eye,
               std::span<std::vector<TexelRect>* const> rects) {
  const int view = eye.fills.front()->view;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const std::optional<PixelRay> ray = pixel_ray(impostor.bounds, camera, {x + 0.5, y + 0.5});
      if (!ray) continue;
      // Patches that are linked but do not meet are not open in slices.
      if (!march_picture(impostor, view, *ray).passed_end) continue;
      for (std::size_t k = 0; k < eye.fills.size(); ++k) {
        const auto neighbor = std::size_t(eye.fills[k]->neighbor);
        const SurfaceHit seen = march_picture(impostor, int(neighbor), *ray);
        if (!seen.hit) continue;
        const SurfaceTexel& texel = impostor.surfaces[neighbor].texels(seen.texel.x, seen.texel.y);
        const DepthInterval interval = piece_interval(texel, impostor.slicing);
        const std::vector<Slice>& slices = impostor.slices[neighbor];
        for (std::size_t s = 0; s < slices.size(); ++s)
          if (shows(slices[s], interval)) add_texel(seen.texel, (*rects[k])[s]);
      }
    }
}

// Of the pairs of one view.
void find_of_view(const LayeredImpostor& impostor, const FillOptions& options,
                  std::span<FillSlices> pairs) {
  const glm::dvec3 center(impostor.bounds.center());
  const double reach = options.distance * impostor.bounds.radius();
  std::vector<std::vector<TexelRect>> rects;
  for (const FillSlices& pair : pairs)
    rects.emplace_back(impostor.slices[std::size_t(pair.neighbor)].size());
  for (const BorderEye& eye : border_eyes(impostor.views, pairs)) {
    Result<Camera> camera =
        tight_camera(Projection::perspective, center + glm::normalize(eye.direction) * reach,
                     {0, 1, 0}, impostor.bounds);
    if (!camera) continue;
    camera->width = camera->height = options.size;
    std::vector<std::vector<TexelRect>*> of_eye;
    for (const FillSlices* pair : eye.fills)
      of_eye.push_back(&rects[std::size_t(pair - pairs.data())]);
    find_from(impostor, *camera, eye, of_eye);
  }
  for (std::size_t k = 0; k < pairs.size(); ++k)
    for (int s = 0; s < int(rects[k].size()); ++s)
      if (const TexelRect& rect = rects[k][std::size_t(s)]; rect.x1 > 0)
        pairs[k].slices.push_back({s, rect});
}

}  // namespace

void find_fill_slices(LayeredImpostor& impostor, const FillOptions& options) {
  std::vector<FillSlices> fills = neighbor_pairs(impostor.views);
  // Ascending, so that a view's pairs follow each other.
  std::vector<std::span<FillSlices>> of_views;
  for (std::size_t first = 0, end = 0; first < fills.size(); first = end) {
    while (end < fills.size() && fills[end].view == fills[first].view) ++end;
    of_views.emplace_back(fills.data() + first, end - first);
  }
  parallel_for(std::size_t(0), of_views.size(),
               [&](std::size_t i) { find_of_view(impostor, options, of_views[i]); });
  impostor.fills = std::move(fills);
}

}  // namespace rilievo
