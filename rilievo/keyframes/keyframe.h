// A keyframe: a picture with depth of all that an eye sees, with a margin around it.
//
// Frames between keyframes are warped from them (keyframes/warp_keyframes.h). A keyframe is plain
// data: any CaptureSource makes it (keyframes/make_keyframe.h), and it can be kept or sent as it
// is. Rows from the top. Depth is 1 / eye_z: it is affine over the raster for every plane, and 0
// means the sky, which is infinitely far.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/image.h"

namespace rilievo {

// The range of 1 / eye_z over a few texels, without those of the sky. Nearest < farthest: only sky.
struct InverseRange {
  float farthest = 1, nearest = 0;

  [[nodiscard]] bool empty() const { return nearest < farthest; }
  void add(float inverse_z);
  void add(const InverseRange& other);
};

// A keyframe. All images have the camera's size.
struct Keyframe {
  // Columns of a segment and rows of a block, for which ranges of depth are kept.
  static constexpr int kColumns = 64, kRows = 16;

  Camera camera;                // perspective
  Image<std::uint32_t> color;   // sRGB bytes R, G, B, A, the first one in the lowest bits; A is 255
  Image<float> inverse_z;       // 1 / eye_z of the surface at the texel's centre; 0: sky
  Image<std::uint32_t> object;  // index into Scene::objects + 1; kNoObject: sky
  bool coarse = false;          // has larger texels than the frames for which it was made

  // Of each segment of a row, and of each block of kRows rows of segments; row by row.
  Image<InverseRange> segments, blocks;
};

// Gives the keyframe the size of its camera. Does not allocate if it has that size already.
void resize(Keyframe& keyframe, const Camera& camera);
// Finds the ranges of depth of columns [from, to), which begin and end at segments, or at the end.
void find_ranges(Keyframe& keyframe, int from, int to);

// The camera of a keyframe at a frame's eye: `margin` times as wide and high (1: as the frame), and
// `texels` texels for each pixel of the frame. Sizes are rounded up, and the window with them, so
// that with texels = 1 the texels' centres lie on the frame's pixels' centres.
[[nodiscard]] Camera keyframe_camera(const Camera& frame, double margin, double texels = 1);

}  // namespace rilievo
