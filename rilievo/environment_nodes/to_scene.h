// How does a node become an ordinary textured mesh that any program draws?
//
// Ordinary texture coordinates are linear over a triangle in space; those of a node are linear over
// its picture. Edges are halved until the two differ by at most a fraction of a texel, equally on
// both sides of an edge, so that a closed mesh stays closed. Within skins, which show nobody's
// texels, none are halved. One unlit material for each face,
// colours in sRGB. The sky lies at a multiple of the farthest surface's distance. World space.
#pragma once

#include "rilievo/environment_nodes/node_mesh.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The accuracy of the mesh.
struct NodeSceneOptions {
  bool skins = true;
  double texture_error = 0.5;  // of texture coordinates, texels
  double sky_distance = 4;     // as a multiple of the farthest surface's distance
};

// Makes a scene. Requires a valid environment, and a mesh of it.
[[nodiscard]] Scene scene_from_node(const EnvironmentMap& map, const NodeMesh& mesh,
                                    const NodeSceneOptions& options = {});

}  // namespace rilievo
