// How far is the nearest sample of a picture with texels t, at most, from a point of a face that is
// wide enough to be hit? Of the directions one sees the share c of the face's area, at least: its
// line of sight nearest to the point is within half a diagonal, and hits the face within
// t / (sqrt(2) c) of it. Merging put what was seen there within `merged`. And that has a sample of
// the picture within reach t, or else stands in the middle of its texel, half a diagonal away:
//
//   lacks = t / (sqrt(2) c) + merged + t max(reach, sqrt(1 / 2))
#include "rilievo/layered_relief/share_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

// What is added to a picture: a list for each line of sight.
struct Added {
  std::vector<std::uint32_t> head;  // by line of sight, into the others
  std::vector<std::uint32_t> next, line;
  std::vector<LayerSample> samples;
};

double largest_texel(const Camera& camera) {
  return std::max((camera.window.right - camera.window.left) / camera.width,
                  (camera.window.top - camera.window.bottom) / camera.height);
}

// Is there a sample, an own or an added one, within `reach` metres of a place? Looked for in the
// nine lines of sight around it.
bool is_represented(const LayeredDepthImage& layers, const Added& added, const glm::dvec2& at,
                    double depth, double per_metre, double reach) {
  const Camera& camera = layers.camera;
  const glm::dvec2 texel((camera.window.right - camera.window.left) / camera.width,
                         (camera.window.top - camera.window.bottom) / camera.height);
  const int x0 = std::clamp(int(at.x), 0, camera.width - 1);
  const int y0 = std::clamp(int(at.y), 0, camera.height - 1);
  for (int y = std::max(y0 - 1, 0); y <= std::min(y0 + 1, camera.height - 1); ++y)
    for (int x = std::max(x0 - 1, 0); x <= std::min(x0 + 1, camera.width - 1); ++x) {
      const glm::dvec2 across = (glm::dvec2(x + 0.5, y + 0.5) - at) * texel;
      const double left = reach * reach - glm::dot(across, across);
      if (left < 0) continue;
      const double along = std::sqrt(left) * per_metre;
      const std::size_t line = std::size_t(y) * std::size_t(camera.width) + std::size_t(x);
      for (std::uint64_t s = layers.first[line]; s < layers.first[line + 1]; ++s)
        if (std::abs(double(layers.samples[s].depth) - depth) <= along) return true;
      for (std::uint32_t k = added.head[line]; k != kNone; k = added.next[k])
        if (std::abs(double(added.samples[k].depth) - depth) <= along) return true;
    }
  return false;
}

void add_from(const LayeredDepthImage& from, const LayeredDepthImage& to, double reach,
              double per_metre, Added& added) {
  const Camera &source = from.camera, &target = to.camera;
  for (std::size_t i = 0; i + 1 < from.first.size(); ++i) {
    const glm::dvec2 at(double(i % std::size_t(source.width)) + 0.5,
                        double(i / std::size_t(source.width)) + 0.5);
    for (std::uint64_t s = from.first[i]; s < from.first[i + 1]; ++s) {
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
      added.next.push_back(added.head[line]);
      added.head[line] = std::uint32_t(added.samples.size());
      added.line.push_back(std::uint32_t(line));
      added.samples.push_back(sample);
    }
  }
}

LayeredDepthImage with(const LayeredDepthImage& layers, const Added& added) {
  LayeredDepthImage out;
  out.name = layers.name;
  out.camera = layers.camera;
  out.depth_kind = layers.depth_kind;
  out.samples.reserve(layers.samples.size() + added.samples.size());
  out.first.reserve(layers.first.size());
  out.first.push_back(0);
  for (std::size_t line = 0; line + 1 < layers.first.size(); ++line) {
    const auto begin = std::ptrdiff_t(out.samples.size());
    for (std::uint64_t s = layers.first[line]; s < layers.first[line + 1]; ++s)
      out.samples.push_back(layers.samples[s]);
    for (std::uint32_t k = added.head[line]; k != kNone; k = added.next[k])
      out.samples.push_back(added.samples[k]);
    std::stable_sort(out.samples.begin() + begin, out.samples.end(),
                     [](const LayerSample& a, const LayerSample& b) { return a.depth < b.depth; });
    out.first.push_back(out.samples.size());
  }
  return out;
}

}  // namespace

double least_facing(std::span<const glm::dvec3> directions) {
  // Normals in a spiral from pole to pole; each other one is within kSpacing of one of these, by
  // which the share that a direction sees can be less.
  constexpr int kCount = 20'000;
  constexpr double kSpacing = 0.03, kGolden = 2.39996322972865332;
  double least = 1;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (2 * i + 1.0) / kCount, r = std::sqrt(1 - z * z), turn = kGolden * i;
    const glm::dvec3 normal(r * std::cos(turn), r * std::sin(turn), z);
    double most = 0;
    for (const glm::dvec3& direction : directions)
      most = std::max(most, std::abs(glm::dot(direction, normal)));
    least = std::min(least, most);
  }
  return std::max(0.0, least - kSpacing);
}

void share_samples(ReliefPictures& pictures, double reach) {
  std::vector<LayeredDepthImage> shared(pictures.pictures.size());
  std::vector<glm::dvec3> directions;
  double texel = 0, merged = 0;
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    directions.push_back(picture.layers.camera.forward());
    texel = std::max(texel, largest_texel(picture.layers.camera));
    merged = std::max(merged, picture.merged);
  }
  const double facing = least_facing(directions);
  parallel_for(std::size_t(0), shared.size(), [&](std::size_t i) {
    const LayeredDepthImage& to = pictures.pictures[i].layers;
    const double metres = reach * largest_texel(to.camera);
    const double per_metre =
        to.depth_kind == DepthKind::window_z ? 1 / (to.camera.z_far - to.camera.z_near) : 1.0;
    Added added;
    added.head.assign(to.first.size() - 1, kNone);
    for (std::size_t k = 0; k < shared.size(); ++k)
      if (k != i) add_from(pictures.pictures[k].layers, to, metres, per_metre, added);
    shared[i] = with(to, added);
  });
  for (std::size_t i = 0; i < shared.size(); ++i) {
    ReliefPictures::Picture& picture = pictures.pictures[i];
    if (shared[i].samples.size() > picture.layers.samples.size())
      picture.moved =
          std::max(picture.moved, std::sqrt(0.5) * largest_texel(picture.layers.camera));
    picture.layers = std::move(shared[i]);
    picture.lacks = facing > 0
                        ? texel / (std::sqrt(2.0) * facing) + merged +
                              largest_texel(picture.layers.camera) * std::max(reach, std::sqrt(0.5))
                        : 0;
  }
}

}  // namespace rilievo
