// Where does a frame show what lies behind a surface that no keyframe sees?
//
// A part of an object may be hidden from each keyframe's eye, by one thing from the one and by
// another from the other, while all see past it, to the sky for example: then nothing is missing,
// and the frame shows what is behind. (Of whole objects see unshown_objects.h.) Such places lie
// beside edges of what is near, and are as wide as these move against what is behind.
//
// A few rays each frame look at pixels of blocks with such edges. Where one meets a surface in
// front of what is shown, and no pixel around shows that surface, the block is torn: what it shows
// behind the surface becomes holes, and the blocks around are looked at, too, until all of the
// place is found. Blocks that were torn are looked at in the next frames before any others.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/keyframes/warp_keyframes.h"
#include "rilievo/render/rays/cast_pixels.h"

namespace rilievo {

// Finds them, frame after frame. A steady frame allocates nothing. The result depends on the frames
// before, and not on the number of threads.
class TornBlocks {
 public:
  static constexpr int kSide = 8;  // of a block, in pixels
  // Rays of a frame for blocks of which nothing is known, and for each block beside a torn one.
  static constexpr int kRays = 256, kRaysBeside = 4;
  // For so many frames after it was torn a block is looked at first.
  static constexpr int kRemembered = 8;
  // At most so large a share of a frame is made holes: a frame that takes longer for more of them
  // comes later, and has more still.
  static constexpr double kMostTorn = 0.01;

  // Edges that move by less, in pixels, hide strips that few see. Among those that move by less
  // than a pixel, as slanted surfaces do everywhere, rays would be spent in vain.
  static constexpr double kLeastGap = 4, kLeastOfAll = 1;

  // `rays` must outlive the object. Beside edges that move by `least_gap` pixels or less nothing is
  // looked for.
  explicit TornBlocks(const RayScene& rays, double least_gap = kLeastGap,
                      double most_torn = kMostTorn)
      : rays_(rays), least_gap_(std::max(least_gap, kLeastOfAll)), most_torn_(most_torn) {}

  // Looks at a frame, and makes holes; returns how many. `objects`, ascending: those that keyframes
  // show; nothing else is looked for.
  std::size_t look(const Camera& frame, std::span<const WarpedKeyframe> keyframes,
                   std::span<const std::uint32_t> objects, WarpedFrame& warped);

 private:
  struct Look {
    std::uint32_t block;
    FramePixel at;
    float inverse_z;  // of the surface there, if it is not shown; 0: none
  };

  void find_edges(const Camera& frame, double way, const WarpedFrame& warped);
  void add(std::uint32_t block, int rays);
  void remember();
  void cast(std::span<const std::uint32_t> objects, const WarpedFrame& warped);
  std::size_t tear(std::uint32_t block, float inverse_z, WarpedFrame& warped) const;

  const RayScene& rays_;
  double least_gap_, most_torn_;
  Camera frame_;
  int across_ = 0, down_ = 0;
  std::uint64_t frames_ = 0;
  std::size_t next_ = 0;               // of the edges, the first to look at
  std::vector<std::uint8_t> at_edge_;  // by block
  std::vector<bool> looked_;           // by block, in this frame
  std::vector<std::uint32_t> edges_, torn_;
  struct Remembered {
    std::uint32_t block;
    int frames;  // since it was torn
  };
  std::vector<Remembered> remembered_, scratch_;
  std::vector<Look> looks_;
};

}  // namespace rilievo
