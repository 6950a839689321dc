
#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_impostor/warp.h"

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
  parallel_for(0, camera.height, [&](int y) {
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

void slices_of_view(const LayeredImpostor& impostor, int view, const glm::dvec3& eye, bool fill,
                    std::vector<SliceDraw>& draws) {
  const std::vector<Slice>& own = impostor.slices[view];
  const bool back = impostor.pictures[view].camera.keeps_farthest();
  for (int i = 0; i < int(own.size()); ++i) {
    const int s = back ? int(own.size()) - 1 - i : i;
    draws.push_back({view, s, own[s].rect});
  }
  if (!fill) return;
  const ViewPick pick =
      pick_views_around(impostor.views, view, eye - glm::dvec3(impostor.bounds.center()));
  for (int neighbor : {pick.views[1], pick.views[2]}) {
    if (neighbor < 0) continue;
    if (impostor.fills.empty())
      for (int s = 0; s < int(impostor.slices[neighbor].size()); ++s)
        draws.push_back({neighbor, s, impostor.slices[neighbor][s].rect});
    const auto pair = std::partition_point(
        impostor.fills.begin(), impostor.fills.end(), [&](const FillSlices& f) {
          return std::pair(f.view, f.neighbor) < std::pair(view, neighbor);
        });
    if (pair == impostor.fills.end() || pair->view != view || pair->neighbor != neighbor) continue;
    for (const FillSlice& s : pair->slices) draws.push_back({neighbor, s.slice, s.rect});
  }
}

std::vector<SliceDraw> slices_for_eye(const LayeredImpostor& impostor, const glm::dvec3& eye,
                                      bool fill) {
  std::vector<SliceDraw> draws;
  int nearest = 0;
  nearest_views(impostor.views, eye - glm::dvec3(impostor.bounds.center()), {&nearest, 1});
  slices_of_view(impostor, nearest, eye, fill, draws);
  return draws;
}

}  // namespace rilievo
