#include "rilievo/layered_relief/sample_sides.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// Neighbours within so many texels of depth are of the same surface, for its slope.
constexpr double kSteepest = 8;
// The cosine from which on normals of neighbours are of one side of one surface.
constexpr float kGoesOn = 0.7f;
// The cosine down to which viewers of a picture see what turns away from its direction: each looks
// from within 55 degrees of one.
constexpr float kTurnsAway = -0.5f;

glm::dvec2 texel_of(const Camera& camera) {
  return {(camera.window.right - camera.window.left) / camera.width,
          (camera.window.top - camera.window.bottom) / camera.height};
}

}  // namespace

std::unordered_set<std::uint32_t> find_closed_objects(
    std::span<const LayeredDepthImage* const> pictures) {
  struct Lines {
    std::size_t met = 0, once = 0, even = 0;
  };
  std::map<std::uint32_t, Lines> lines;
  std::vector<std::uint32_t> objects;
  for (const LayeredDepthImage* picture : pictures)
    for (std::size_t i = 0; i + 1 < picture->first.size(); ++i) {
      objects.clear();
      for (std::uint64_t s = picture->first[i]; s < picture->first[i + 1]; ++s)
        objects.push_back(picture->samples[s].object);
      std::sort(objects.begin(), objects.end());
      for (auto from = objects.begin(); from != objects.end();) {
        const auto to = std::upper_bound(from, objects.end(), *from);
        Lines& of = lines[*from];
        ++of.met;
        of.once += to - from == 1;
        of.even += (to - from) % 2 == 0;
        from = to;
      }
    }
  std::unordered_set<std::uint32_t> closed;
  for (const auto& [object, of] : lines)
    if (double(of.even) >= kClosedShare * double(of.even + of.once) &&
        double(of.even) >= kLeastEven * double(of.met))
      closed.insert(object);
  return closed;
}

SampleSides::SampleSides(const LayeredDepthImage& layers,
                         const std::unordered_set<std::uint32_t>& closed)
    : layers_(layers),
      normals_(layers.samples.size()),
      is_closed_(layers.samples.size()),
      knows_normal_(layers.samples.size()),
      outer_(layers.samples.size()),
      z_(layers.samples.size()) {
  std::vector<Unsettled> unsettled;
  for (std::size_t i = 0; i + 1 < layers.first.size(); ++i)
    for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s) {
      is_closed_[s] = closed.contains(layers.samples[s].object);
      if (!is_closed(s)) continue;
      const auto own = layers.samples.begin() + std::ptrdiff_t(s);
      const auto of_it = [&](const LayerSample& sample) { return sample.object == own->object; };
      const auto before =
          std::count_if(layers.samples.begin() + std::ptrdiff_t(layers.first[i]), own, of_it);
      const auto from =
          std::count_if(own, layers.samples.begin() + std::ptrdiff_t(layers.first[i + 1]), of_it);
      outer_[s] = before % 2 == 0;
      if ((before + from) % 2 != 0) unsettled.push_back({s, i});
    }
  const Camera& camera = layers.camera;
  const int w = camera.width, h = camera.height;
  const glm::dvec2 texel = texel_of(camera);
  for (std::size_t s = 0; s < z_.size(); ++s)
    z_[s] = float(eye_z_from(layers.depth_kind, double(layers.samples[s].depth), camera, {}));
  const glm::dvec3 right(camera.world_from_eye[0]), up(camera.world_from_eye[1]),
      forward = camera.forward();
  parallel_for(0, h, [&](int y) {
    const auto line = [&](int i, int j) {
      return std::size_t(j) * std::size_t(w) + std::size_t(i);
    };
    // How much deeper the surface lies one texel aside; NaN if it does not go on.
    const auto step = [&](int i, int j, float z, double steepest) {
      if (i < 0 || j < 0 || i >= w || j >= h) return std::nan("");
      const auto begin = z_.begin() + std::ptrdiff_t(layers.first[line(i, j)]),
                 end = z_.begin() + std::ptrdiff_t(layers.first[line(i, j) + 1]);
      const auto after = std::lower_bound(begin, end, z);
      double best = std::numeric_limits<double>::infinity();
      if (after != end) best = double(*after - z);
      if (after != begin && double(z - *(after - 1)) < std::abs(best))
        best = -double(z - *(after - 1));
      return std::abs(best) <= steepest ? best : std::nan("");
    };
    const auto slope = [](double before, double after) {
      if (std::isnan(before)) return after;
      return std::isnan(after) ? -before : 0.5 * (after - before);
    };
    const auto or_across = [](double slope) { return std::isnan(slope) ? 0.0 : slope; };
    for (int x = 0; x < w; ++x)
      for (std::uint64_t s = layers.first[line(x, y)]; s < layers.first[line(x, y) + 1]; ++s) {
        const float z = z_[s];
        const double across =
            slope(step(x - 1, y, z, kSteepest * texel.x), step(x + 1, y, z, kSteepest * texel.x));
        const double upwards =
            slope(step(x, y + 1, z, kSteepest * texel.y), step(x, y - 1, z, kSteepest * texel.y));
        knows_normal_[s] = !std::isnan(across) && !std::isnan(upwards);
        normals_[s] = glm::vec3(glm::normalize(or_across(across) / texel.x * right +
                                               or_across(upwards) / texel.y * up - forward));
      }
  });
  settle(std::move(unsettled));
}

// From neighbour to neighbour, those beside ones that are known first; those that none is beside
// stay as counted.
void SampleSides::settle(std::vector<Unsettled> unsettled) {
  const int w = layers_.camera.width, h = layers_.camera.height;
  const glm::dvec2 texel = texel_of(layers_.camera);
  std::vector<std::uint8_t> settled(z_.size(), 1);
  for (const Unsettled& one : unsettled) settled[one.sample] = 0;
  // 1 for an outer side, -1 for an inner one, and 0 if the surface does not go on there, or that is
  // not known.
  const auto vote = [&](std::size_t s, int x, int y, double steepest) {
    if (x < 0 || y < 0 || x >= w || y >= h) return 0;
    const std::size_t line = std::size_t(y) * std::size_t(w) + std::size_t(x);
    int of_best = 0;
    double best = steepest;
    for (std::uint64_t n = layers_.first[line]; n < layers_.first[line + 1]; ++n) {
      const double off = std::abs(double(z_[n] - z_[s]));
      if (off > best || layers_.samples[n].object != layers_.samples[s].object ||
          glm::dot(normals_[n], normals_[s]) < kGoesOn)
        continue;
      best = off;
      of_best = !settled[n] ? 0 : outer_[n] ? 1 : -1;
    }
    return of_best;
  };
  std::vector<std::pair<std::size_t, bool>> found;
  do {
    found.clear();
    std::erase_if(unsettled, [&](const Unsettled& one) {
      const int x = int(one.line % std::size_t(w)), y = int(one.line / std::size_t(w));
      const int sum = vote(one.sample, x - 1, y, kSteepest * texel.x) +
                      vote(one.sample, x + 1, y, kSteepest * texel.x) +
                      vote(one.sample, x, y - 1, kSteepest * texel.y) +
                      vote(one.sample, x, y + 1, kSteepest * texel.y);
      if (sum != 0) found.emplace_back(one.sample, sum > 0);
      return sum != 0;
    });
    for (const auto& [sample, outer] : found) settled[sample] = 1, outer_[sample] = outer;
  } while (!found.empty());
}

int SampleSides::turn(std::size_t sample, const glm::dvec3& forward) const {
  if (!is_closed(sample)) return 0;
  const float faces = -glm::dot(normals_[sample], glm::vec3(forward));
  if (is_outer(sample) && faces > kTurnsAway) return 0;
  return faces > 0 ? 1 : 2;
}

}  // namespace rilievo
