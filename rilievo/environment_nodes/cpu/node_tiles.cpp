#include "rilievo/environment_nodes/cpu/node_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/environment_nodes/cpu/memory_node.h"
#include "rilievo/environment_nodes/cpu/node_layer.h"
#include "rilievo/environment_nodes/environment_drawable.h"

namespace rilievo {
namespace {

constexpr float kAnyWidth = 1e30f;
// Just before the far plane: what is drawn there covers nothing's 1 / eye_z.
constexpr float kBeforeFar = 1 + 0x1p-20f;

std::uint32_t bytes_of(const glm::vec3& color) {
  std::uint32_t out = 0xff000000u;
  for (int c = 0; c < 3; ++c)
    out |= std::uint32_t(std::clamp(color[c], 0.0f, 255.0f) + 0.5f) << (8 * c);
  return out;
}

// A pixel of a node's layer, as it is kept for merging: whole bytes.
struct MergePixel {
  float inverse_z = 0;  // 0: nothing
  bool skin = false;
  float quality = 0;  // 0 to 253
  glm::vec3 color{0.0f};
};

// A call of NodeStore::draw().
struct PlacedNodes {
  double scale = 1;
  std::uint32_t object = kNoObject;
  NodeDrawOptions options;
  bool merged = false;  // else one is drawn over the other
  std::size_t count = 0;
  std::array<float, kMaxDrawnNodes> nearness{};
  std::array<NodeLayer, kMaxDrawnNodes> layers;
};

// The nearest surface, and what lies within the tolerance of it: see gl/node_shaders.cpp.
bool merge(std::span<const MergePixel> pixels, const PlacedNodes& placed, float& inverse_z,
           glm::vec3& color) {
  float nearest = 0, nearest_skin = 0;
  for (const MergePixel& p : pixels)
    (p.skin ? nearest_skin : nearest) = std::max(p.skin ? nearest_skin : nearest, p.inverse_z);
  const bool skin = nearest == 0;
  if (skin) nearest = nearest_skin;
  if (nearest == 0) return false;
  const float limit = (1 + placed.options.tolerance) / nearest;
  glm::vec3 sum(0.0f);
  float weights = 0, most = -1;
  inverse_z = nearest;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const MergePixel& p = pixels[i];
    if (p.inverse_z == 0 || p.skin != skin || 1 / p.inverse_z > limit) continue;
    float weight = skin ? 1.0f : p.quality + 0.25f;
    if (placed.options.merge == NodeMerge::positional) weight *= placed.nearness[i];
    if (weight > most) {
      most = weight;
      inverse_z = p.inverse_z;
      if (placed.options.merge == NodeMerge::binary) sum = p.color;
    }
    if (placed.options.merge == NodeMerge::binary) continue;
    sum += weight * p.color;
    weights += weight;
  }
  color = placed.options.merge == NodeMerge::binary ? sum : sum / std::max(weights, 1e-20f);
  return true;
}

// Others only in the gaps of the first.
bool merge_first(const MergePixel& first, const MergePixel& others, float& inverse_z,
                 glm::vec3& color) {
  const MergePixel* shown = &first;
  if (first.inverse_z == 0 || first.skin) {
    const bool nearer = others.inverse_z > first.inverse_z;
    if (others.inverse_z > 0 && (!others.skin || nearer)) shown = &others;
  }
  inverse_z = shown->inverse_z, color = shown->color;
  return inverse_z > 0;
}

}  // namespace

struct NodeTiles::State {
  std::map<std::size_t, std::unique_ptr<MemoryNode>> nodes;
  std::vector<std::unique_ptr<MemoryNode>> dropped;  // may be placed still
  std::vector<std::unique_ptr<PlacedNodes>> placed;  // kept, so that drawing does not allocate
  std::size_t count = 0;                             // of them in use
  std::vector<DrawnNode> drawn;
  int samples = 1;

  [[nodiscard]] float in_frame(const PlacedNodes& placed, float inverse_z,
                               const FrameTile& tile) const {
    return std::max(inverse_z / float(placed.scale), tile.nothing * kBeforeFar);
  }
  void draw_direct(const PlacedNodes& placed, const NodeLayer& layer, FrameTile& tile, int block,
                   int x0, int y0) const;
  void draw_merged(const PlacedNodes& placed, FrameTile& tile, int block, int x0, int y0) const;
};

NodeTiles::NodeTiles() : state_(new State) {}
NodeTiles::~NodeTiles() = default;

void NodeTiles::keep(std::size_t node, const EnvironmentMap& map, const NodeMesh& mesh) {
  drop(node);
  state_->nodes[node] = std::make_unique<MemoryNode>(make_memory_node(map, mesh));
}

void NodeTiles::drop(std::size_t node) {
  const auto found = state_->nodes.find(node);
  if (found == state_->nodes.end()) return;
  state_->dropped.push_back(std::move(found->second));
  state_->nodes.erase(found);
}

bool NodeTiles::holds(std::size_t node) const { return state_->nodes.contains(node); }

std::size_t NodeTiles::bytes() const {
  std::size_t sum = 0;
  for (const auto& [number, node] : state_->nodes) sum += node->bytes();
  return sum;
}

void NodeTiles::set_samples(int samples) { state_->samples = samples; }

void NodeTiles::begin() {
  state_->count = 0;
  state_->dropped.clear();
}

void NodeTiles::draw(const Camera& frame, double scale, std::span<const std::size_t> nodes,
                     Output output, std::uint32_t object, const NodeDrawOptions& options) {
  RILIEVO_EXPECTS(!nodes.empty() && nodes.size() <= kMaxDrawnNodes);
  State& s = *state_;
  if (s.count == s.placed.size()) s.placed.push_back(std::make_unique<PlacedNodes>());
  PlacedNodes& placed = *s.placed[s.count++];
  placed.scale = scale, placed.object = object, placed.options = options;
  const glm::dvec3 eye = frame.position();
  // At the first node's own place only that one, which shows everything visible from there.
  const glm::dvec3 first = s.nodes.at(nodes[0])->eye();
  if (output == Output::color && glm::distance(eye, first) < 1e-6 * std::max(1.0, glm::length(eye)))
    nodes = nodes.first(1);
  placed.merged =
      output == Output::color && nodes.size() > 1 && options.merge != NodeMerge::layering;
  s.drawn.clear();
  double sum = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const MemoryNode& node = *s.nodes.at(nodes[i]);
    s.drawn.push_back({&node, i == 0 && options.skin ? kAnyWidth : kNodeCrack, i > 0});
    sum += 1 / std::max(1e-9, glm::distance(eye, node.eye()));
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
    placed.nearness[i] =
        float(std::max(1e-6, 1 / std::max(1e-9, glm::distance(eye, s.drawn[i].node->eye())) / sum));
  const std::span<const DrawnNode> all(s.drawn);
  if (!placed.merged) {
    placed.count = all.size();
    for (std::size_t i = 0; i < all.size(); ++i)
      placed.layers[i].place(frame, output == Output::color ? s.samples : 1, all.subspan(i, 1));
  } else if (options.merge == NodeMerge::first) {
    placed.count = 2;
    placed.layers[0].place(frame, 1, all.first(1));
    placed.layers[1].place(frame, 1, all.subspan(1));
  } else {
    placed.count = all.size();
    for (std::size_t i = 0; i < all.size(); ++i)
      placed.layers[i].place(frame, 1, all.subspan(i, 1));
  }
}

void NodeTiles::State::draw_direct(const PlacedNodes& placed, const NodeLayer& layer,
                                   FrameTile& tile, int block, int x0, int y0) const {
  constexpr int kBlock = FrameTile::kBlock;
  const int samples = layer.samples();
  for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
    const int x = x0 + i % kBlock, y = y0 + i / kBlock;
    if (x >= tile.width || y >= tile.height) continue;
    std::array<NodeSample, 4> seen;
    bool alike = true;
    for (int k = 0; k < samples; ++k) {
      seen[std::size_t(k)] = layer.at(x, y, k);
      const NodeSample &a = seen[0], &b = seen[std::size_t(k)];
      alike = alike && (a.inverse_z > 0) == (b.inverse_z > 0) && a.node == b.node &&
              a.triangle == b.triangle;
    }
    if (alike && seen[0].inverse_z == 0) continue;
    if (!alike) tile.expand(block);
    const NodeSample* shaded = nullptr;
    std::uint32_t content = 0;
    for (int k = 0; k < (tile.samples == 4 ? tile.planes(block) : 1); ++k) {
      const NodeSample& sample = seen[std::size_t(k)];
      if (sample.inverse_z == 0) continue;
      const float inverse_z = in_frame(placed, sample.inverse_z, tile);
      FrameTile::Plane& plane = tile.plane(block, k);
      if (!(inverse_z >= plane.inverse_z[i])) continue;
      if (!shaded || shaded->node != sample.node || shaded->triangle != sample.triangle) {
        const MemoryNode& node = *layer.drawn(sample.node).node;
        const glm::vec3 direction = layer.direction(sample, x, y);
        if (tile.of == TileContent::color)
          content = bytes_of(node.color_in(direction));
        else
          content = placed.object != kNoObject ? placed.object
                    : node.has_objects()       ? node.object_in(direction)
                                               : 1;
        shaded = &sample;
      }
      plane.inverse_z[i] = inverse_z;
      plane.content[i] = content;
    }
    tile.changed[block] = true;
  }
}

void NodeTiles::State::draw_merged(const PlacedNodes& placed, FrameTile& tile, int block, int x0,
                                   int y0) const {
  constexpr int kBlock = FrameTile::kBlock;
  std::array<MergePixel, kMaxDrawnNodes> pixels;
  for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
    const int x = x0 + i % kBlock, y = y0 + i / kBlock;
    if (x >= tile.width || y >= tile.height) continue;
    for (std::size_t k = 0; k < placed.count; ++k) {
      const NodeLayer& layer = placed.layers[k];
      const NodeSample sample = layer.at(x, y, 0);
      pixels[k] = {};
      if (sample.inverse_z == 0) continue;
      const MemoryNode& node = *layer.drawn(sample.node).node;
      pixels[k].inverse_z = in_frame(placed, sample.inverse_z, tile);
      pixels[k].skin = sample.skin;
      if (!sample.skin) pixels[k].quality = std::round(253 * node.mesh.quality[sample.triangle]);
      pixels[k].color = glm::floor(node.color_in(layer.direction(sample, x, y)) + 0.5f);
    }
    float inverse_z = 0;
    glm::vec3 color(0.0f);
    const bool any = placed.options.merge == NodeMerge::first
                         ? merge_first(pixels[0], pixels[1], inverse_z, color)
                         : merge({pixels.data(), placed.count}, placed, inverse_z, color);
    if (!any) continue;
    const std::uint32_t content = bytes_of(color);
    for (int s = 0; s < tile.planes(block); ++s) {
      FrameTile::Plane& plane = tile.plane(block, s);
      if (!(inverse_z > plane.inverse_z[i])) continue;
      plane.inverse_z[i] = inverse_z;
      plane.content[i] = content;
    }
    tile.changed[block] = true;
  }
}

void NodeTiles::draw_tile(FrameTile& tile) const {
  const State& s = *state_;
  for (std::size_t p = 0; p < s.count; ++p) {
    const PlacedNodes& placed = *s.placed[p];
    RILIEVO_EXPECTS(placed.merged || placed.layers[0].samples() == tile.samples);
    for (int block = 0; block < FrameTile::kBlockCount; ++block) {
      const int x = tile.x + block % FrameTile::kBlocks * FrameTile::kBlock,
                y = tile.y + block / FrameTile::kBlocks * FrameTile::kBlock;
      if (x >= tile.width || y >= tile.height) continue;
      if (placed.merged)
        s.draw_merged(placed, tile, block, x, y);
      else
        for (std::size_t k = 0; k < placed.count; ++k)
          s.draw_direct(placed, placed.layers[k], tile, block, x, y);
    }
  }
}

Result<std::unique_ptr<DrawableFactory>> make_environment_tiles_factory() {
  return {make_environment_factory([] { return std::make_unique<NodeTiles>(); })};
}

}  // namespace rilievo
