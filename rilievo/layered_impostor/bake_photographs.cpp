#include "rilievo/layered_impostor/bake_photographs.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "rilievo/capture/upright.h"

namespace rilievo {
namespace {

// Two views closer than this, radians, show the same; a layered impostor refuses them below 1e-3.
constexpr double kSameView = 0.01;

// What lies just outside one photograph is inside another: an eighth more to each side leaves the
// frame of a camera that pans less to be asked of others.
Camera widened(Camera camera) {
  const int dx = camera.width / 8, dy = camera.height / 8;
  const double du = (camera.window.right - camera.window.left) / camera.width * dx;
  const double dv = (camera.window.top - camera.window.bottom) / camera.height * dy;
  camera.window.left -= du, camera.window.right += du;
  camera.window.bottom -= dv, camera.window.top += dv;
  camera.width += 2 * dx, camera.height += 2 * dy;
  return camera;
}

// Cameras whose directions are farthest apart, in the photographs' order: each next one is the
// farthest from those that were chosen.
std::vector<Camera> spread_cameras(std::span<const DepthImage> photographs, int most) {
  std::vector<double> distance(photographs.size(), 1e300);
  std::vector<bool> chosen(photographs.size(), false);
  for (int n = 0; n < most; ++n) {
    const auto farthest = std::max_element(distance.begin(), distance.end());
    if (farthest == distance.end() || *farthest < kSameView) break;
    const std::size_t next = std::size_t(farthest - distance.begin());
    chosen[next] = true;
    const glm::dvec3 direction = view_direction(photographs[next].camera);
    for (std::size_t i = 0; i < photographs.size(); ++i)
      distance[i] =
          std::min(distance[i], glm::length(view_direction(photographs[i].camera) - direction));
  }
  std::vector<Camera> cameras;
  for (std::size_t i = 0; i < photographs.size(); ++i)
    if (chosen[i]) cameras.push_back(widened(photographs[i].camera));
  return cameras;
}

Vantage vantage_of(std::span<const DepthImage> photographs, const PhotographBakeOptions& options) {
  Vantage vantage = estimate_vantage(photographs, options.reproject.box);
  if (!options.up) return vantage;
  vantage.up = glm::normalize(*options.up);
  // Who looks straight up or down has no way to go around.
  if (vantage.gaze) {
    const glm::dvec3 way = glm::normalize(vantage.gaze->target - vantage.gaze->eye);
    if (glm::length(glm::cross(way, vantage.up)) < 0.05) vantage.gaze.reset();
  }
  return vantage;
}

}  // namespace

Result<PhotographBake> bake_photographs(std::span<const DepthImage> photographs,
                                        const PhotographBakeOptions& options) {
  if (options.reproject.box.empty()) return Error{"photographs", "the box is empty"};
  std::vector<Camera> cameras;
  if (options.kind == PhotographViews::at_cameras) {
    cameras = spread_cameras(photographs, options.most_views);
  } else {
    for (const glm::dvec3& direction : make_view_set(options.views).directions) {
      Result<Camera> camera = view_camera(options.reproject.box, direction, options.camera);
      if (!camera) return camera.error();
      cameras.push_back(*camera);
    }
  }
  Reprojection made = reproject(photographs, cameras, options.reproject);
  PhotographBake bake;
  bake.stats = std::move(made.stats);
  bake.total = made.total;
  std::erase_if(made.pictures, [](const DepthImage& picture) {
    return std::all_of(picture.depth.texels().begin(), picture.depth.texels().end(),
                       [](float d) { return d == kNoDepth; });
  });
  if (made.pictures.empty())
    return Error{"photographs", "none has samples in the box that any view shows"};
  Result<LayeredImpostor> impostor =
      make_layered_impostor(std::move(made.pictures), options.slicing);
  if (!impostor) return impostor.error();
  bake.impostor = std::move(*impostor);
  bake.impostor.vantage = vantage_of(photographs, options);
  return bake;
}

}  // namespace rilievo
