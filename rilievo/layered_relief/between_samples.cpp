#include "rilievo/layered_relief/between_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace rilievo {
namespace {

// The cosine between normals from which on neighbours lie on one surface.
constexpr float kAgree = 0.7f;
// And by so many texels at most one of them is deeper.
constexpr double kDeepest = 4;

class Lattice {
 public:
  explicit Lattice(const SampleSides& sides)
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

std::optional<std::size_t> Lattice::beside(int x, int y, std::size_t sample, int right,
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

void each_place_between(const SampleSides& sides, double spacing,
                        const std::function<bool(std::size_t sample)>& of,
                        const std::function<void(const PlaceBetween&)>& visit) {
  const Lattice lattice(sides);
  const LayeredDepthImage& layers = sides.layers();
  const auto steps = [&](const glm::dvec3& a, const glm::dvec3& b) {
    return std::max(1, int(std::ceil(glm::distance(a, b) / spacing)));
  };
  const auto between = [&](int x, int y, std::size_t s) {
    // A patch of four, or its upper and left edge.
    std::array<std::optional<std::size_t>, 4> corner{s};
    for (int k = 1; k < 4; ++k) corner[std::size_t(k)] = lattice.beside(x, y, s, k & 1, k >> 1);
    const bool patch = corner[1] && corner[2] && corner[3];
    std::array<glm::dvec3, 4> world;
    std::array<glm::vec4, 4> color;
    for (int k = 0; k < 4; ++k) {
      const auto at = std::size_t(k);
      world[at] = corner[at] ? lattice.world(x + (k & 1), y + (k >> 1), *corner[at]) : world[0];
      color[at] = layers.samples[corner[at].value_or(s)].color;
    }
    int across = steps(world[0], world[1]), down = steps(world[0], world[2]);
    if (patch) {
      across = std::max(across, steps(world[2], world[3]));
      down = std::max(down, steps(world[1], world[3]));
    }
    for (int j = 0; j <= (patch || corner[2] ? down : 0); ++j)
      for (int i = 0; i <= (patch || corner[1] ? across : 0); ++i) {
        if ((i == 0 || i == across) && (j == 0 || j == down)) continue;
        if (!patch && i > 0 && j > 0) continue;
        const double u = double(i) / across, v = double(j) / down;
        const auto mixed = [&](const auto& of, auto right, auto low) {
          return glm::mix(glm::mix(of[0], of[1], right), glm::mix(of[2], of[3], right), low);
        };
        visit({s, mixed(world, u, v), mixed(color, float(u), float(v))});
      }
  };
  for (int y = 0; y < layers.camera.height; ++y)
    for (int x = 0; x < layers.camera.width; ++x)
      for (std::size_t s = layers.first[lattice.line(x, y)];
           s < layers.first[lattice.line(x, y) + 1]; ++s)
        if (sides.is_closed(s) && of(s)) between(x, y, s);
}

}  // namespace rilievo
