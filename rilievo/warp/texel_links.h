// Which neighbouring texels of a picture with depth show one connected surface?
//
// Where they do, a warp may interpolate between them; where they do not, the surface ends and a
// hole opens when the eye moves. A picture does not say: two texels with different depths are a
// steep surface or two surfaces. The rule here is meant for surfaces sampled at grazing angles, as
// the sides of an object are in a back-perspective picture.
//
// Pure; depth of any kind; any projection.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/core/depth_image.h"

namespace rilievo {

struct LinkOptions {
  // Depth per lateral distance. Up to `gentle` neighbours are always linked; up to `steepest` if
  // the surface is already as steep beside them; never above.
  float gentle = 6.0f;
  float steepest = 20.0f;
  // A step is believed if it is at most this many times the step beside it.
  float growth = 2.0f;
};

// The eight neighbours, y down: bit k of a texel's links is set if it is linked to the texel at
// kLinkSteps[k]. The opposite of k is (k + 4) % 8.
inline constexpr std::array<glm::ivec2, 8> kLinkSteps{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

// Symmetric: a is linked to b exactly if b is linked to a. A texel without depth has no links.
[[nodiscard]] Image<std::uint8_t> texel_links(const DepthImage& picture,
                                              const LinkOptions& options = {});

// eye_z of every texel centre, kNoDepth where there is none.
[[nodiscard]] Image<float> eye_z_of(const DepthImage& picture);

}  // namespace rilievo
