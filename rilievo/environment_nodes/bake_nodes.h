// How do environment nodes come about from a source of pictures?
//
// Nodes stand where they are told to, or where they hold most of what is to be seen from a region
// (placement.h); six faces of each are captured, sky included. From photographs: six of them at one
// point are a node (a Seurat capture's views), or fewer, which leave the rest of it empty.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/environment_nodes/placement.h"

namespace rilievo {

struct NodeBakeOptions {
  std::vector<glm::dvec3> at;  // where nodes stand; empty: they are placed
  PlacementOptions placement;
  int face = 512;  // texels of a side
  int samples = 4;
  TriangulateOptions mesh;
  std::vector<std::uint32_t> objects;  // empty: all
  std::function<void(int done, int total)> progress;
};

struct NodeBake {
  EnvironmentNodes nodes;
  // Share of the surface visible from the region that the nodes hold; nothing if there is no scene
  // to ask.
  std::optional<double> held;
};

// The error says what the source lacks.
[[nodiscard]] Result<NodeBake> bake_nodes(CaptureSource& source, const NodeBakeOptions& options);

// Where eyes are likely to be in such bounds: their middle, at a person's height where the bounds
// allow it.
[[nodiscard]] Box usual_region(const Box& bounds);

// Views from about one point, anywhere around it, as a node's faces of `size` texels; where no view
// looks, it shows nothing. Nearest texels; of several views the first.
[[nodiscard]] Result<EnvironmentMap> environment_around(std::span<const DepthImage> views,
                                                        int size);

}  // namespace rilievo
