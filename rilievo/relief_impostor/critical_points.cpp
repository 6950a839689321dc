#include "rilievo/relief_impostor/critical_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/depth.h"

namespace rilievo {
namespace {

// B of a level: its depth follows by the definition of window_z.
double nearness_at(const PictureGeometry& picture, const PlaneWarp& warp, std::uint32_t level) {
  const Camera& camera = picture.capture;
  const double delta = double(level) / delta_steps(kLevelBits);
  const double depth =
      camera.z_near * camera.z_far / (camera.z_far - delta * (camera.z_far - camera.z_near));
  return warp.nearness(depth / picture.plane_z);
}

double stretch_of_pair(const PictureGeometry& picture, const PlaneWarp& warp,
                       const CriticalPair& pair) {
  const int x2 = pair.x + (pair.across ? 1 : 0), y2 = pair.y + (pair.across ? 0 : 1);
  const double a = nearness_at(picture, warp, pair.first),
               b = nearness_at(picture, warp, pair.second);
  if (!(a > 0 && b > 0)) return std::numeric_limits<double>::infinity();
  return std::hypot(warp.x.moved(x2 + 0.5, b) - warp.x.moved(pair.x + 0.5, a),
                    warp.y.moved(y2 + 0.5, b) - warp.y.moved(pair.y + 0.5, a));
}

// Calls visit(region, pair) for all pairs.
template <class Visit>
void for_each_pair(const ImpostorPicture& picture, int regions, Visit&& visit) {
  const glm::ivec2 size = picture.max - picture.min;
  for (int y = picture.min.y; y < picture.max.y; ++y)
    for (int x = picture.min.x; x < picture.max.x; ++x) {
      if (picture.at(x, y).code == kEmptyLevel) continue;
      const int column = (x - picture.min.x) * regions / size.x,
                row = (y - picture.min.y) * regions / size.y;
      const auto region = std::size_t(row * regions + column);
      const std::uint32_t level = picture.at(x, y).code;
      if (x + 1 < picture.max.x && picture.at(x + 1, y).code != kEmptyLevel)
        visit(region, CriticalPair{x, y, true, level, picture.at(x + 1, y).code});
      if (y + 1 < picture.max.y && picture.at(x, y + 1).code != kEmptyLevel)
        visit(region, CriticalPair{x, y, false, level, picture.at(x, y + 1).code});
    }
}

void add(Stretch& sum, double stretch) {
  sum.mean += stretch;
  sum.most = std::max(sum.most, stretch);
}

}  // namespace

std::vector<CriticalPair> critical_pairs(const ImpostorPicture& picture, int regions) {
  RILIEVO_EXPECTS(regions > 0);
  struct Best {
    int difference = -1;
    CriticalPair pair;
  };
  std::vector<Best> best(std::size_t(2 * regions * regions));
  for_each_pair(picture, regions, [&](std::size_t region, const CriticalPair& pair) {
    const int difference = std::abs(int(pair.first) - int(pair.second));
    Best& found = best[2 * region + (pair.across ? 0 : 1)];
    if (difference > found.difference) found = {difference, pair};
  });
  std::vector<CriticalPair> pairs;
  for (const Best& found : best)
    if (found.difference >= 0) pairs.push_back(found.pair);
  return pairs;
}

Stretch stretch_of(const PictureGeometry& picture, std::span<const CriticalPair> pairs,
                   const PlaneWarp& warp) {
  if (pairs.empty()) return {};
  Stretch sum{0, 0};
  for (const CriticalPair& pair : pairs) add(sum, stretch_of_pair(picture, warp, pair));
  sum.mean /= double(pairs.size());
  return sum;
}

Stretch true_stretch(const ImpostorPicture& picture, int regions, const PlaneWarp& warp) {
  std::vector<double> most(std::size_t(2 * regions * regions), -1);
  for_each_pair(picture, regions, [&](std::size_t region, const CriticalPair& pair) {
    double& stretch = most[2 * region + (pair.across ? 0 : 1)];
    stretch = std::max(stretch, stretch_of_pair(picture.geometry, warp, pair));
  });
  Stretch sum{0, 0};
  int count = 0;
  for (const double stretch : most)
    if (stretch >= 0) {
      add(sum, stretch);
      ++count;
    }
  if (count == 0) return {};
  sum.mean /= count;
  return sum;
}

}  // namespace rilievo
