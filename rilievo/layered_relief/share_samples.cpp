// How far is the nearest sample of a picture, at most, from a point of a face that is wide enough
// to be hit? Lines of sight hit a flat face in a lattice. The points of the plane that are farthest
// from a lattice are the centres of the circles through the corners of its triangles, the ones that
// two shortest vectors a and b span:
//
//   r = |a| |b| |a - b| / (2 |a x b|)          where a.b >= 0
//
// of the picture that hits the face most densely, at worst over all faces: farthest_from_hits,
// 0.866 texels of six axes with equal texels (a face across two axes, along the third). Merging put
// what was seen there within `merged`. That has a sample of the picture within reach t, t being the
// picture's texel, or else stands in the middle of its texel, half a diagonal away:
//
//   lacks = farthest_from_hits + merged + t max(reach, sqrt(1 / 2))
#include "rilievo/layered_relief/share_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_relief/sample_sides.h"

namespace rilievo {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;
// Texels within which a sample of another picture is of the same surface: lines of sight hit it
// within 0.87 of any point (farthest_from_hits), and this one lies up to as far from its texel's
// middle.
constexpr double kOneSurface = 1.25;

// What is added to a picture: a list for each line of sight.
struct Added {
  std::vector<std::uint32_t> head;  // by line of sight, into the others
  std::vector<std::uint32_t> next, line;
  std::vector<LayerSample> samples;
  // By line of sight, the depths of its list, sorted: there are hundreds where a line runs along a
  // face that other pictures see.
  std::vector<std::vector<float>> depths;
  // Of each of `samples`: towards those who saw it, and whether it is the outer side of a body.
  std::vector<glm::vec3> normals;
  std::vector<bool> outer;
};

double largest_texel(const Camera& camera) {
  return std::max((camera.window.right - camera.window.left) / camera.width,
                  (camera.window.top - camera.window.bottom) / camera.height);
}

// Where a camera's lines of sight hit a face through the origin: how far from the nearest hit is a
// point of the face, at most?
double farthest_from_lattice(const Camera& camera, const glm::dvec3& normal) {
  const glm::dvec3 forward = camera.forward();
  const glm::dvec2 texel((camera.window.right - camera.window.left) / camera.width,
                         (camera.window.top - camera.window.bottom) / camera.height);
  const auto hit = [&](const glm::dvec3& aside) {
    return aside - forward * (glm::dot(aside, normal) / glm::dot(forward, normal));
  };
  glm::dvec3 a = hit(texel.x * glm::dvec3(camera.world_from_eye[0]));
  glm::dvec3 b = hit(texel.y * glm::dvec3(camera.world_from_eye[1]));
  // The shortest two vectors that span the lattice (Lagrange, Gauss).
  for (;;) {
    if (glm::dot(a, a) > glm::dot(b, b)) std::swap(a, b);
    const double times = std::round(glm::dot(a, b) / glm::dot(a, a));
    if (times == 0) break;
    b -= times * a;
  }
  if (glm::dot(a, b) < 0) b = -b;
  return glm::length(a) * glm::length(b) * glm::distance(a, b) /
         (2 * glm::length(glm::cross(a, b)));
}

// Is there a sample, an own or an added one, within `reach` metres of a place? Looked for in the
// nine lines of sight around it, first in the one through it, which has most of them.
bool is_represented(const LayeredDepthImage& layers, const Added& added, const glm::dvec2& at,
                    double depth, double per_metre, double reach) {
  const Camera& camera = layers.camera;
  const glm::dvec2 texel((camera.window.right - camera.window.left) / camera.width,
                         (camera.window.top - camera.window.bottom) / camera.height);
  const int x0 = std::clamp(int(at.x), 0, camera.width - 1);
  const int y0 = std::clamp(int(at.y), 0, camera.height - 1);
  const auto has_one = [&](int x, int y) {
    const double across = (x + 0.5 - at.x) * texel.x, up = (y + 0.5 - at.y) * texel.y;
    const double left = reach * reach - (across * across + up * up);
    if (left < 0) return false;
    const double along = std::sqrt(left) * per_metre;
    const std::size_t line = std::size_t(y) * std::size_t(camera.width) + std::size_t(x);
    // Its own are sorted, nearest first.
    for (std::uint64_t s = layers.first[line]; s < layers.first[line + 1]; ++s) {
      const double farther = double(layers.samples[s].depth) - depth;
      if (farther > along) break;
      if (farther >= -along) return true;
    }
    const std::vector<float>& depths = added.depths[line];
    const auto near = std::partition_point(depths.begin(), depths.end(), [&](float added_depth) {
      return double(added_depth) - depth < -along;
    });
    return near != depths.end() && double(*near) - depth <= along;
  };
  if (has_one(x0, y0)) return true;
  for (int y = std::max(y0 - 1, 0); y <= std::min(y0 + 1, camera.height - 1); ++y)
    for (int x = std::max(x0 - 1, 0); x <= std::min(x0 + 1, camera.width - 1); ++x)
      if ((x != x0 || y != y0) && has_one(x, y)) return true;
  return false;
}

// The inner side of a wall has the outer side's colour, if that has been added beside it: whichever
// eye sees the place sees that one.
void color_as_outer(const LayeredDepthImage& to, const Added& added, const glm::vec3& normal,
                    std::size_t line, double per_metre, LayerSample& sample) {
  const Camera& camera = to.camera;
  const glm::dvec2 texel((camera.window.right - camera.window.left) / camera.width,
                         (camera.window.top - camera.window.bottom) / camera.height);
  const int x0 = int(line % std::size_t(camera.width)), y0 = int(line / std::size_t(camera.width));
  const double reach = kOneSurface * largest_texel(camera);
  double least = reach * reach;
  for (int y = std::max(y0 - 1, 0); y <= std::min(y0 + 1, camera.height - 1); ++y)
    for (int x = std::max(x0 - 1, 0); x <= std::min(x0 + 1, camera.width - 1); ++x) {
      std::uint32_t k = added.head[std::size_t(y) * std::size_t(camera.width) + std::size_t(x)];
      for (; k != kNone; k = added.next[k]) {
        if (!added.outer[k] || glm::dot(added.normals[k], normal) >= 0) continue;
        const LayerSample& other = added.samples[k];
        const glm::dvec3 off((x - x0) * texel.x, (y - y0) * texel.y,
                             double(other.depth - sample.depth) / per_metre);
        if (other.object != sample.object || glm::dot(off, off) > least) continue;
        least = glm::dot(off, off);
        sample.color = other.color;
      }
    }
}

// Samples whose turn it is (SampleSides::turn).
void add_from(const SampleSides& sides, int turn, const LayeredDepthImage& to, double reach,
              double per_metre, Added& added) {
  const LayeredDepthImage& from = sides.layers();
  const glm::dvec3 forward = to.camera.forward();
  const Camera &source = from.camera, &target = to.camera;
  for (std::size_t i = 0; i + 1 < from.first.size(); ++i) {
    const glm::dvec2 at(double(i % std::size_t(source.width)) + 0.5,
                        double(i / std::size_t(source.width)) + 0.5);
    for (std::uint64_t s = from.first[i]; s < from.first[i + 1]; ++s) {
      if (sides.turn(s, s - from.first[i], forward) != turn) continue;
      LayerSample sample = from.samples[s];
      const double z = eye_z_from(from.depth_kind, double(sample.depth), source, at);
      const glm::dvec3 there = raster_from_world(target, world_from_raster(source, at, z));
      // Faces of the box around everything lie on the picture's very edge.
      constexpr double kRounding = 1e-3;
      if (!(there.x >= -kRounding && there.x <= target.width + kRounding)) continue;
      if (!(there.y >= -kRounding && there.y <= target.height + kRounding)) continue;
      const auto x = std::size_t(std::clamp(there.x, 0.0, target.width - 0.5));
      const auto y = std::size_t(std::clamp(there.y, 0.0, target.height - 0.5));
      const std::size_t line = y * std::size_t(target.width) + x;
      const double depth =
          depth_from_eye_z(to.depth_kind, there.z, target, glm::dvec2(x + 0.5, y + 0.5));
      if (is_represented(to, added, glm::dvec2(there), depth, per_metre, reach)) continue;
      sample.depth = sample.back = float(depth);
      if (turn > 0) color_as_outer(to, added, sides.normal(s), line, per_metre, sample);
      added.normals.push_back(sides.normal(s));
      added.outer.push_back(turn == 0 && sides.is_closed(s));
      std::vector<float>& depths = added.depths[line];
      depths.insert(std::upper_bound(depths.begin(), depths.end(), sample.depth), sample.depth);
      added.next.push_back(added.head[line]);
      added.head[line] = std::uint32_t(added.samples.size());
      added.line.push_back(std::uint32_t(line));
      added.samples.push_back(sample);
    }
  }
}

// Its own samples and those added, which its own inner sides have their colours from.
LayeredDepthImage with(const SampleSides& own, const Added& added, double per_metre) {
  const LayeredDepthImage& layers = own.layers();
  LayeredDepthImage out;
  out.name = layers.name;
  out.camera = layers.camera;
  out.depth_kind = layers.depth_kind;
  out.samples.reserve(layers.samples.size() + added.samples.size());
  out.first.reserve(layers.first.size());
  out.first.push_back(0);
  for (std::size_t line = 0; line + 1 < layers.first.size(); ++line) {
    const auto begin = std::ptrdiff_t(out.samples.size());
    for (std::uint64_t s = layers.first[line]; s < layers.first[line + 1]; ++s) {
      out.samples.push_back(layers.samples[s]);
      if (s > layers.first[line] && own.is_closed(s))
        color_as_outer(layers, added, own.normal(s), line, per_metre, out.samples.back());
    }
    for (std::uint32_t k = added.head[line]; k != kNone; k = added.next[k])
      out.samples.push_back(added.samples[k]);
    std::stable_sort(out.samples.begin() + begin, out.samples.end(),
                     [](const LayerSample& a, const LayerSample& b) { return a.depth < b.depth; });
    out.first.push_back(out.samples.size());
  }
  return out;
}

}  // namespace

double farthest_from_hits(std::span<const Camera> cameras) {
  // Normals in a spiral over half of the sphere; each other one is within kSpacing of one of these.
  // As far as that turns a face, its hits move along their lines of sight, by the change of the
  // face's slope.
  constexpr int kCount = 100'000;
  constexpr double kSpacing = 0.01, kGolden = 2.39996322972865332;
  constexpr double kLeastFacing = 0.05;  // what is seen at a smaller slant counts as edge-on
  double farthest = 0;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (i + 0.5) / kCount, r = std::sqrt(1 - z * z), turn = kGolden * i;
    const glm::dvec3 normal(r * std::cos(turn), r * std::sin(turn), z);
    double least = std::numeric_limits<double>::infinity();
    for (const Camera& camera : cameras) {
      const double facing = std::abs(glm::dot(camera.forward(), normal)) - kSpacing;
      if (facing < kLeastFacing) continue;
      least = std::min(least,
                       farthest_from_lattice(camera, normal) * (1 + kSpacing / (facing * facing)));
    }
    farthest = std::max(farthest, least);
  }
  return farthest;
}

void share_samples(ReliefPictures& pictures, double reach) {
  std::vector<LayeredDepthImage> shared(pictures.pictures.size());
  std::vector<Camera> cameras;
  double merged = 0;
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    cameras.push_back(picture.layers.camera);
    merged = std::max(merged, picture.merged);
  }
  const double from_hits = farthest_from_hits(cameras);
  std::vector<const LayeredDepthImage*> all;
  for (const ReliefPictures::Picture& picture : pictures.pictures) all.push_back(&picture.layers);
  const std::unordered_set<std::uint32_t> closed = find_closed_objects(all);
  std::vector<SampleSides> sides;
  for (const LayeredDepthImage* layers : all) sides.emplace_back(*layers, closed);
  parallel_for(std::size_t(0), shared.size(), [&](std::size_t i) {
    const LayeredDepthImage& to = pictures.pictures[i].layers;
    const double metres = reach * largest_texel(to.camera);
    const double per_metre =
        to.depth_kind == DepthKind::window_z ? 1 / (to.camera.z_far - to.camera.z_near) : 1.0;
    Added added;
    added.head.assign(to.first.size() - 1, kNone);
    added.depths.resize(to.first.size() - 1);
    for (int turn = 0; turn < SampleSides::kTurns; ++turn)
      for (std::size_t k = 0; k < shared.size(); ++k)
        if (k != i) add_from(sides[k], turn, to, metres, per_metre, added);
    shared[i] = with(sides[i], added, per_metre);
  });
  for (std::size_t i = 0; i < shared.size(); ++i) {
    ReliefPictures::Picture& picture = pictures.pictures[i];
    if (shared[i].samples.size() > picture.layers.samples.size())
      picture.moved =
          std::max(picture.moved, std::sqrt(0.5) * largest_texel(picture.layers.camera));
    picture.layers = std::move(shared[i]);
    picture.lacks = std::isfinite(from_hits)
                        ? from_hits + merged +
                              largest_texel(picture.layers.camera) * std::max(reach, std::sqrt(0.5))
                        : 0;
  }
}

}  // namespace rilievo
