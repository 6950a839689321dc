// The pass over a picture's texels behind gap_table.h, by SIMD. Internal to `nailboard`.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rilievo/core/depth.h"
#include "rilievo/core/image.h"
#include "rilievo/nailboard/gap_table.h"

namespace rilievo {

inline constexpr int kGapSteps = 253;  // codes 1 ... 254

// Of all surfaces, eye_z; least is kNoDepth if there is none. As make_gap_table takes them.
struct GapEnds {
  float least = kNoDepth, most = 0;
};
[[nodiscard]] GapEnds find_gap_ends(const Image<float>& nearest, const Image<float>& farthest);

// 1/eye_z as codes that grow towards the eye: of the nearest surface rounded up, 0 where a texel
// shows nothing; of the farthest rounded down, 255 there. Around the picture nothing.
class GapPlanes {
 public:
  // Texels beside the picture: a vector on either side, and one texel more.
  static constexpr int kLeft = 64, kRight = 128, kRows = 2;

  GapPlanes(int width, int height);
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int pitch() const { return width_ + kLeft + kRight; }
  [[nodiscard]] const std::uint8_t* near_row(int y) const { return near_.data() + at(0, y); }
  [[nodiscard]] const std::uint8_t* far_row(int y) const { return far_.data() + at(0, y); }

  // Code 1 stands for `w_back`; `slack`: what floats may be off by, in codes.
  void encode(const Image<float>& nearest, const Image<float>& farthest, float w_back, float per_w,
              float slack);

  // Makes transposed(): x and y exchanged.
  void transpose();
  [[nodiscard]] const GapPlanes& transposed() const { return other_.front(); }

 private:
  [[nodiscard]] std::size_t at(int x, int y) const {
    return std::size_t(y + kRows) * std::size_t(pitch()) + std::size_t(x + kLeft);
  }

  int width_, height_;
  std::vector<std::uint8_t> near_, far_;
  std::vector<GapPlanes> other_;
};

// What a step of (0, 1) and of (1, 1) cells costs, in codes; 255: no step.
struct GapStepCosts {
  std::array<std::uint8_t, kGapLevels> straight, diagonal;
};

// g(T) of gap_table.cpp's (4) in codes for directions 0 <= |x| <= |y|, mirrored.
[[nodiscard]] std::array<std::uint8_t, kGapLevels> widest_strips(const GapPlanes& planes,
                                                                 bool minus_x, bool minus_y,
                                                                 const GapStepCosts& costs);

}  // namespace rilievo
