// How does a node become an ordinary textured mesh, that any program draws?
//
// Ordinary texture coordinates run evenly over a triangle in space; a node's run evenly over its
// picture. Edges are halved until the two differ by no more than a fraction of a texel, on both
// sides of an edge alike, so that a closed mesh stays closed. One unlit material a face, colours in
// sRGB; the sky ends at a multiple of the farthest surface's distance. World space.
#pragma once

#include "rilievo/environment_nodes/node_mesh.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

struct NodeSceneOptions {
  bool skins = true;
  double texture_error = 0.5;  // texels
  double sky_distance = 4;     // in distances of the farthest surface
};

// Requires a valid environment, and a mesh of it.
[[nodiscard]] Scene scene_from_node(const EnvironmentMap& map, const NodeMesh& mesh,
                                    const NodeSceneOptions& options = {});

}  // namespace rilievo
