// Which neighbouring texels of a picture with depth show one connected surface?
//
// A warp may interpolate between linked texels. Where texels are not linked, the surface ends and a
// hole opens when the eye moves. A picture does not contain this: two texels with different depths
// show a steep surface or two surfaces. The rule here is made for surfaces sampled at grazing
// angles, such as the sides of an object in a back-perspective picture.
//
// Pure; depth of any kind; any projection.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/core/depth_image.h"

namespace rilievo {

// The limits of the rule.
struct LinkOptions {
  // Slopes (depth per lateral distance). Neighbours are always linked up to `gentle`, linked up to
  // `steepest` if the surface beside them is as steep, and never linked above.
  float gentle = 6.0f;
  float steepest = 20.0f;
  // A step in depth is accepted if it is at most this many times the step beside it.
  float growth = 2.0f;
};

// The eight neighbours, y down. Bit k of a texel's links says that it is linked to the texel at
// kLinkSteps[k]. The opposite of k is (k + 4) % 8.
inline constexpr std::array<glm::ivec2, 8> kLinkSteps{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

// The links of every texel. Symmetric: a is linked to b exactly if b is linked to a. A texel
// without depth has none.
[[nodiscard]] Image<std::uint8_t> texel_links(const DepthImage& picture,
                                              const LinkOptions& options = {});

// The eye_z of every texel centre; kNoDepth where the texel shows nothing.
[[nodiscard]] Image<float> eye_z_of(const DepthImage& picture);

}  // namespace rilievo
