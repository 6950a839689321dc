// Cf. [Parilov, Stuerzlinger 2002, sections 5 and 6]. How we differ: a stream keeps its samples'
// places instead of marks where rows end, so that several samples are warped at once; the marks,
// kept beside, are needed only where the epipole lies in a tile. The bounding polyhedron is the
// convex hull of boxes around slices of depth.
#include "rilievo/layered_relief/layered_relief.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/color.h"
#include "rilievo/layered_relief/merge_layers.h"

namespace rilievo {
namespace {

// Streams are read in blocks of up to 64 samples, beyond a tile's last one.
constexpr std::size_t kPadding = 64;

std::uint32_t packed_color(const glm::vec4& c) {
  const auto byte = [](float v) {
    return std::uint32_t(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f));
  };
  const float a = std::clamp(c.a, 0.0f, 1.0f);
  std::uint32_t packed = byte(a) << 24;
  for (int k = 0; k < 3 && a > 0; ++k)
    packed |= byte(srgb_from_linear(std::clamp(c[k] / a, 0.0f, 1.0f)) * a) << (8 * k);
  return packed;
}

// A tile's samples where u and v ascend, the deepest of a texel first.
struct TileLines {
  std::vector<ReliefSample> samples;
  std::vector<std::uint32_t> first;  // of each texel, row by row; and the end
};

TileLines tile_lines(const LayeredRelief& relief, const LayeredDepthImage& layers, int tile,
                     bool identifiers) {
  const int size = relief.tile_size, w = relief.camera.width, h = relief.camera.height;
  const int u0 = tile % relief.tiles_x * size, v0 = tile / relief.tiles_x * size;
  TileLines lines;
  for (int v = 0; v < size; ++v)
    for (int u = 0; u < size; ++u) {
      lines.first.push_back(std::uint32_t(lines.samples.size()));
      if (u0 + u >= w || v0 + v >= h) continue;
      const std::size_t i = std::size_t(v0 + v) * std::size_t(w) + std::size_t(u0 + u);
      for (std::uint64_t s = layers.first[i + 1]; s-- > layers.first[i];) {
        const LayerSample& sample = layers.samples[s];
        const double d = relief.d_of(eye_z_from(layers.depth_kind, sample.depth, layers.camera,
                                                {u0 + u + 0.5, v0 + v + 0.5}));
        const double code = std::round((d - relief.first_d) / relief.d_step);
        const auto clamped = std::uint32_t(std::clamp(code, 0.0, double(kLargestCode)));
        lines.samples.push_back({std::uint32_t(u) | std::uint32_t(v) << 8 | clamped << 16,
                                 identifiers ? sample.object : packed_color(sample.color)});
      }
    }
  lines.first.push_back(std::uint32_t(lines.samples.size()));
  return lines;
}

void append_tile(LayeredRelief& relief, const TileLines& lines, ReliefNode& node) {
  const int size = relief.tile_size;
  for (unsigned order = 0; order < 4; ++order)
    for (int row = 0; row < size; ++row)
      for (int column = 0; column < size; ++column) {
        const int v = order & kDescendingV ? size - 1 - row : row;
        const int u = order & kDescendingU ? size - 1 - column : column;
        const auto texel = std::size_t(v * size + u);
        relief.streams[order].insert(
            relief.streams[order].end(), lines.samples.begin() + std::ptrdiff_t(lines.first[texel]),
            lines.samples.begin() + std::ptrdiff_t(lines.first[texel + 1]));
      }
  for (int v = 0; v <= size; ++v) relief.rows.push_back(lines.first[std::size_t(v * size)]);
  for (const ReliefSample& sample : lines.samples) {
    node.nearest = std::uint16_t(std::min<std::uint32_t>(node.nearest, sample.code()));
    node.farthest = std::uint16_t(std::max<std::uint32_t>(node.farthest, sample.code()));
  }
}

// The index in the tree's last level of the tile at (x, y): its bits, interleaved.
std::size_t leaf_index(int x, int y, int levels) {
  std::size_t index = 0;
  for (int bit = levels - 2; bit >= 0; --bit)
    index = 4 * index + 1 + std::size_t(x >> bit & 1) + 2 * std::size_t(y >> bit & 1);
  return index;
}

// Boxes around the samples of each slice of depth, a texel's whole extent included.
void add_hull(LayeredRelief& relief, int slices) {
  struct SliceBox {
    double u0 = 1e300, v0 = 1e300, u1 = -1e300, v1 = -1e300;
    std::uint32_t nearest = kEmptyCode, farthest = 0;
  };
  std::vector<SliceBox> boxes(std::size_t(std::max(slices, 1)));
  for (int t = 0; t < relief.tiles_x * relief.tiles_y; ++t)
    for (std::uint32_t i = relief.first[std::size_t(t)]; i < relief.first[std::size_t(t) + 1];
         ++i) {
      const ReliefSample& sample = relief.streams[0][i];
      SliceBox& box = boxes[sample.code() * boxes.size() / (kLargestCode + 1)];
      const double u = t % relief.tiles_x * relief.tile_size + int(sample.u());
      const double v = t / relief.tiles_x * relief.tile_size + int(sample.v());
      box.u0 = std::min(box.u0, u), box.u1 = std::max(box.u1, u + 1);
      box.v0 = std::min(box.v0, v), box.v1 = std::max(box.v1, v + 1);
      box.nearest = std::min(box.nearest, sample.code());
      box.farthest = std::max(box.farthest, sample.code());
    }
  for (const SliceBox& box : boxes) {
    if (box.nearest > box.farthest) continue;
    for (const std::uint32_t code : {box.nearest, box.farthest}) {
      for (const glm::dvec2 corner : {glm::dvec2(box.u0, box.v0), glm::dvec2(box.u1, box.v0),
                                      glm::dvec2(box.u0, box.v1), glm::dvec2(box.u1, box.v1)})
        relief.hull.emplace_back(corner, relief.d(code));
      if (box.nearest == box.farthest) break;
    }
  }
}

}  // namespace

Result<LayeredRelief> build_layered_relief(const LayeredDepthImage& given,
                                           const LayeredReliefOptions& options) {
  RILIEVO_EXPECTS(given.camera.projection != Projection::back_perspective);
  RILIEVO_EXPECTS(options.tile_size >= 1 && options.tile_size <= 256 &&
                  (options.tile_size & (options.tile_size - 1)) == 0);
  const auto error = [&](const char* reason) { return Error{given.name, reason}; };
  // A parallel picture's window_z is the one depth that is not in metres.
  const bool perspective = given.camera.projection == Projection::perspective;
  const double per_metre = given.depth_kind == DepthKind::window_z && !perspective
                               ? 1 / (given.camera.z_far - given.camera.z_near)
                               : 1.0;
  const LayeredDepthImage layers =
      merge_layers(gather_layers(given, options.least_alpha), options.merge * per_metre);
  if (layers.samples.empty()) return error("has no samples");
  if (layers.samples.size() >= std::numeric_limits<std::uint32_t>::max() - kPadding)
    return error("has more samples than can be counted in 32 bits");

  LayeredRelief relief;
  relief.name = layers.name;
  relief.camera = layers.camera;
  relief.merged_d = options.merge;
  double nearest = 1e300, farthest = -1e300;
  const auto width = std::size_t(layers.camera.width);
  for (std::size_t i = 0; i + 1 < layers.first.size(); ++i)
    for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s) {
      const double z = eye_z_from(layers.depth_kind, layers.samples[s].depth, layers.camera,
                                  {double(i % width) + 0.5, double(i / width) + 0.5});
      nearest = std::min(nearest, z), farthest = std::max(farthest, z);
    }
  relief.plane_z = 0.5 * (nearest + farthest);
  relief.first_d = relief.d_of(nearest);
  // A flat picture needs a step too.
  const double extent = std::max(relief.d_of(farthest) - relief.first_d,
                                 1e-6 * (perspective ? 1 / nearest : relief.camera.z_far));
  relief.d_step = extent / double(kLargestCode);

  relief.tile_size = options.tile_size;
  const auto tiles = [&](int texels) {
    return (texels + options.tile_size - 1) / options.tile_size;
  };
  relief.tiles_x = tiles(layers.camera.width);
  relief.tiles_y = tiles(layers.camera.height);
  relief.levels = 1;
  std::size_t nodes = 1;
  for (int side = 1; side < std::max(relief.tiles_x, relief.tiles_y); side *= 2) {
    ++relief.levels;
    nodes = 4 * nodes + 1;
  }
  relief.tree.resize(nodes);

  for (std::vector<ReliefSample>& stream : relief.streams)
    stream.reserve(layers.samples.size() + kPadding);
  for (int t = 0; t < relief.tiles_x * relief.tiles_y; ++t) {
    relief.first.push_back(std::uint32_t(relief.streams[0].size()));
    ReliefNode& leaf =
        relief.tree[leaf_index(t % relief.tiles_x, t / relief.tiles_x, relief.levels)];
    append_tile(relief, tile_lines(relief, layers, t, options.identifiers), leaf);
  }
  relief.first.push_back(std::uint32_t(relief.streams[0].size()));
  for (std::size_t n = nodes - 1; n > 0; --n) {
    ReliefNode& parent = relief.tree[(n - 1) / 4];
    parent.nearest = std::min(parent.nearest, relief.tree[n].nearest);
    parent.farthest = std::max(parent.farthest, relief.tree[n].farthest);
  }
  add_hull(relief, options.hull_slices);
  for (std::vector<ReliefSample>& stream : relief.streams)
    stream.resize(stream.size() + kPadding, ReliefSample{0, 0});
  return relief;
}

std::size_t bytes(const LayeredRelief& relief) {
  std::size_t sum = relief.tree.size() * sizeof(ReliefNode) +
                    (relief.first.size() + relief.rows.size()) * sizeof(std::uint32_t) +
                    relief.hull.size() * sizeof(glm::dvec3);
  for (const auto& stream : relief.streams) sum += stream.size() * sizeof(ReliefSample);
  return sum;
}

Result<> validate(const LayeredRelief& relief) {
  const auto error = [&](const char* reason) { return Error{relief.name, reason}; };
  if (Result<> camera = validate(relief.camera); !camera) return camera;
  const std::size_t tiles = std::size_t(relief.tiles_x) * std::size_t(relief.tiles_y);
  const auto size = std::uint32_t(relief.tile_size);
  if (relief.first.size() != tiles + 1 || relief.rows.size() != tiles * (size + 1))
    return error("its index does not have the size of its tiles");
  for (const auto& stream : relief.streams)
    if (stream.size() != relief.samples() + kPadding)
      return error("a stream does not have all samples");
  for (std::size_t t = 0; t < tiles; ++t) {
    const int x = int(t) % relief.tiles_x, y = int(t) / relief.tiles_x;
    const ReliefNode& node = relief.tree[leaf_index(x, y, relief.levels)];
    for (const auto& stream : relief.streams)
      for (std::uint32_t i = relief.first[t]; i < relief.first[t + 1]; ++i) {
        const ReliefSample& s = stream[i];
        if (s.u() >= size || s.v() >= size) return error("a sample lies outside its tile");
        if (s.code() < node.nearest || s.code() > node.farthest)
          return error("a sample's depth lies outside its node's");
      }
  }
  return Done{};
}

}  // namespace rilievo
