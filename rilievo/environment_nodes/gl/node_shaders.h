// Which shaders draw environment nodes and merge them? See node_drawer.h.
#pragma once

#include "rilievo/gl/object.h"

namespace rilievo::shader {

// What a program writes.
enum class NodeOutput {
  color,         // the node's colours
  layer,         // colours, in alpha the texel's weight, or 1 / 255 for a skin: for merging
  object,        // identifiers
  object_layer,  // as layer, and identifiers: for merging
  direction,     // the direction in node space that a pixel shows, for tests
};
// The program of a node's surfaces.
[[nodiscard]] Result<gl::Program> make_node_program(NodeOutput output);

// The program that draws a cube map over the whole frame.
[[nodiscard]] Result<gl::Program> make_cube_map_program();

// The program of outlines: lines, whose ends are relative to the eye.
[[nodiscard]] Result<gl::Program> make_node_line_program();

// The program of skins, which are drawn only where they are narrow, or everywhere.
[[nodiscard]] Result<gl::Program> make_node_skin_program(NodeOutput output);

// The program that merges layers, one for the surfaces of each node, and one for the skins of all:
// binary 1, weighted 2, positional 3, first 4 (the values of NodeMerge). Writes colours, or with
// `objects` the identifier of the node that counts most.
[[nodiscard]] Result<gl::Program> make_node_merge_program(int merge, int layers, bool objects);

// The program that draws what was merged in a picture of its own into the frame, and the one that
// draws a node's silhouettes over it: samples beyond them get what is there.
inline constexpr int kMaxEdgeSamples = 16;  // of a pixel
[[nodiscard]] Result<gl::Program> make_node_merged_program();
[[nodiscard]] Result<gl::Program> make_node_edge_program();

}  // namespace rilievo::shader
