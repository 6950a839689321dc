// How are environment nodes a kind of representation? Their row in the list of kinds.
#pragma once

#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/kind/kind.h"

namespace rilievo {

// The name of the kind.
inline constexpr std::string_view kEnvironmentNodesName = "environment-nodes";

// Environment nodes as a Representation.
struct EnvironmentRepresentation final : Representation {
  explicit EnvironmentRepresentation(EnvironmentNodes made) : nodes(std::move(made)) {}
  [[nodiscard]] Box bounds() const override { return nodes.bounds(); }
  [[nodiscard]] std::size_t bytes() const override { return nodes.bytes(); }
  // None: the pictures have identifiers.
  [[nodiscard]] std::uint32_t only_object() const override { return kNoObject; }
  [[nodiscard]] std::optional<CameraPath> walk() const override;

  EnvironmentNodes nodes;
};

// A camera path from one node to the next, looking ahead; around a single node.
[[nodiscard]] CameraPath walk_through(const EnvironmentNodes& nodes);

// The row.
[[nodiscard]] const Kind& environment_nodes_kind();

}  // namespace rilievo
