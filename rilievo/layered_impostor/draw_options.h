// How is a layered impostor drawn? (S2.3)
#pragma once

#include <cstddef>

namespace rilievo {

//   surfaces  every pixel's ray is marched through the surfaces of the nearest pictures: the depth
//             is that of the surface, views fade into each other, and what one picture does not
//             show is looked for in others; cost follows the pixels
//   slices    the paper's way: the nearest picture's slices, and those of its neighbours that fill
//             its holes (S2.6), in one instanced draw call; the depth is that of the slice
enum class LayeredMethod { surfaces, slices };

// The zone in which views fade into each other, in mean spacings of the views, whoever draws.
inline constexpr double kHandover = 0.25;

struct LayeredOptions {
  LayeredMethod method = LayeredMethod::surfaces;
  int max_views = 6;  // pictures asked for a pixel, or with 1 only the nearest: its holes stay
  double handover = kHandover;  // blended (surfaces) or pixel by pixel (slices); 0: views switch
};

// Bytes of texture memory for drawing so many views of one object, of this size.
[[nodiscard]] std::size_t layered_texture_bytes(int views, int width, int height,
                                                LayeredMethod method);

}  // namespace rilievo
