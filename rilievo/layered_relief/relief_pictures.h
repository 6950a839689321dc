// What is kept of an object or a scene as layered reliefs: its layered pictures (S4.1, S4.4).
//
// Pictures from several directions, as they lie in a file: parallel ones, and deep images in
// perspective as they are; the reliefs that are warped
// follow from them and are made when they are to be drawn. World space at capture, metres.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/bounds.h"
#include "rilievo/core/stroke_size.h"
#include "rilievo/layered_relief/relief_set.h"

namespace rilievo {

// The layered pictures of one bake.
struct ReliefPictures {
  // The picture of one direction.
  struct Picture {
    LayeredDepthImage layers;  // parallel or perspective
    double merged = 0;         // how far a sample may stand before one that was merged into it
    double moved = 0;  // how far samples that come from other pictures may stand from where they
                       // were seen
    double lacks = 0;  // how far from a point of a surface the nearest sample is, at most, if the
                       // surface is wider than that; 0: not known
  };
  std::vector<Picture> pictures;  // at least one
  Box bounds;                     // of all samples
  StrokeSize strokes;             // the largest of the points and lines that they show
};

// What is captured, and how finely.
struct ReliefCaptureOptions {
  int textures = 6;           // 1, 2, 6, 12, 20 or 32 (relief_directions)
  int size = 512;             // texels of the longer side
  double ball = 0;            // as for relief_camera
  double merge_texels = 0.1;  // samples closer along a line of sight than that share of a texel
  // Faces that a texture sees edge-on get the samples of the others that have none of its own
  // within so many texels (share_samples.h); 0: they do not, and cracks have no bound.
  double share_texels = 0.75;
  double max_depth = 0;  // of deep images: nothing that is farther away, metres; 0: all
};

// Called with what is done and how much there is, in pictures; may be empty.
using ReliefProgress = std::function<void(int done, int total)>;

// Of `objects` (empty: all) of a source that can look behind surfaces.
[[nodiscard]] Result<ReliefPictures> capture_relief_pictures(CaptureSource& source,
                                                             std::span<const std::uint32_t> objects,
                                                             const ReliefCaptureOptions& options,
                                                             const ReliefProgress& progress = {});
// Of deep images.
[[nodiscard]] Result<ReliefPictures> adopt_relief_pictures(std::span<const LayeredDepthImage> deep,
                                                           const ReliefCaptureOptions& options);

// The box around all samples.
[[nodiscard]] Box bounds_of(const ReliefPictures& pictures);
// The object that they show; kNoObject if it is not exactly one.
[[nodiscard]] std::uint32_t only_object(const ReliefPictures& pictures);

// The reliefs of all pictures. `identifiers`: of which samples carry their objects' instead of
// colours; they lie in the same places.
[[nodiscard]] Result<ReliefSet> make_relief_set(const ReliefPictures& pictures,
                                                bool identifiers = false);

}  // namespace rilievo
