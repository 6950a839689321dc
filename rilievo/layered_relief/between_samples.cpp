#include "rilievo/layered_relief/between_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// The cosine between normals from which on neighbours lie on one surface.
constexpr float kAgree = 0.7f;
// And by so many texels at most one of them is deeper.
constexpr double kDeepest = 4;

// Finds the neighbours of samples.
class Neighbors {
 public:
  explicit Neighbors(const SampleSides& sides)
      : sides_(sides),
        layers_(sides.layers()),
        camera_(layers_.camera),
        texel_((camera_.window.right - camera_.window.left) / camera_.width,
               (camera_.window.top - camera_.window.bottom) / camera_.height) {}

  [[nodiscard]] std::size_t line(int x, int y) const {
    return std::size_t(y) * std::size_t(camera_.width) + std::size_t(x);
  }
  [[nodiscard]] double z(std::size_t sample) const {
    return eye_z_from(layers_.depth_kind, double(layers_.samples[sample].depth), camera_, {});
  }
  [[nodiscard]] glm::dvec3 world(int x, int y, std::size_t sample) const {
    return world_from_raster(camera_, {x + 0.5, y + 0.5}, z(sample));
  }
  // The sample of texel (x + right, y + down) that lies on the surface of one of texel (x, y).
  [[nodiscard]] std::optional<std::size_t> beside(int x, int y, std::size_t sample, int right,
                                                  int down) const;

 private:
  // By how much deeper is the plane of a sample, a step aside?
  [[nodiscard]] double deeper(std::size_t sample, const glm::dvec3& aside) const {
    const glm::dvec3 normal(sides_.normal(sample));
    return -glm::dot(normal, aside) / glm::dot(normal, camera_.forward());
  }

  const SampleSides& sides_;
  const LayeredDepthImage& layers_;
  const Camera& camera_;
  glm::dvec2 texel_;
};

std::optional<std::size_t> Neighbors::beside(int x, int y, std::size_t sample, int right,
                                             int down) const {
  if (x + right >= camera_.width || y + down >= camera_.height) return std::nullopt;
  const double texel = std::max(texel_.x, texel_.y);
  const glm::dvec3 aside = right * texel_.x * glm::dvec3(camera_.world_from_eye[0]) -
                           down * texel_.y * glm::dvec3(camera_.world_from_eye[1]);
  const std::size_t other = line(x + right, y + down);
  for (std::size_t s = layers_.first[other]; s < layers_.first[other + 1]; ++s) {
    if (layers_.samples[s].object != layers_.samples[sample].object) continue;
    if (glm::dot(sides_.normal(s), sides_.normal(sample)) < kAgree) continue;
    const double step = z(s) - z(sample);
    if (std::abs(step) > kDeepest * texel) continue;
    const double off =
        std::min(std::abs(step - deeper(sample, aside)), std::abs(step - deeper(s, aside)));
    if (off <= kOnePlane * texel) return s;
  }
  return std::nullopt;
}

}  // namespace

glm::vec4 color_of(const LayeredDepthImage& layers, const PlaceBetween& place) {
  const auto color = [&](std::size_t k) { return layers.samples[place.around[k]].color; };
  const auto right = float(place.right), low = float(place.low);
  return glm::mix(glm::mix(color(0), color(1), right), glm::mix(color(2), color(3), right), low);
}

SurfaceLattice::SurfaceLattice(const SampleSides& sides)
    : sides_(sides), world_(sides.layers().samples.size()), neighbors_(world_.size()) {
  const Neighbors neighbors(sides);
  const LayeredDepthImage& layers = sides.layers();
  parallel_for(0, layers.camera.height, [&](int y) {
    for (int x = 0; x < layers.camera.width; ++x)
      for (std::size_t s = layers.first[neighbors.line(x, y)];
           s < layers.first[neighbors.line(x, y) + 1]; ++s) {
        world_[s] = neighbors.world(x, y, s);
        neighbors_[s].fill(kNoNeighbor);
        if (!sides.is_closed(s)) continue;
        for (int k = 1; k < 4; ++k)
          if (const auto beside = neighbors.beside(x, y, s, k & 1, k >> 1))
            neighbors_[s][std::size_t(k - 1)] = std::uint32_t(*beside);
      }
  });
}

void SurfaceLattice::each_place_beside(
    std::size_t s, double spacing, const std::function<void(const PlaceBetween&)>& visit) const {
  PlaceBetween place;
  place.around.fill(s);
  std::array<bool, 4> has{true};
  for (std::size_t k = 1; k < 4; ++k) {
    has[k] = neighbors_[s][k - 1] != kNoNeighbor;
    if (has[k]) place.around[k] = neighbors_[s][k - 1];
  }
  // A patch of four, or its upper and left edge.
  const bool patch = has[1] && has[2] && has[3];
  const std::array<glm::dvec3, 4> world{world_[place.around[0]], world_[place.around[1]],
                                        world_[place.around[2]], world_[place.around[3]]};
  const auto steps = [&](std::size_t a, std::size_t b) {
    return std::max(1, int(std::ceil(glm::distance(world[a], world[b]) / spacing)));
  };
  int across = steps(0, 1), down = steps(0, 2);
  if (patch) across = std::max(across, steps(2, 3)), down = std::max(down, steps(1, 3));
  for (int j = 0; j <= (has[2] ? down : 0); ++j)
    for (int i = 0; i <= (has[1] ? across : 0); ++i) {
      if ((i == 0 || i == across) && (j == 0 || j == down)) continue;
      if (!patch && i > 0 && j > 0) continue;
      place.right = double(i) / across, place.low = double(j) / down;
      place.world = glm::mix(glm::mix(world[0], world[1], place.right),
                             glm::mix(world[2], world[3], place.right), place.low);
      visit(place);
    }
}

void SurfaceLattice::each_place(double spacing, const std::function<bool(std::size_t sample)>& of,
                                const std::function<void(const PlaceBetween&)>& visit) const {
  for (std::size_t s = 0; s < world_.size(); ++s)
    if (sides_.is_closed(s) && of(s)) each_place_beside(s, spacing, visit);
}

}  // namespace rilievo
