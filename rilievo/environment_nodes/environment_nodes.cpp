#include "rilievo/environment_nodes/environment_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "rilievo/core/expects.h"
#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/io/exr.h"

namespace rilievo {
namespace {

EnvironmentMap map_of(const DepthImage* faces, const std::string& name) {
  EnvironmentMap map;
  map.name = name;
  for (std::size_t f = 0; f < 6; ++f) map.faces[f] = faces[f];
  return map;
}

constexpr int kMostDisparities = 256;
constexpr double kDisparityBytes = 16 << 20;

// The upper half of a float, rounded.
std::uint16_t upper_half(float value) {
  return std::uint16_t((std::bit_cast<std::uint32_t>(value) + 0x8000u) >> 16);
}

// size x size disparities: in the middle of each texel between the face's four around it, if these
// are about those of one surface.
Image<std::uint16_t> few_disparities(const DepthImage& face, int size) {
  constexpr float kOneSurface = 1.2f;
  const Image<float> all = face_disparity(face);
  const int n = face.camera.width;
  const auto at = [&](int x, int y) {
    return all(x, y) == kNothing ? std::numeric_limits<float>::infinity() : all(x, y);
  };
  Image<std::uint16_t> few(size, size);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const float x = (float(i) + 0.5f) * float(n) / float(size) - 0.5f,
                  y = (float(j) + 0.5f) * float(n) / float(size) - 0.5f;
      const int x0 = std::clamp(int(x), 0, n - 2), y0 = std::clamp(int(y), 0, n - 2);
      const float a = at(x0, y0), b = at(x0 + 1, y0), c = at(x0, y0 + 1), d = at(x0 + 1, y0 + 1);
      const float u = x - float(x0), v = y - float(y0);
      const bool one =
          std::max({a, b, c, d}) <= kOneSurface * std::min({a, b, c, d}) && std::isfinite(a);
      few(i, j) = upper_half(one ? glm::mix(glm::mix(a, b, u), glm::mix(c, d, u), v)
                                 : at(u < 0.5f ? x0 : x0 + 1, v < 0.5f ? y0 : y0 + 1));
    }
  return few;
}

// NodeSketch::clear, of a sketch that has its disparities.
void find_clear(NodeSketch& sketch) {
  constexpr int kBlock = 8, kCells = NodeSketch::kClearSize;
  const int size = sketch.disparity[0].width();
  // Blocks of texels: the nearest of each, and a cone around them.
  struct Block {
    glm::vec3 middle;
    float cosine, sine;  // of the angle from its middle to its rim
    float distance = INFINITY;
  };
  std::vector<Block> blocks;
  // The part of a face from low to high, from -1 to 1 each: a cone around its directions, and so
  // many radians more.
  const auto cone = [](const FaceAxes& axes, const glm::dvec2& low, const glm::dvec2& high,
                       double around) {
    const auto direction = [&](double x, double y) {
      return glm::normalize(glm::dvec3(axes.forward) + x * glm::dvec3(axes.right) -
                            y * glm::dvec3(axes.up));
    };
    const glm::dvec3 middle = direction(0.5 * (low.x + high.x), 0.5 * (low.y + high.y));
    double least = 1;
    for (int c = 0; c < 4; ++c)
      least = std::min(least,
                       glm::dot(middle, direction(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y)));
    const double angle = std::acos(std::clamp(least, -1.0, 1.0)) + around;
    return Block{glm::vec3(middle), float(std::cos(angle)), float(std::sin(angle))};
  };
  for (std::size_t f = 0; f < 6; ++f)
    for (int top = 0; top < size; top += kBlock)
      for (int left = 0; left < size; left += kBlock) {
        const int right = std::min(left + kBlock, size), bottom = std::min(top + kBlock, size);
        const double per = 2.0 / size;
        Block block = cone(face_axes()[f], per * glm::dvec2(left, top) - 1.0,
                           per * glm::dvec2(right, bottom) - 1.0, 0);
        for (int y = top; y < bottom; ++y)
          for (int x = left; x < right; ++x) {
            const float disparity =
                std::bit_cast<float>(std::uint32_t(sketch.disparity[f](x, y)) << 16);
            const double u = per * (x + 0.5) - 1, v = per * (y + 0.5) - 1;
            block.distance = std::min(
                block.distance, float(std::sqrt(1 + u * u + v * v) / std::max(disparity, 0.0f)));
          }
        blocks.push_back(block);
      }
  for (std::size_t f = 0; f < 6; ++f) {
    sketch.clear[f] = Image<float>(kCells, kCells);
    for (int y = 0; y < kCells; ++y)
      for (int x = 0; x < kCells; ++x) {
        const double per = 2.0 / kCells;
        const Block cell = cone(face_axes()[f], per * glm::dvec2(x, y) - 1.0,
                                per * glm::dvec2(x + 1, y + 1) - 1.0, NodeSketch::kClearAngle);
        float least = INFINITY;
        for (const Block& block : blocks) {
          // Cones meet if the angle between their middles is at most the sum of both.
          const float meets = cell.cosine * block.cosine - cell.sine * block.sine;
          if (block.distance < least && glm::dot(cell.middle, block.middle) >= meets - 1e-5f)
            least = block.distance;
        }
        sketch.clear[f](x, y) = least;
      }
  }
}

}  // namespace

Box EnvironmentNodes::bounds() const {
  Box all;
  for (const NodeSketch& node : nodes) all.add(node.bounds);
  // Nothing but sky: the nodes themselves.
  if (all.empty())
    for (const NodeSketch& node : nodes) all.add(glm::vec3(node.eye()));
  return all;
}

std::size_t EnvironmentNodes::bytes() const {
  std::size_t sum = 0;
  for (const DepthImage& picture : pictures)
    sum += picture.color.texels().size() * sizeof(glm::vec4) +
           picture.depth.texels().size() * sizeof(float) +
           picture.object.texels().size() * sizeof(std::uint32_t);
  for (const NodeSketch& node : nodes) {
    for (const Image<float>& face : node.distance) sum += face.texels().size() * sizeof(float);
    for (const Image<std::uint16_t>& face : node.disparity) sum += 2 * face.texels().size();
    for (const Image<float>& face : node.clear) sum += face.texels().size() * sizeof(float);
  }
  return sum;
}

std::optional<Sky> EnvironmentNodes::sky() const {
  SkySums sums;
  for (const NodeSketch& node : nodes) sums += node.sky;
  return fit_sky(sums);
}

NodeSketch make_sketch(const EnvironmentMap& map, std::size_t nodes) {
  NodeSketch sketch;
  sketch.world_from_node = world_from_node(map);
  const int n = sketch.face_size = map.faces[0].camera.width;
  const int size = std::min(
      {n, kMostDisparities, std::max(2, int(std::sqrt(kDisparityBytes / (12.0 * double(nodes)))))});
  std::size_t covered = 0;
  for (std::size_t f = 0; f < 6; ++f) {
    const DepthImage& face = map.faces[f];
    const auto distance_at = [&](int x, int y) {
      const glm::dvec2 at(x + 0.5, y + 0.5);
      return depth_from_eye_z(DepthKind::ray,
                              eye_z_from(face.depth_kind, face.depth(x, y), face.camera, at),
                              face.camera, at);
    };
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) covered += face.covered(x, y) ? 1 : 0;
    // Every few texels are enough for bounds that say where to look.
    const int step = std::max(1, n / 64);
    for (int y = step / 2; y < n; y += step)
      for (int x = step / 2; x < n; x += step)
        if (face.covered(x, y)) {
          const glm::dvec2 at(x + 0.5, y + 0.5);
          sketch.bounds.add(glm::vec3(world_from_raster(
              face.camera, at, eye_z_from(face.depth_kind, face.depth(x, y), face.camera, at))));
        }
    sketch.disparity[f] = few_disparities(face, size);
    sketch.distance[f] = Image<float>(NodeSketch::kSize, NodeSketch::kSize);
    for (int j = 0; j < NodeSketch::kSize; ++j)
      for (int i = 0; i < NodeSketch::kSize; ++i) {
        const int x = (2 * i + 1) * n / (2 * NodeSketch::kSize);
        const int y = (2 * j + 1) * n / (2 * NodeSketch::kSize);
        sketch.distance[f](i, j) = face.covered(x, y) ? float(distance_at(x, y))
                                   : face.color(x, y).a > 0.0f
                                       ? std::numeric_limits<float>::infinity()
                                       : 0.0f;
      }
  }
  sketch.sky = sky_sums(map);
  sketch.covered = double(covered) / (6.0 * n * n);
  find_clear(sketch);
  return sketch;
}

Result<EnvironmentNodes> make_environment_nodes(std::vector<DepthImage> pictures,
                                                const TriangulateOptions& mesh) {
  if (pictures.empty() || pictures.size() % 6 != 0)
    return Error{"nodes",
                 fmt::format("{} pictures are no nodes of six faces each", pictures.size())};
  EnvironmentNodes nodes;
  nodes.mesh = mesh;
  nodes.pictures = std::move(pictures);
  for (std::size_t i = 0; i < nodes.pictures.size() / 6; ++i) {
    const EnvironmentMap map = map_of(&nodes.pictures[6 * i], "");
    if (Result<> valid = validate_environment(map); !valid)
      return Error{fmt::format("node {}", i), valid.error().message()};
    nodes.nodes.push_back(make_sketch(map, nodes.pictures.size() / 6));
  }
  return nodes;
}

Result<EnvironmentMap> load_node(const EnvironmentNodes& nodes, std::size_t node) {
  RILIEVO_EXPECTS(node < nodes.nodes.size());
  if (!nodes.pictures.empty()) return map_of(&nodes.pictures[6 * node], nodes.name);
  Result<PictureFile> file = load_picture_file(nodes.file, {6 * node, 6});
  if (!file) return file.error();
  const auto refuse = [&](const std::string& reason) {
    return Error{nodes.file.string(), fmt::format("node {}: {}", node, reason)};
  };
  if (file->pictures.size() < 6 * node + 6) return refuse("is no longer in the file");
  const EnvironmentMap map = map_of(&file->pictures[6 * node], nodes.name);
  if (Result<> valid = validate_environment(map); !valid) return refuse(valid.error().message());
  return map;
}

bool sees(const NodeSketch& node, const glm::dvec3& eye) {
  const glm::dvec3 to = glm::transpose(glm::dmat3(node.world_from_node)) * (eye - node.eye());
  const double distance = glm::length(to);
  if (distance == 0) return true;
  std::size_t f = 0;
  double most = 0;
  for (std::size_t g = 0; g < 6; ++g) {
    const double along = glm::dot(to, glm::dvec3(face_axes()[g].forward));
    if (along > most) most = along, f = g;
  }
  const FaceAxes& axes = face_axes()[f];
  const auto place = [&](double at) {
    return std::clamp(int(0.5 * (1 + at / most) * NodeSketch::kSize), 0, NodeSketch::kSize - 1);
  };
  const int i = place(glm::dot(to, glm::dvec3(axes.right)));
  const int j = place(-glm::dot(to, glm::dvec3(axes.up)));
  return distance <= double(node.distance[f](i, j));
}

std::vector<std::size_t> nodes_for_eye(const EnvironmentNodes& nodes, const glm::dvec3& eye) {
  struct Entry {
    bool blind;
    double distance;
    std::size_t node;
  };
  std::vector<Entry> order;
  for (std::size_t i = 0; i < nodes.nodes.size(); ++i)
    order.push_back({!sees(nodes.nodes[i], eye), glm::distance(nodes.nodes[i].eye(), eye), i});
  std::stable_sort(order.begin(), order.end(), [](const Entry& a, const Entry& b) {
    return a.blind != b.blind ? b.blind : a.distance < b.distance;
  });
  std::vector<std::size_t> best;
  for (const Entry& entry : order) best.push_back(entry.node);
  return best;
}

}  // namespace rilievo
