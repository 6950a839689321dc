#include "rilievo/environment_nodes/fit_sky.h"

#include <algorithm>

#include "rilievo/render/shading/shading_model.h"

namespace rilievo {
namespace {

// Of the weight of all directions: what the mean colour counts. Small beside what was seen of a
// share, large beside rounding.
constexpr double kPrior = 1e-3;

}  // namespace

glm::dvec3 sky_shares(double elevation) {
  // What a sky shows whose colours are one each.
  constexpr Sky kShares{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto shares = shading_model::sky_radiance(kShares, float(elevation));
  return {shares.x, shares.y, shares.z};
}

void SkySums::add(const glm::dvec3& direction, const glm::vec3& color_seen, double steradians) {
  const glm::dvec3 shares = sky_shares(direction.y);
  const glm::dvec3 cut = glm::clamp(glm::dvec3(color_seen), 0.0, 1.0);
  weight += steradians;
  products += steradians * glm::outerProduct(shares, shares);
  by_channel += steradians * glm::outerProduct(shares, cut);
  color += steradians * cut;
}

SkySums& SkySums::operator+=(const SkySums& other) {
  weight += other.weight;
  products += other.products;
  by_channel += other.by_channel;
  color += other.color;
  return *this;
}

SkySums sky_sums(const EnvironmentMap& map) {
  SkySums sums;
  for (const DepthImage& face : map.faces) {
    const Camera& camera = face.camera;
    const double side = 2.0 / camera.width;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        if (face.covered(x, y) || !(face.color(x, y).a > 0)) continue;
        const glm::dvec3 at = world_from_raster(camera, {x + 0.5, y + 0.5}, 1.0);
        const glm::dvec3 to = at - camera.position();
        const double far = glm::length(to);
        // A texel of the plane at eye_z == 1, seen from the eye.
        sums.add(to / far, glm::vec3(face.color(x, y)), side * side / (far * far * far));
      }
  }
  return sums;
}

// Minimises, for each channel c with the colours k = (zenith, horizon, ground) of that channel,
//
//   sum w (shares . k - color)^2  +  prior |k - mean|^2,    mean = sum w color / sum w
//
// whose normal equations are (products + prior) k = by_channel + prior mean.
std::optional<Sky> fit_sky(const SkySums& sums) {
  if (!(sums.weight > 0)) return std::nullopt;
  const double prior = kPrior * sums.weight;
  const glm::dvec3 mean = sums.color / sums.weight;
  const glm::dmat3 inverse = glm::inverse(sums.products + glm::dmat3(prior));
  Sky sky;
  for (int c = 0; c < 3; ++c) {
    const glm::dvec3 k = inverse * (sums.by_channel[c] + prior * mean[c]);
    sky.zenith[c] = float(std::clamp(k.x, 0.0, 1.0));
    sky.horizon[c] = float(std::clamp(k.y, 0.0, 1.0));
    sky.ground[c] = float(std::clamp(k.z, 0.0, 1.0));
  }
  return sky;
}

}  // namespace rilievo
