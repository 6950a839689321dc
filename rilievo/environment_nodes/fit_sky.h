// The sky that nodes saw, as a Sky of two colours blended by elevation.
//
// An eye between nodes may look past a window's frame in a direction in which no node saw the sky.
// What is drawn there is the Sky, in the least-squares sense, whose colours are nearest to those of
// all texels that show the sky. Colours are linear and cut off at 1, as frames show them. World
// space, y up.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "rilievo/core/depth_image.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The sums of a least-squares fit, over directions that show the sky.
struct SkySums {
  double weight = 0;           // steradians
  glm::dmat3 products{0.0};    // of the shares of (zenith, horizon, ground)
  glm::dmat3 by_channel{0.0};  // column c: the shares times the colours of channel c
  glm::dvec3 color{0.0};       // the colours alone

  // Adds a direction (unit) and its colour.
  void add(const glm::dvec3& direction, const glm::vec3& color_seen, double steradians);
  SkySums& operator+=(const SkySums& other);
};

// The shares of (zenith, horizon, ground) in the colour of a Sky at this elevation, the sine of the
// angle above the horizon; their sum is 1.
[[nodiscard]] glm::dvec3 sky_shares(double elevation);

// Of the texels of six faces that show the sky. Requires a valid environment.
[[nodiscard]] SkySums sky_sums(const EnvironmentMap& map);

// The best Sky; nothing if no texel shows any. What was not seen of it, such as the zenith through
// a window, has the mean colour.
[[nodiscard]] std::optional<Sky> fit_sky(const SkySums& sums);

}  // namespace rilievo
