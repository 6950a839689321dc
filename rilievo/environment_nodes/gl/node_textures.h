// Nodes on the GPU, drawn by OpenGL.
//
// Needs a current OpenGL context.
#pragma once

#include <map>
#include <memory>

#include "rilievo/environment_nodes/gl/node_drawer.h"
#include "rilievo/environment_nodes/node_store.h"
#include "rilievo/kind/kind.h"

namespace rilievo {

// Keeps nodes as textures and buffers.
class NodeTextures final : public NodeStore {
 public:
  // `drawer` must outlive the object.
  explicit NodeTextures(NodeDrawer& drawer) : drawer_(drawer) {}

  void keep(std::size_t node, const EnvironmentMap& map, const NodeMesh& mesh) override;
  void drop(std::size_t node) override { stored_.erase(node); }
  [[nodiscard]] bool holds(std::size_t node) const override { return stored_.contains(node); }
  [[nodiscard]] std::size_t bytes() const override;
  void begin() override {}
  void draw(const Camera& frame, double scale, std::span<const std::size_t> nodes, Output output,
            std::uint32_t object, const NodeDrawOptions& options) override;
  void draw_lines(const Camera& frame, std::span<const glm::dvec3> ends) override {
    drawer_.draw_lines(frame, ends);
  }

 private:
  NodeDrawer& drawer_;
  std::map<std::size_t, StoredNode> stored_;
};

// Compiles the shaders.
[[nodiscard]] Result<std::unique_ptr<DrawableFactory>> make_environment_drawable_factory();

}  // namespace rilievo
