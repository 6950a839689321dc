// Cf. [Schaufler 1998], section 3.5, "Avoiding holes".
//
// How we differ: the paper draws the slices of both views together and keeps those of the
// neighbour that show. Two stacks of slices stand for one surface and fight for it, so that nearly
// all of them show somewhere. Here holes are told from surface by the walk that needs no slices:
// a ray that meets the view's surface, or meets nothing without having passed behind an edge, saw
// no hole. And of a slice only the rectangle that shows is kept.

#include <algorithm>

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

// Directions of the eyes for one pair.
std::vector<glm::dvec3> border_directions(const ViewSet& views, int view, int neighbor) {
  std::vector<glm::dvec3> from{views.directions[view] + views.directions[neighbor]};
  for (const auto& t : views.triangles)
    if (std::count(t.begin(), t.end(), view) && std::count(t.begin(), t.end(), neighbor))
      from.push_back(views.directions[t[0]] + views.directions[t[1]] + views.directions[t[2]]);
  // Two opposite views have nothing between them.
  std::erase_if(from, [](const glm::dvec3& d) { return glm::length(d) < 1e-6; });
  return from;
}

// The neighbour's slices that hold what `eye` sees of it through the view's holes.
void find_from(const LayeredImpostor& impostor, const Camera& camera, int view, int neighbor,
               std::vector<TexelRect>& rects) {
  const std::vector<Slice>& slices = impostor.slices[neighbor];
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const std::optional<PixelRay> ray = pixel_ray(impostor.bounds, camera, {x + 0.5, y + 0.5});
      if (!ray) continue;
      // Patches that are linked but do not meet are not open in slices.
      if (!march_picture(impostor, view, *ray).passed_end) continue;
      const SurfaceHit seen = march_picture(impostor, neighbor, *ray);
      if (!seen.hit) continue;
      const SurfaceTexel& texel = impostor.surfaces[neighbor].texels(seen.texel.x, seen.texel.y);
      const DepthInterval interval = piece_interval(texel, impostor.slicing);
      for (std::size_t s = 0; s < slices.size(); ++s)
        if (shows(slices[s], interval)) add_texel(seen.texel, rects[s]);
    }
}

}  // namespace

void find_fill_slices(LayeredImpostor& impostor, const FillOptions& options) {
  std::vector<FillSlices> fills = neighbor_pairs(impostor.views);
  const glm::dvec3 center(impostor.bounds.center());
  const double reach = options.distance * impostor.bounds.radius();
  parallel_for(std::size_t(0), fills.size(), [&](std::size_t i) {
    FillSlices& fill = fills[i];
    std::vector<TexelRect> rects(impostor.slices[fill.neighbor].size());
    for (const glm::dvec3& direction :
         border_directions(impostor.views, fill.view, fill.neighbor)) {
      Result<Camera> camera =
          tight_camera(Projection::perspective, center + glm::normalize(direction) * reach,
                       {0, 1, 0}, impostor.bounds);
      if (!camera) continue;
      camera->width = camera->height = options.size;
      find_from(impostor, *camera, fill.view, fill.neighbor, rects);
    }
    for (int s = 0; s < int(rects.size()); ++s)
      if (rects[s].x1 > 0) fill.slices.push_back({s, rects[s]});
  });
  impostor.fills = std::move(fills);
}

}  // namespace rilievo
