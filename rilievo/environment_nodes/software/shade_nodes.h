// How are placed environment nodes drawn into one tile? Internal to environment_nodes/software.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rilievo/environment_nodes/node_store.h"
#include "rilievo/environment_nodes/software/node_layer.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// Nodes that are drawn together: a call of NodeStore::draw().
struct PlacedNodes {
  double scale = 1;  // metres of the frame for each of the layers'
  std::uint32_t object = kNoObject;
  NodeDrawOptions options;
  bool merged = false;  // else one is drawn over the other
  // Do surfaces keep out the colours of those beside? Not from a node's own place, where they are
  // beside each other for the eye too, and mixed: antialiased.
  bool unmixes = false;
  // Of layers in use: one for each node that is merged (NodeMerge::first: one for the first, one
  // for the others), else one for all.
  std::size_t count = 0;
  // Of each layer's node, for NodeMerge::positional.
  std::array<float, kMaxDrawnNodes> nearness{};
  // Of each layer's node, where each layer shows one: where it sees a point of the frame's eye
  // space.
  std::array<glm::mat4, kMaxDrawnNodes> node_from_eye{};
  // Through the frame's pixel (x, y), y downwards: at z = -1, xy + zw (x, y).
  glm::vec4 rays{0.0f};
  std::array<NodeLayer, kMaxDrawnNodes> layers;
  // Of merged nodes: do the pixels that silhouettes cross have four samples, and which are they?
  bool antialiased = false;
  EdgePixels edges;
  EdgePixels gaps;             // of these, where some sample shows no surface
  FrameBlocks last_in;         // where the last layer is drawn, if not everywhere
  FrameBlocks skins_in;        // where merged nodes have skins
  std::vector<float> deepest;  // of a row, while gaps are looked for
};

// Draws them into a tile of the frame in which they were placed. Merged nodes have one sample a
// pixel, but four where silhouettes cross it; others as many as the tile. SIMD.
void shade_nodes(const PlacedNodes& placed, FrameTile& tile);

}  // namespace rilievo
