// How are environment nodes drawn without OpenGL? (S3.3 to S3.8)
//
// As environment_nodes/gl draws them. The rasteriser finds the triangle that each sample of the
// frame shows, surfaces and skins apart; tiles look up its colour in the node's six faces, between
// four texels, and merge what several nodes show of a pixel. Merged nodes have one sample a pixel,
// as with OpenGL, but four where a silhouette crosses it (layer_edges.cpp). What lies beyond the
// frame's far plane, such as the sky, is drawn just before it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "rilievo/environment_nodes/node_store.h"
#include "rilievo/kind/kind.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// Keeps nodes in memory and draws them into tiles.
class NodeTiles final : public NodeStore, public TileDrawer {
 public:
  NodeTiles();
  ~NodeTiles() override;

  void keep(std::size_t node, const EnvironmentMap& map, const NodeMesh& mesh) override;
  void drop(std::size_t node) override;
  [[nodiscard]] bool holds(std::size_t node) const override;
  [[nodiscard]] std::size_t bytes() const override;
  void begin() override;
  void draw(const Camera& frame, double scale, std::span<const std::size_t> nodes, Output output,
            std::uint32_t object, const NodeDrawOptions& options) override;
  void draw_lines(const Camera& frame, std::span<const glm::dvec3> ends) override;
  void set_samples(int samples) override;
  [[nodiscard]] const TileDrawer* tiles() const override { return this; }
  [[nodiscard]] const TileDrawer* outline_tiles() const override;
  void draw_tile(FrameTile& tile) const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The factory of the kind.
[[nodiscard]] Result<std::unique_ptr<DrawableFactory>> make_environment_tiles_factory();

}  // namespace rilievo
