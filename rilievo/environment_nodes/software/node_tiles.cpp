#include "rilievo/environment_nodes/software/node_tiles.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/environment_nodes/environment_drawable.h"
#include "rilievo/environment_nodes/software/node_layer.h"
#include "rilievo/environment_nodes/software/shade_nodes.h"
#include "rilievo/environment_nodes/software/software_node.h"
#include "rilievo/render/software/line_tiles.h"

namespace rilievo {
namespace {

constexpr float kAnyWidth = 1e30f;
// Around what the last node is there for, and around gaps of the others, it is drawn, too: blocks.
constexpr int kAroundGaps = 1;

// Marks the blocks in which a pixel shows no layer's surface, and so many around them. `within`, if
// not null, has all blocks with such a pixel.
void mark_gaps(std::span<const NodeLayer> layers, const Camera& frame, int around,
               const FrameBlocks* within, std::vector<float>& deepest, FrameBlocks& blocks) {
  constexpr int kBlock = FrameBlocks::kBlock;
  const auto width = std::size_t(frame.width);
  deepest.resize(2 * width);
  // Of a row of blocks, the deepest of each column's pixels, of which the nearest layer counts.
  float *const most = deepest.data(), *const nearest = most + width;
  // The columns [left, right) of blocks of a row.
  const auto mark_columns = [&](int row, int left, int right) {
    const auto first = std::size_t(left * kBlock),
               last = std::min(std::size_t(right * kBlock), width);
    std::fill(most + first, most + last, 0.0f);
    for (int y = row * kBlock; y < std::min((row + 1) * kBlock, frame.height); ++y) {
      std::fill(nearest + first, nearest + last, 1.0f);
      for (const NodeLayer& layer : layers)
        if (const float* const depths = layer.surface_depths(y))
          for (std::size_t x = first; x < last; ++x) nearest[x] = std::min(nearest[x], depths[x]);
      for (std::size_t x = first; x < last; ++x) most[x] = std::max(most[x], nearest[x]);
    }
    for (int column = left; column < right; ++column) {
      const auto from = std::size_t(column * kBlock), to = std::min(from + kBlock, last);
      if (*std::max_element(most + from, most + to) < 1) continue;
      blocks.mark(column - around, row - around, column + around, row + around);
    }
  };
  for (int row = 0; row < blocks.rows(); ++row) {
    const auto is_asked = [&](int column) {
      return !within || within->holds(column * kBlock, row * kBlock);
    };
    for (int left = 0, right = 0; left < blocks.columns(); left = right) {
      for (right = left + 1; right < blocks.columns() && is_asked(right) == is_asked(left);)
        ++right;
      if (is_asked(left)) mark_columns(row, left, right);
    }
  }
}

// Where is the last layer drawn, number `last`? In the marked parts of the frame and those beside
// them, and around gaps of the layers before it.
void find_blocks_of_last(PlacedNodes& placed, std::size_t last, const Camera& frame,
                         const FrameParts& parts) {
  constexpr int kBlock = FrameBlocks::kBlock;
  FrameBlocks& blocks = placed.last_in;
  blocks.begin(frame.width, frame.height);
  for (int row = 0; row < FrameParts::kRows; ++row)
    for (int column = 0; column < FrameParts::kColumns; ++column) {
      if (!parts.holds(column, row)) continue;
      const auto block = [](int part, int parts_of, int size) {
        return int(std::int64_t(part) * size / parts_of) / kBlock;
      };
      const int top = FrameParts::kRows - 1 - row;
      blocks.mark(block(std::max(column - 1, 0), FrameParts::kColumns, frame.width),
                  block(std::max(top - 1, 0), FrameParts::kRows, frame.height),
                  block(column + 2, FrameParts::kColumns, frame.width),
                  block(top + 2, FrameParts::kRows, frame.height));
    }
  mark_gaps({placed.layers.data(), last}, frame, kAroundGaps, nullptr, placed.deepest, blocks);
  blocks.finish();
}

// Skins, where no layer shows a surface, and the samples along silhouettes.
// `in_part`: the last layer is drawn around all gaps of the others.
void fill_gaps(PlacedNodes& placed, const Camera& frame, bool in_part) {
  const std::span<NodeLayer> layers(placed.layers.data(), placed.count);
  placed.edges.begin(frame.width, frame.height);
  placed.gaps.begin(frame.width, frame.height);
  if (placed.antialiased) find_edge_surfaces(layers, frame.height, placed.edges, placed.gaps);
  FrameBlocks& blocks = placed.skins_in;
  blocks.begin(frame.width, frame.height);
  mark_gaps(layers, frame, 0, in_part ? &placed.last_in : nullptr, placed.deepest, blocks);
  for (int row = 0; row < blocks.rows(); ++row)
    for (int column = 0; column < blocks.columns(); ++column)
      if (placed.gaps.word(column * FrameBlocks::kBlock, row * FrameBlocks::kBlock) != 0)
        blocks.mark(column, row, column, row);
  blocks.finish();
  parallel_for(0, int(layers.size()), [&](int k) { layers[std::size_t(k)].place_skins(blocks); });
  if (placed.antialiased) find_edge_skins(layers, frame.height, placed.edges, placed.gaps);
}

}  // namespace

struct NodeTiles::State {
  std::map<std::size_t, std::unique_ptr<SoftwareNode>> nodes;
  std::vector<std::unique_ptr<SoftwareNode>> dropped;  // after some were placed: may be still
  std::vector<std::unique_ptr<PlacedNodes>> placed;    // kept, so that drawing does not allocate
  std::size_t count = 0;                               // of them in use
  std::vector<DrawnNode> drawn;
  LineTiles lines;
  int samples = 1;
};

NodeTiles::NodeTiles() : state_(new State) {}
NodeTiles::~NodeTiles() = default;

void NodeTiles::keep(std::size_t node, const EnvironmentMap& map, const NodeMesh& mesh) {
  drop(node);
  state_->nodes[node] = std::make_unique<SoftwareNode>(make_memory_node(map, mesh));
}

void NodeTiles::drop(std::size_t node) {
  const auto found = state_->nodes.find(node);
  if (found == state_->nodes.end()) return;
  if (state_->count > 0) state_->dropped.push_back(std::move(found->second));
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
  const bool from_own = glm::distance(eye, first) < 1e-6 * std::max(1.0, glm::length(eye));
  if (from_own) nodes = nodes.first(1);
  placed.unmixes = !from_own;
  placed.merged = nodes.size() > 1 && options.merge != NodeMerge::layering;
  s.drawn.clear();
  double sum = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const SoftwareNode& node = *s.nodes.at(nodes[i]);
    s.drawn.push_back({&node, i == 0 && options.skin ? kAnyWidth : kNodeCrack, i > 0});
    sum += 1 / std::max(1e-9, glm::distance(eye, node.eye()));
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    // Squared: the nearer node's texels are smaller in both directions.
    const double share = 1 / std::max(1e-9, glm::distance(eye, s.drawn[i].node->eye())) / sum;
    placed.nearness[i] = float(std::max(1e-9, share * share));
    placed.node_from_eye[i] =
        glm::mat4(glm::inverse(s.drawn[i].node->mesh.world_from_node) * frame.world_from_eye);
  }
  const ImageWindow& window = frame.window;
  placed.rays = {window.left, window.top, (window.right - window.left) / frame.width,
                 (window.bottom - window.top) / frame.height};
  const std::span<const DrawnNode> all(s.drawn);
  bool in_part = false;  // is the last layer?
  if (!placed.merged) {
    placed.count = 1;
    placed.layers[0].place(frame, output == Output::color ? s.samples : 1, all);
  } else if (options.merge == NodeMerge::first) {
    placed.count = 2;
    placed.layers[0].place_surfaces(frame, all.first(1));
    placed.layers[1].place_surfaces(frame, all.subspan(1));
  } else {
    placed.count = all.size();
    in_part = options.last_in && all.size() > 2;
    const std::size_t last = all.size() - (in_part ? 1 : 0);
    parallel_for(std::size_t(0), last,
                 [&](std::size_t i) { placed.layers[i].place_surfaces(frame, all.subspan(i, 1)); });
    if (in_part) {
      find_blocks_of_last(placed, last, frame, *options.last_in);
      placed.layers[last].place_surfaces(frame, all.subspan(last, 1), &placed.last_in);
    }
  }
  placed.antialiased = placed.merged && output == Output::color && s.samples == 4;
  if (placed.merged) fill_gaps(placed, frame, in_part);
}

void NodeTiles::draw_lines(const Camera& frame, std::span<const glm::dvec3> ends) {
  state_->lines.begin(frame);
  for (std::size_t k = 0; k + 1 < ends.size(); k += 2) state_->lines.add(ends[k], ends[k + 1]);
}

const TileDrawer* NodeTiles::outline_tiles() const { return &state_->lines; }

void NodeTiles::draw_tile(FrameTile& tile) const {
  for (std::size_t p = 0; p < state_->count; ++p) shade_nodes(*state_->placed[p], tile);
}

Result<std::unique_ptr<DrawableFactory>> make_environment_tiles_factory() {
  return {make_environment_factory([] { return std::make_unique<NodeTiles>(); })};
}

}  // namespace rilievo
