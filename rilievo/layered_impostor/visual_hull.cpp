// How we differ from [Schaufler 1998]: there, what no picture holds stays open. What is done here
// is space carving [Kutulakos, Seitz 2000] with depth instead of colour, along the pictures' own
// lines of sight.

#include "rilievo/layered_impostor/visual_hull.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr int kLines = 64;  // followed in u and in v, of as many steps in depth each
constexpr float kNone = 0.0f;

// The steps of a line of sight: bit k is step k.
using Steps = std::uint64_t;
static_assert(kLines <= std::numeric_limits<Steps>::digits);

// Carves the space that one picture sees through; has its camera's matrix at hand, for there are
// 64 x 64 x 64 points for each pair of pictures.
class Carver {
 public:
  explicit Carver(const TexelSurface& surface) : surface_(&surface) {
    const glm::dmat4 matrix = eye_from_world(surface.camera);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) rows_[row][column] = matrix[column][row];
  }

  bool carves(const glm::dvec3& world) const {
    // As raster_from_world() computes it.
    const double eye_z = -row(2, world);
    const double scale = 1 / eye_z;
    const auto& [l, r, b, t] = surface_->camera.window;
    const int w = surface_->texels.width(), h = surface_->texels.height();
    const double u = (row(0, world) * scale - l) / (r - l) * w;
    const double v = (t - row(1, world) * scale) / (t - b) * h;
    if (!(eye_z > 0 && u >= 0 && v >= 0 && u < w && v < h)) return false;
    const int x = int(u), y = int(v);
    const SurfaceTexel& texel = surface_->texels(x, y);
    if (texel.q == 0) return true;
    const double q = surface_q(texel, {x + 0.5, y + 0.5}, {u, v});
    return surface_->camera.keeps_farthest() ? scale < q : scale > q;
  }

 private:
  double row(int i, const glm::dvec3& p) const {
    const std::array<double, 4>& m = rows_[i];
    return (m[0] * p.x + m[1] * p.y) + (m[2] * p.z + m[3]);
  }

  const TexelSurface* surface_;
  std::array<std::array<double, 4>, 3> rows_;
};

// The depths that lines of sight reach, every stride-th in u and v; kNone where nothing is pictured
// or nothing is behind it.
struct Lines {
  int stride = 1;
  Image<float> reach;
};

// The first of two steps in a row that are carved; all before it may be inside. One alone is
// passed: the sheets of empty space that pictures see through a crack are thinner than two steps,
// and would cut up the inside behind it.
int end_of(Steps carved) { return std::countr_zero(carved & carved >> 1); }

Lines follow_lines(std::span<const TexelSurface> surfaces, std::span<const Carver> carvers,
                   std::size_t view) {
  const TexelSurface& surface = surfaces[view];
  const Camera& camera = surface.camera;
  const int w = surface.texels.width(), h = surface.texels.height();
  Lines lines;
  lines.stride = std::max(1, (std::max(w, h) + kLines - 1) / kLines);
  lines.reach = Image<float>((w + lines.stride - 1) / lines.stride,
                             (h + lines.stride - 1) / lines.stride, kNone);
  const double step = (camera.z_far - camera.z_near) / kLines;
  const double away = camera.keeps_farthest() ? -step : step;
  std::array<double, kLines> depth;
  std::array<glm::dvec3, kLines> point;
  for (int j = 0; j < lines.reach.height(); ++j)
    for (int i = 0; i < lines.reach.width(); ++i) {
      const int x = std::min(i * lines.stride + lines.stride / 2, w - 1);
      const int y = std::min(j * lines.stride + lines.stride / 2, h - 1);
      const SurfaceTexel& texel = surface.texels(x, y);
      if (texel.q == 0) continue;
      // Counted: the planes of a file's camera may be so close that z + away is z.
      int steps = 0;
      for (double z = 1.0 / double(texel.q) + away;
           steps < kLines && z > camera.z_near && z < camera.z_far; z += away) {
        depth[steps] = z;
        point[steps++] = world_from_raster(camera, {x + 0.5, y + 0.5}, z);
      }
      Steps carved = 0;
      for (std::size_t other = 0; other < carvers.size(); ++other) {
        if (other == view) continue;
        for (int k = 0; k < steps; ++k)
          if (!(carved >> k & 1) && carvers[other].carves(point[k])) carved |= Steps(1) << k;
        steps = std::min(steps, end_of(carved));
      }
      while (steps > 0 && (carved >> (steps - 1) & 1)) --steps;
      if (steps > 0) lines.reach(i, j) = float(depth[steps - 1]);
    }
  return lines;
}

}  // namespace

bool is_carved(const TexelSurface& surface, const glm::dvec3& world) {
  return Carver(surface).carves(world);
}

void find_visual_hulls(std::span<TexelSurface> surfaces) {
  const std::vector<Carver> carvers(surfaces.begin(), surfaces.end());
  std::vector<Lines> lines(surfaces.size());
  parallel_for(std::size_t(0), surfaces.size(),
               [&](std::size_t view) { lines[view] = follow_lines(surfaces, carvers, view); });
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
