// How are placed nailboards drawn into one tile? Internal: not a stable interface.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "rilievo/nailboard/software/software_nailboard.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// What drawing needs of a nailboard in a frame. Frame coordinates in pixels, y points down.
struct PlacedNailboard {
  const SoftwareNailboard* picture = nullptr;
  // (u w, v w, w) of a pixel is this times (x, y, 1): texels from the upper left corner of the
  // picture, and w = 1 / eye_z of the polygon.
  glm::dmat3 texel_from_raster;
  // Exact: with q = q_first + q_per_code code, 1 / eye_z = q / (q eye_z + 1 / w - eye_z), where
  // eye_z is the capturing eye's. Otherwise 1 / eye_z = w q.
  bool exact = true;
  bool nearest_coverage = false;  // SampleRounding::nearest
  float q_first = 1, q_per_code = 0, eye_z = 0;
  // No pixel shows anything nearer than this 1 / eye_z; infinite: unknown.
  float nearest = 0;
  float inverse_near = 0;              // 1 / z_near of the frame
  float share_from = 0, share_to = 1;  // see SoftwareNailboardInstance
  std::uint32_t object = 0;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // rectangle in the frame: x0 <= x < x1, y0 <= y < y1
};

// Draws those of `placed` that `listed` names, in this order. Each one's entry of `blocks` becomes
// the number of the tile's blocks in which it was nearest when it was drawn. SIMD.
void compose_tile(std::span<const PlacedNailboard> placed, std::span<const std::uint32_t> listed,
                  std::span<std::uint8_t> blocks, FrameTile& tile);
static_assert(FrameTile::kBlockCount <= 255);

}  // namespace rilievo
