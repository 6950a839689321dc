#include "rilievo/environment_nodes/placement.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "rilievo/core/parallel_for.h"
#include "rilievo/core/random.h"

namespace rilievo {
namespace {

constexpr float kFar = 1e6f;

struct Sample {
  glm::vec3 position, normal;
  float cosine = 0;  // between the normal and the line of sight of the eye that saw it
};

glm::vec3 unit_vector(Random& random) {
  const float z = random.between(-1, 1), a = random.between(0, 6.2831853f);
  const float r = std::sqrt(std::max(0.0f, 1 - z * z));
  return {r * std::cos(a), r * std::sin(a), z};
}

glm::vec3 point_in(const Box& box, Random& random) {
  const glm::vec3 share{random.unit(), random.unit(), random.unit()};  // in this order
  return box.min + share * box.extent();
}

glm::vec3 point_on(const std::vector<glm::vec3>& path, Random& random) {
  const std::size_t ways = path.size() - 1;
  const std::size_t way = std::min(std::size_t(random.unit() * float(ways)), ways - 1);
  return glm::mix(path[way], path[way + 1], random.unit());
}

glm::vec3 eye_of(const PlacementOptions& options, Random& random) {
  if (options.path.size() > 1) return point_on(options.path, random);
  return options.path.empty() ? point_in(options.region, random) : options.path[0];
}

// Not nearer to a surface than `clearance`, and not behind one's back: inside of something solid.
bool is_free(const RayScene& scene, const glm::vec3& at, float clearance, std::uint64_t seed) {
  Random random(seed);
  int met = 0, backs = 0;
  for (int i = 0; i < 32; ++i) {
    const glm::vec3 to = unit_vector(random);
    const std::optional<RayHit> hit = scene.first_hit(at, to, 0.0f, kFar);
    if (!hit) continue;
    ++met;
    if (hit->distance < clearance) return false;
    // Normals are on the side that is seen, so a solid's inside shows none; single-sided backs are
    // not met at all. What is left is to be far from everything on one side only.
    backs += glm::dot(hit->normal, to) > 0;
  }
  return met == 0 || 2 * backs <= met;
}

Result<std::vector<Sample>> look_around(const RayScene& scene, const PlacementOptions& options) {
  std::vector<std::vector<Sample>> found(std::size_t(options.eyes));
  parallel_for(0, options.eyes, [&](int e) {
    Random random(combine(options.seed, 1, std::uint64_t(e)));
    glm::vec3 eye = eye_of(options, random);
    for (int tries = 0; tries < 20 && !is_free(scene, eye, 0.01f, options.seed); ++tries)
      eye = eye_of(options, random);
    for (int r = 0; r < options.rays; ++r) {
      const glm::vec3 to = unit_vector(random);
      const std::optional<RayHit> hit = scene.first_hit(eye, to, 0.0f, kFar);
      if (!hit) continue;
      const glm::vec3 normal = glm::dot(hit->normal, to) > 0 ? -hit->normal : hit->normal;
      found[std::size_t(e)].push_back({eye + hit->distance * to, normal, -glm::dot(to, normal)});
    }
  });
  std::vector<Sample> all;
  for (const std::vector<Sample>& some : found) all.insert(all.end(), some.begin(), some.end());
  if (all.empty()) return Error{"nodes", "no surface is visible from the region"};
  return all;
}

// Free ones, as many as are asked for if there are so many.
template <class Draw>
std::vector<glm::vec3> free_places(const RayScene& scene, const PlacementOptions& options,
                                   Random& random, const Draw& draw) {
  std::vector<glm::vec3> places;
  for (int tries = 0; tries < 10 * options.candidates && int(places.size()) < options.candidates;
       ++tries) {
    const glm::vec3 place = draw(random);
    if (is_free(scene, place, float(options.clearance), options.seed)) places.push_back(place);
  }
  return places;
}

// Which samples does a node hold? A bit each.
std::vector<std::uint64_t> held_by(const RayScene& scene, const std::vector<Sample>& samples,
                                   const glm::vec3& node, double least_cosine) {
  std::vector<std::uint64_t> bits((samples.size() + 63) / 64);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const glm::vec3 to = samples[i].position - node;
    const float distance = glm::length(to);
    // Rounding must not decide where the node is where the eye was.
    const float cosine = std::min(float(least_cosine), 0.999f * samples[i].cosine);
    if (!(distance > 0) || -glm::dot(to, samples[i].normal) < cosine * distance) continue;
    // The surface itself does not hide its sample.
    if (scene.occluded(node, to, 0.0f, 1.0f - 1e-3f)) continue;
    bits[i / 64] |= std::uint64_t(1) << (i % 64);
  }
  return bits;
}

std::size_t count_new(const std::vector<std::uint64_t>& bits,
                      const std::vector<std::uint64_t>& held) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < bits.size(); ++i)
    sum += std::size_t(std::popcount(bits[i] & ~held[i]));
  return sum;
}

Result<> check(const PlacementOptions& options) {
  if (options.region.empty()) return Error{"nodes", "the region is empty"};
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(options.region.min[k]) || !std::isfinite(options.region.max[k]))
      return Error{"nodes", "the region is not finite"};
  if (options.nodes < 1 || options.candidates < 1 || options.eyes < 1 || options.rays < 1)
    return Error{"nodes", "numbers of nodes, candidates, eyes and rays must be at least 1"};
  for (const glm::vec3& place : options.path)
    if (!std::isfinite(place.x) || !std::isfinite(place.y) || !std::isfinite(place.z))
      return Error{"nodes", "a place of the path is not a number"};
  return Done{};
}

}  // namespace

Result<Placement> place_nodes(const RayScene& scene, const PlacementOptions& options) {
  if (Result<> fine = check(options); !fine) return fine.error();
  const Result<std::vector<Sample>> samples = look_around(scene, options);
  if (!samples) return samples.error();
  Random random(combine(options.seed, 2));
  std::vector<glm::vec3> places =
      free_places(scene, options, random, [&](Random& r) { return eye_of(options, r); });
  // A path may lie close to surfaces.
  if (places.empty() && !options.path.empty())
    places =
        free_places(scene, options, random, [&](Random& r) { return point_in(options.region, r); });
  if (places.empty())
    return Error{"nodes", "no place in the region is as far from surfaces as a node must be"};

  std::vector<std::vector<std::uint64_t>> held(places.size());
  parallel_for(std::size_t(0), places.size(), [&](std::size_t i) {
    held[i] = held_by(scene, *samples, places[i], options.least_cosine);
  });
  Placement placement;
  std::vector<std::uint64_t> together((samples->size() + 63) / 64);
  std::size_t sum = 0;
  while (int(placement.eyes.size()) < options.nodes) {
    std::size_t best = 0, most = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const std::size_t adds = count_new(held[i], together);
      if (adds > most) most = adds, best = i;
    }
    if (most == 0) break;
    for (std::size_t k = 0; k < together.size(); ++k) together[k] |= held[best][k];
    sum += most;
    placement.eyes.emplace_back(places[best]);
    placement.share.push_back(double(sum) / double(samples->size()));
    if (placement.share.back() >= options.enough) break;
  }
  if (placement.eyes.empty())
    return Error{"nodes", "no surface is visible from any place in the region"};
  return placement;
}

Result<double> share_held(const RayScene& scene, const PlacementOptions& options,
                          const std::vector<glm::dvec3>& eyes) {
  if (Result<> fine = check(options); !fine) return fine.error();
  const Result<std::vector<Sample>> samples = look_around(scene, options);
  if (!samples) return samples.error();
  std::vector<std::uint64_t> together((samples->size() + 63) / 64);
  for (const glm::dvec3& eye : eyes) {
    const std::vector<std::uint64_t> bits =
        held_by(scene, *samples, glm::vec3(eye), options.least_cosine);
    for (std::size_t k = 0; k < together.size(); ++k) together[k] |= bits[k];
  }
  const std::vector<std::uint64_t> none(together.size());
  return double(count_new(together, none)) / double(samples->size());
}

}  // namespace rilievo
