// How is a layered impostor drawn? (S2.3)
#pragma once

#include <cstddef>

namespace rilievo {

// The two ways of drawing.
//   surfaces  height-field ray march: each pixel's ray is intersected with the surfaces of the
//             nearest pictures. The depth is the surface's, views fade into each other, and what
//             one picture does not show is looked up in others; the cost follows the pixels
//   slices    the paper's way: the nearest picture's slices, and those of its neighbours that fill
//             its holes (S2.6), in one instanced draw call; the depth is the slice's
enum class LayeredMethod { surfaces, slices };

// The most pictures that a pixel looks up. Pictures from far aside are often wrong in what they
// hold as certain, as their texels are wide along the ray: with eight teapots lose 0.1 dB, and a
// helmet takes a twentieth longer.
inline constexpr int kMaxViewsAsked = 6;
// So many more are at hand, of which each pixel chooses. Of those of eight a fern has more ghosts.
inline constexpr int kSpareViews = 4;

// Views that are certain decide alone if they have this weight together. Views that begin to fade
// in have less: the rest is that of the next view.
inline constexpr float kSureWeight = 0.25f;

// The zone in which views fade into each other, in mean spacings of the views; for all drawers.
inline constexpr double kHandover = 0.25;

// The way of drawing and its quality.
struct LayeredOptions {
  LayeredMethod method = LayeredMethod::surfaces;
  // Pictures looked up by a pixel, 1 to kMaxViewsAsked; with 1 only the nearest, and holes stay
  // open.
  int max_views = kMaxViewsAsked;
  double handover = kHandover;  // blended (surfaces) or cross-faded (slices); 0: views switch
};

// The pictures of which a pixel chooses those that it looks up, of a set of `views`.
[[nodiscard]] int views_at_hand(std::size_t views, int max_views);

// The texture memory for drawing one object with this number and size of views, bytes.
[[nodiscard]] std::size_t layered_texture_bytes(int views, int width, int height,
                                                LayeredMethod method);

}  // namespace rilievo
