// A keyframe: a picture with depth of all that an eye sees, with a margin around it.
//
// Frames between keyframes are warped from them (keyframes/warp_keyframes.h). A keyframe is plain
// data: any CaptureSource makes it (keyframes/make_keyframe.h), and it can be kept or sent as it
// is. Rows from the top. Depth is 1 / eye_z: it is affine over the raster for every plane, and 0
// means the sky, which is infinitely far.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
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

// The highest byte of a colour: what the quarter of a texel shows, the texel's surface, one in
// front of it, or what is behind; and of the four quarters beside it how many show the same as it,
// and how many what is in front of that. Silhouettes are placed by it.
enum class Quarter : std::uint32_t { own = 0, nearer = 1, farther = 2 };
[[nodiscard]] constexpr std::uint32_t quarter_code(Quarter shows, std::uint32_t same_beside,
                                                   std::uint32_t nearer_beside) {
  return std::uint32_t(shows) << 30 | same_beside << 27 | nearer_beside << 24;
}
// A quarter counts so much, in colours that are smoothed and for what covers a pixel at an edge,
// and each of its four sides 1: about as much as a pixel's own width shows of them.
inline constexpr std::uint32_t kOwnParts = 2, kQuarterParts = kOwnParts + 4;
// Of a texel without quarters.
inline constexpr std::uint32_t kWholeTexel = quarter_code(Quarter::own, 4, 0);

// A cell of a keyframe's view: the mean colour that the keyframe has there of one object, and the
// colour that rays give it. Linear. An object of kNoObject: the cell is empty.
struct LightCell {
  glm::vec3 source{0}, rays{0};
  std::uint32_t object = kNoObject;  // as Keyframe's
};
// A grid of cells that relights fills (keyframes/keyframe_light.h). Empty: they stay as rays shade.
struct KeyframeLight {
  Camera camera;  // a cell is a texel
  Image<LightCell> cells;
};

// A keyframe. All images have the camera's size but that of the colours, which has twice that size
// where each texel has four quarters.
struct Keyframe {
  // Columns of a segment and rows of a block, for which ranges of depth are kept.
  static constexpr int kColumns = 64, kRows = 16;
  // As many as the rasteriser captures.
  static constexpr int kMostRows = 4096, kMostRowsWithQuarters = kMostRows / 2;

  Camera camera;                // perspective
  Image<std::uint32_t> color;   // sRGB bytes R, G, B, the first one in the lowest bits; above them
                                // what the quarter, or the whole texel, shows
  Image<float> inverse_z;       // 1 / eye_z of the surface at the texel's centre; 0: sky
  Image<std::uint32_t> object;  // index into Scene::objects + 1; kNoObject: sky
  bool coarse = false;          // has larger texels than the frames for which it was made
  // The serial number that its producer gave it, from 1 on; 0: none. It identifies copies, as on
  // the GPU.
  std::uint64_t number = 0;
  bool sharp = false;  // its quarters are samples, not smoothed: of an eye that stands
  // Objects that it was captured without, and those whose texels are hidden: a hidden texel has the
  // negative of its 1 / eye_z, and is not warped. Ascending.
  std::vector<std::uint32_t> left_out, hidden;
  // Objects of which a texel shows something, ascending.
  std::vector<std::uint32_t> shown;

  KeyframeLight light;

  [[nodiscard]] bool quarters() const { return color.width() > camera.width; }

  // Of each segment of a row, and of each block of kRows rows of segments; row by row.
  Image<InverseRange> segments, blocks;
};

// Gives the keyframe the size of its camera. Does not allocate if it was as large before.
void resize(Keyframe& keyframe, const Camera& camera, bool quarters = false);
// Hides the texels of these objects (ascending), and shows those that were hidden and are not among
// them. The ranges of depth follow.
void hide_objects(Keyframe& keyframe, std::span<const std::uint32_t> objects);
// Finds the objects of which it shows something.
void find_shown(Keyframe& keyframe);
// Finds the ranges of depth of columns [from, to), which begin and end at segments, or at the end.
void find_ranges(Keyframe& keyframe, int from, int to);
// ... of rows [from, to), which begin and end at blocks, or at the end.
void find_ranges_of_rows(Keyframe& keyframe, int from, int to);

// The bytes R, G, B of colours as a keyframe or a warped frame has them, opaque; of a hole, 0.
[[nodiscard]] Rgba8Image opaque_colors(const Image<std::uint32_t>& color);

// How many times as wide and high as a frame a keyframe is; 1: as the frame.
struct KeyframeMargin {
  double x = 1, y = 1;

  KeyframeMargin(double both) : x(both), y(both) {}  // NOLINT: a number is a margin
  KeyframeMargin(double x, double y) : x(x), y(y) {}
};

// The camera of a keyframe at a frame's eye, with `texels` texels for each pixel of the frame.
// Sizes are rounded up, and the window with them, so that with texels = 1 the texels' centres lie
// on the frame's pixels' centres. Of a frame whose keyframe would have more than `most_rows` rows
// there are fewer texels for each pixel.
[[nodiscard]] Camera keyframe_camera(const Camera& frame, KeyframeMargin margin, double texels = 1,
                                     int most_rows = Keyframe::kMostRows);

}  // namespace rilievo
