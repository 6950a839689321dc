// The shaders that draw environment nodes and merge them; see node_drawer.h.
#pragma once

#include "rilievo/gl/object.h"

namespace rilievo::shader {

enum class NodeOutput {
  color,      // the node's colours
  layer,      // colours, and the triangle's quality in alpha: what is merged
  object,     // identifiers
  direction,  // which of the node's directions a pixel shows: what tests look at
  // As color, but with the perspective correction left on (figure 10a): what S3.3 undoes.
  color_twice_corrected,
};
[[nodiscard]] Result<gl::Program> make_node_program(NodeOutput output);

// A cube map over the whole frame.
[[nodiscard]] Result<gl::Program> make_cube_map_program();

// Of skins: drawn only where they are narrow, or everywhere.
[[nodiscard]] Result<gl::Program> make_node_skin_program(NodeOutput output);

// Depth 0 where the first layer shows a surface: what is drawn after that fills its gaps.
[[nodiscard]] Result<gl::Program> make_node_cover_program();

// binary 1, weighted 2, positional 3: NodeMerge's values. For so many nodes: a number that the
// compiler knows is what loops are unrolled for.
[[nodiscard]] Result<gl::Program> make_node_merge_program(int merge, int layers);

}  // namespace rilievo::shader
