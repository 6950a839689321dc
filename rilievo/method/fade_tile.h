// Mixes a tile of a frame with what an older frame shows of it. Internal: of FrameFade.
//
// A point of the new frame lies between four texels of the old one. A colour between theirs is no
// change: it may be sampled at another place. So the old frame counts as showing that of these
// colours which is nearest to the new one. To interpolate instead blurs edges of colour and the
// samples of silhouettes, which pops more than the change (bench/results/auto.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// What is seen from the side of another direction shines otherwise: of a surface that the eye has
// passed by the first angle all of the old frame counts, and nothing by the second one, in radians.
inline constexpr float kSameShading = 0.03f, kOtherShading = 0.1f;
// Surfaces are the same, or as leaves of one tree, where their distances from the old eye differ by
// at most this share.
inline constexpr float kSameSurface = 0.15f;

// Where something was or is that has moved between the frames: pixels of the new frame from left
// and top on, up to right and bottom, that show it or are beside some that do, in either frame, by
// 1 / eye_z.
struct MovedThing {
  float left = 0, top = 0, right = 0, bottom = 0;
  float least_inverse_z = 0, most_inverse_z = 0;
};

// Two frames of the same size.
struct FadedFrames {
  // sRGB bytes and 1 / eye_z of the new frame and of the old one, by rows.
  const std::uint32_t *color = nullptr, *old_color = nullptr;
  const float *inverse_z = nullptr, *old_inverse_z = nullptr;
  int width = 0, height = 0;
  // Where a pixel of the new frame is seen from the old eye: axis (x, y, 1) + step / eye_z is that
  // point over its new eye_z.
  glm::mat3 axis{1};
  glm::vec3 step{0};
  // From a point of the old eye's plane at distance 1 to the raster: (point - start) to_raster.
  glm::vec2 to_raster{1}, raster_start{0};
  float way = 0;                 // of the eye, between the frames
  std::uint32_t old_weight = 0;  // in shares of 256
  std::span<const MovedThing> moved;
};

// Fills the tile's first samples with the mixed colours, or with the new frame's where the old one
// shows another surface, or either what has moved, and with the new depths. Returns by how many
// levels, of 255, a byte of a colour differs from the new frame's in the mean. SIMD.
double fade_tile(const FadedFrames& frames, FrameTile& tile);

}  // namespace rilievo
