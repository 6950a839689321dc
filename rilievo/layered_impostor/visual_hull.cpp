// How we differ from [Schaufler 1998]: there, what no picture holds stays open. What is done here
// is space carving [Kutulakos, Seitz 2000] with depth instead of colour, along the pictures' own
// lines of sight.

#include "rilievo/layered_impostor/visual_hull.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr int kLines = 64;  // followed in u and in v, of as many steps in depth each
// So many steps in a row may be seen to be empty: the sheets of empty space that pictures see
// through a crack are thinner, and would cut up the inside behind it.
constexpr int kThin = 1;
constexpr float kNone = 0.0f;

// The depths that lines of sight reach, every stride-th in u and v; kNone where nothing is pictured
// or nothing is behind it.
struct Lines {
  int stride = 1;
  Image<float> reach;
};

Lines follow_lines(std::span<const TexelSurface> surfaces, std::size_t view) {
  const TexelSurface& surface = surfaces[view];
  const Camera& camera = surface.camera;
  const int w = surface.texels.width(), h = surface.texels.height();
  Lines lines;
  lines.stride = std::max(1, (std::max(w, h) + kLines - 1) / kLines);
  lines.reach = Image<float>((w + lines.stride - 1) / lines.stride,
                             (h + lines.stride - 1) / lines.stride, kNone);
  const double step = (camera.z_far - camera.z_near) / kLines;
  const double away = camera.keeps_farthest() ? -step : step;
  for (int j = 0; j < lines.reach.height(); ++j)
    for (int i = 0; i < lines.reach.width(); ++i) {
      const int x = std::min(i * lines.stride + lines.stride / 2, w - 1);
      const int y = std::min(j * lines.stride + lines.stride / 2, h - 1);
      const SurfaceTexel& texel = surface.texels(x, y);
      if (texel.q == 0) continue;
      const auto hidden = [&](double eye_z) {
        const glm::dvec3 world = world_from_raster(camera, {x + 0.5, y + 0.5}, eye_z);
        return std::none_of(surfaces.begin(), surfaces.end(), [&](const TexelSurface& other) {
          return &other != &surface && is_carved(other, world);
        });
      };
      int missed = 0;
      double z = 1.0 / double(texel.q) + away;
      // Counted: the planes of a file's camera may be so close that z + away is z.
      for (int k = 0; k < kLines && z > camera.z_near && z < camera.z_far; ++k, z += away) {
        if (hidden(z))
          lines.reach(i, j) = float(z), missed = 0;
        else if (++missed > kThin)
          break;
      }
    }
  return lines;
}

}  // namespace

bool is_carved(const TexelSurface& surface, const glm::dvec3& world) {
  const glm::dvec3 at = raster_from_world(surface.camera, world);
  const int w = surface.texels.width(), h = surface.texels.height();
  if (!(at.z > 0 && at.x >= 0 && at.y >= 0 && at.x < w && at.y < h)) return false;
  const SurfaceTexel& texel = surface.texels(int(at.x), int(at.y));
  if (texel.q == 0) return true;
  const double q = surface_q(texel, glm::floor(glm::dvec2(at)) + 0.5, glm::dvec2(at));
  return surface.camera.keeps_farthest() ? 1 / at.z < q : 1 / at.z > q;
}

void find_visual_hulls(std::span<TexelSurface> surfaces) {
  std::vector<Lines> lines(surfaces.size());
  parallel_for(std::size_t(0), surfaces.size(),
               [&](std::size_t view) { lines[view] = follow_lines(surfaces, view); });
  parallel_for(std::size_t(0), surfaces.size(), [&](std::size_t view) {
    TexelSurface& surface = surfaces[view];
    const bool back = surface.camera.keeps_farthest();
    for (int y = 0; y < surface.texels.height(); ++y)
      for (int x = 0; x < surface.texels.width(); ++x) {
        SurfaceTexel& texel = surface.texels(x, y);
        texel.inside = kNone;
        if (texel.q == 0) continue;
        const float reach = lines[view].reach(x / lines[view].stride, y / lines[view].stride);
        if (reach != kNone && (back ? reach * texel.q < 1 : reach * texel.q > 1))
          texel.inside = reach;
      }
  });
}

}  // namespace rilievo
