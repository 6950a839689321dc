#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/warp/layered_warp.h"

namespace rilievo {
namespace {

// A frame's ray in a picture's eye space, from the frame's eye.
struct SliceRay {
  glm::dvec3 origin{0.0}, direction{0.0};  // direction: per unit of the frame's eye_z
};

struct View {
  const DepthImage* picture = nullptr;
  const TexelSurface* surface = nullptr;
  glm::dmat4 picture_from_world;
};

// Where the ray crosses the slice, as eye_z of the frame and texel of the picture.
struct Crossing {
  double frame_eye_z;
  glm::ivec2 texel;
};
bool cross_slice(const SliceRay& ray, const Camera& camera, const Slice& slice,
                 const TexelRect& rect, Crossing& out) {
  out.frame_eye_z = (-double(slice.eye_z) - ray.origin.z) / ray.direction.z;
  if (!(out.frame_eye_z > 0) || !std::isfinite(out.frame_eye_z)) return false;
  const glm::dvec3 p = ray.origin + out.frame_eye_z * ray.direction;
  const auto& [l, r, b, t] = camera.window;
  const double u = (p.x / slice.eye_z - l) / (r - l) * camera.width;
  const double v = (t - p.y / slice.eye_z) / (t - b) * camera.height;
  if (!(u >= rect.x0 && u < rect.x1 && v >= rect.y0 && v < rect.y1)) return false;
  out.texel = {int(u), int(v)};
  return true;
}

}  // namespace

DepthImage warp_slices(const LayeredImpostor& impostor, std::span<const SliceDraw> draws,
                       const Camera& camera, Image<int>* drawn) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  std::vector<View> views(impostor.pictures.size());
  for (const SliceDraw& draw : draws) {
    View& view = views[draw.view];
    if (view.picture) continue;
    view.picture = &impostor.pictures[draw.view];
    view.surface = &impostor.surfaces[draw.view];
    view.picture_from_world = eye_from_world(view.picture->camera);
  }

  DepthImage frame;
  frame.camera = camera;
  frame.color = ColorImage(camera.width, camera.height);
  frame.depth = Image<float>(camera.width, camera.height, kNoDepth);
  frame.object = Image<std::uint32_t>(camera.width, camera.height, kNoObject);
  if (drawn) *drawn = Image<int>(camera.width, camera.height, -1);
  tbb::parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec3 eye = camera.position();
      const glm::dvec3 along = world_from_raster(camera, {x + 0.5, y + 0.5}, 1.0) - eye;
      int ray_view = -1;
      SliceRay ray;
      for (int i = 0; i < int(draws.size()); ++i) {
        const View& view = views[draws[i].view];
        if (ray_view != draws[i].view) {
          ray_view = draws[i].view;
          ray.origin = glm::dvec3(view.picture_from_world * glm::dvec4(eye, 1));
          ray.direction = glm::dmat3(view.picture_from_world) * along;
        }
        const Slice& slice = impostor.slices[draws[i].view][draws[i].slice];
        Crossing crossing;
        if (!cross_slice(ray, view.picture->camera, slice, draws[i].rect, crossing)) continue;
        if (crossing.frame_eye_z >= frame.depth(x, y)) continue;
        const SurfaceTexel& texel = view.surface->texels(crossing.texel.x, crossing.texel.y);
        if (texel.q == 0 || !shows(slice, sliced_interval(texel, impostor.slicing))) continue;
        frame.depth(x, y) = float(crossing.frame_eye_z);
        frame.color(x, y) = view.picture->color(crossing.texel.x, crossing.texel.y);
        frame.object(x, y) = view.picture->object.empty()
                                 ? 1
                                 : view.picture->object(crossing.texel.x, crossing.texel.y);
        if (drawn) (*drawn)(x, y) = i;
      }
    }
  });
  return frame;
}

std::vector<SliceDraw> slices_for_eye(const LayeredImpostor& impostor, const glm::dvec3& eye,
                                      bool fill) {
  const ViewPick pick = pick_views(impostor.views, eye - glm::dvec3(impostor.bounds.center()));
  std::vector<SliceDraw> draws;
  const auto all_of = [&](int view) {
    for (int s = 0; s < int(impostor.slices[view].size()); ++s)
      draws.push_back({view, s, impostor.slices[view][s].rect});
  };
  all_of(pick.views[0]);
  if (!fill) return draws;
  for (int neighbor : {pick.views[1], pick.views[2]}) {
    if (neighbor < 0) continue;
    if (impostor.fills.empty()) {
      all_of(neighbor);
      continue;
    }
    for (const FillSlices& f : impostor.fills)
      if (f.view == pick.views[0] && f.neighbor == neighbor)
        for (const FillSlice& s : f.slices) draws.push_back({neighbor, s.slice, s.rect});
  }
  return draws;
}

}  // namespace rilievo
