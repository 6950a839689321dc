// Environment nodes as a row of the list of kinds.
#pragma once

#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/kind/kind.h"

namespace rilievo {

inline constexpr std::string_view kEnvironmentNodesName = "environment-nodes";

struct EnvironmentRepresentation final : Representation {
  explicit EnvironmentRepresentation(EnvironmentNodes made) : nodes(std::move(made)) {}
  [[nodiscard]] Box bounds() const override { return nodes.bounds(); }
  [[nodiscard]] std::size_t bytes() const override { return nodes.bytes(); }
  // What a picture shows is told by its own identifiers.
  [[nodiscard]] std::uint32_t only_object() const override { return kNoObject; }
  [[nodiscard]] std::optional<CameraPath> walk() const override;

  EnvironmentNodes nodes;
};

// From one node to the next, looking ahead; around a single one.
[[nodiscard]] CameraPath walk_through(const EnvironmentNodes& nodes);

[[nodiscard]] const Kind& environment_nodes_kind();

}  // namespace rilievo
