// How are environment nodes made of a source of pictures?
//
// Nodes stand at given places, or where they show most of what is visible from a region
// (placement.h). Six faces of each are captured, with the sky. Photographs from one point become a
// node: six views (a Seurat capture), or fewer, which leave the other directions empty.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/environment_nodes/placement.h"

namespace rilievo {

// The places and the quality of nodes.
struct NodeBakeOptions {
  std::vector<glm::dvec3> at;  // the places of nodes, world space; empty: they are chosen
  PlacementOptions placement;
  int face = 512;   // texels a side of a face
  int samples = 4;  // per texel
  TriangulateOptions mesh;
  std::vector<std::uint32_t> objects;  // indices into the scene's objects; empty: all
  std::function<void(int done, int total)> progress;
};

// The result of a bake.
struct NodeBake {
  EnvironmentNodes nodes;
  // The share of the surface visible from the region that the nodes show; none without a scene.
  std::optional<double> held;
};

// Bakes nodes. Fails where the source lacks something; the error says what.
[[nodiscard]] Result<NodeBake> bake_nodes(CaptureSource& source, const NodeBakeOptions& options);

// A likely region of eyes within `bounds`: the middle, at a person's height if the bounds permit.
[[nodiscard]] Box usual_region(const Box& bounds);

// A node with faces of `size` texels from views that share about one point. Directions without a
// view show nothing; where views overlap, the first is used. Texels are copied, not interpolated.
[[nodiscard]] Result<EnvironmentMap> environment_around(std::span<const DepthImage> views,
                                                        int size);

}  // namespace rilievo
