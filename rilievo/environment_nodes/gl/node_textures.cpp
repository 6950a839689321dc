#include "rilievo/environment_nodes/gl/node_textures.h"

#include <array>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/environment_nodes/environment_drawable.h"

namespace rilievo {

static_assert(kMaxDrawnNodes == NodeDrawer::kMaxNodes);

void NodeTextures::keep(std::size_t node, const EnvironmentMap& map, const NodeMesh& mesh) {
  stored_.insert_or_assign(node, StoredNode::create(map, mesh));
}

std::size_t NodeTextures::bytes() const {
  std::size_t sum = 0;
  for (const auto& [node, stored] : stored_) sum += stored.bytes();
  return sum;
}

void NodeTextures::draw(const Camera& frame, double /*scale*/, std::span<const std::size_t> nodes,
                        Output output, std::uint32_t object, const NodeDrawOptions& options) {
  RILIEVO_EXPECTS(nodes.size() <= kMaxDrawnNodes);
  std::array<const StoredNode*, kMaxDrawnNodes> drawn{};
  for (std::size_t i = 0; i < nodes.size(); ++i) drawn[i] = &stored_.at(nodes[i]);
  const std::span<const StoredNode* const> list(drawn.data(), nodes.size());
  // Fails only if the driver has no memory for the layers: then nothing is drawn.
  (void)(output == Output::object_id ? drawer_.draw_objects(frame, list, object, options)
                                     : drawer_.draw(frame, list, options));
}

Result<std::unique_ptr<DrawableFactory>> make_environment_drawable_factory() {
  Result<NodeDrawer> made = NodeDrawer::create();
  if (!made) return made.error();
  // Kept as long as the factory, which outlives its drawables.
  auto drawer = std::make_shared<NodeDrawer>(std::move(*made));
  return {make_environment_factory([drawer] { return std::make_unique<NodeTextures>(*drawer); })};
}

}  // namespace rilievo
