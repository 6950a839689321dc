// How are environment nodes merged, where are they kept in memory, and who draws them? (S3.3 to
// S3.8)
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/environment_nodes/node_mesh.h"
#include "rilievo/kind/drawable.h"

namespace rilievo {

// How pixels covered by several nodes are merged.
enum class NodeMerge {
  layering,    // one z-buffer for all nodes
  binary,      // of surfaces at about the same depth, the one with the largest texel_weights()
  weighted,    // ... the mean by weight
  positional,  // ... the mean by weight and by nearness of the eye to the node
  first,       // the first node; others only in its gaps (S3.8)
};

// Parts of a frame: as many columns and rows, from below.
struct FrameParts {
  static constexpr int kColumns = 48, kRows = 27;
  std::bitset<std::size_t(kColumns* kRows)> marked;

  [[nodiscard]] static std::size_t number(int column, int row) {
    return std::size_t(row * kColumns + column);
  }
  [[nodiscard]] bool holds(int column, int row) const { return marked[number(column, row)]; }
};

// How nodes are merged and gaps are filled.
struct NodeDrawOptions {
  NodeMerge merge = NodeMerge::positional;
  // Fills gaps with skins of the first node where no node shows a surface. Otherwise gaps stay
  // open, except for cracks.
  bool skin = false;
  // Surfaces are equal if their distances differ by at most this share.
  float tolerance = 0.03f;
  // Of three and more nodes: those parts of the frame that the last one is there for, until draw()
  // returns; it may be left out where it is neither near them nor near a gap of the others. Null:
  // everywhere.
  const FrameParts* last_in = nullptr;
};

// Gaps of this width, pixels, count as cracks, which are always filled.
inline constexpr float kNodeCrack = 2.0f;
// The most nodes that are drawn at a time.
inline constexpr std::size_t kMaxDrawnNodes = 8;

// Keeps nodes for one backend, and draws them. Nodes are told by their numbers.
class NodeStore {
 public:
  virtual ~NodeStore() = default;

  // Requires a valid environment, and a mesh of it.
  virtual void keep(std::size_t node, const EnvironmentMap& map, const NodeMesh& mesh) = 0;
  virtual void drop(std::size_t node) = 0;
  [[nodiscard]] virtual bool holds(std::size_t node) const = 0;
  [[nodiscard]] virtual std::size_t bytes() const = 0;

  // Begins a call of Drawable::draw(): what was placed before is no longer drawn.
  virtual void begin() = 0;
  // Draws one to kMaxDrawnNodes nodes that it holds, the best first, with `scale` metres of the
  // frame for each of `frame`, which is in the world of the capture. Of identifiers those of the
  // pictures, or `object` unless it is kNoObject.
  virtual void draw(const Camera& frame, double scale, std::span<const std::size_t> nodes,
                    Output output, std::uint32_t object, const NodeDrawOptions& options) = 0;
  // Draws lines, two ends each, in the world of the frame, over everything that is not nearer.
  virtual void draw_lines(const Camera& frame, std::span<const glm::dvec3> ends) = 0;
  // As Drawable's.
  virtual void set_samples(int /*samples*/) {}
  [[nodiscard]] virtual const TileDrawer* tiles() const { return nullptr; }
  [[nodiscard]] virtual const TileDrawer* outline_tiles() const { return nullptr; }
};

}  // namespace rilievo
