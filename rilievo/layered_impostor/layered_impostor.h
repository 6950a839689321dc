// How is an object kept as a few pictures from all around, each drawn as a stack of slices?
//
// A layered impostor (S2) has one picture with depth for each direction of a ViewSet. Each picture
// is cut into slices. A slice shows the texels whose surface patch (texel_surface.h) reaches into
// its interval; it is drawn as one quad across the capture frustum at the middle of the interval
// (S2.3). A texel lies on every slice that its patch crosses, and intervals can overlap, so that a
// surface that passes from one slice to the next does not tear when the eye moves (S2.4). Slices
// keep only the rectangle that contains texels; empty ones are dropped (S2.5).
//
// Depths: eye_z of the picture's camera, metres. Rectangles: texels, row 0 on top. Owns its
// pictures. Pure; the result does not depend on the number of threads.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "rilievo/capture/view_set.h"
#include "rilievo/core/bounds.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/stroke_size.h"
#include "rilievo/warp/texel_surface.h"

namespace rilievo {

// How slices are distributed between the picture's nearest and farthest sample.
enum class SliceSpacing {
  // Evenly in eye_z. A sample is displaced by at most half the spacing, along its ray. A distant
  // viewer
  // on the far side from the apex sees equal displacements everywhere.
  eye_z,
  // Evenly in window_z, as in the paper's depth buffer: dense near the apex, which is the side of a
  // back-perspective picture that its viewers do not see.
  window_z,
};

// The number and the thickness of slices.
struct SliceOptions {
  int layers = 64;  // 1 to 4096
  // The length by which an interval is extended, both ends together, as a share of its own
  // thickness; 0: intervals are disjoint.
  float overlap = 0.0f;
  // Whether a texel has the interval of its patch and of the visual hull behind it (visual_hull.h),
  // or only its sample's depth.
  bool pieces = true;
  SliceSpacing spacing = SliceSpacing::eye_z;
};

// The texels x0 <= x < x1, y0 <= y < y1.
struct TexelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  [[nodiscard]] std::size_t area() const { return std::size_t(x1 - x0) * std::size_t(y1 - y0); }
  friend bool operator==(const TexelRect&, const TexelRect&) = default;
};

// A slice of one picture.
struct Slice {
  int layer = 0;              // 0 at the apex or eye; counts empty slices, too
  float eye_z = 0;            // of its quad
  float front = 0, back = 0;  // it shows texels with front <= eye_z < back
  TexelRect rect;
};

// A neighbour's slice that shows through the holes of a view (S2.6).
struct FillSlice {
  int slice = 0;   // index into the neighbour's slices
  TexelRect rect;  // of the visible texels
  friend bool operator==(const FillSlice&, const FillSlice&) = default;
};
// All slices of a neighbour that fill a view's holes.
struct FillSlices {
  int view = 0, neighbor = 0;
  std::vector<FillSlice> slices;  // ascending
};

// A layered impostor with everything derived from its pictures.
struct LayeredImpostor {
  std::string name;
  Box bounds;  // of the samples and the corners of their pieces of surface, world space
  // For default paths. Photographs tell which way was up and where they were taken.
  Vantage vantage;
  SliceOptions slicing;
  ViewSet views;
  std::vector<DepthImage> pictures;        // one for each direction; all name objects or none
  std::vector<TexelSurface> surfaces;      // one for each picture
  std::vector<std::vector<Slice>> slices;  // one list for each picture, by ascending layer
  // For each picture: does an empty texel mean that nothing is there? Not if its frustum excludes
  // samples of other pictures, nor if it lacks samples, as pictures made of photographs can (S2.7);
  // such texels have colour but no depth; nor if it sees through a surface from behind.
  std::vector<bool> complete;
  // Those that are incomplete for that reason alone (see_through.h). They are right for an eye
  // that sees the surface from behind, too: nothing is there if no picture knows better.
  std::vector<bool> sees_through;
  // Empty if not computed; else one for each ordered pair of neighbours, ascending.
  std::vector<FillSlices> fills;
  StrokeSize strokes;  // the largest of the points and lines that the pictures show
};

// The interval of eye_z of a texel's patch or sample, and the interval that decides on which slices
// it lies, which extends into the visual hull behind it. Both require texel.q != 0.
[[nodiscard]] DepthInterval piece_interval(const SurfaceTexel& texel, const SliceOptions& options);
[[nodiscard]] DepthInterval sliced_interval(const SurfaceTexel& texel, const SliceOptions& options);
// Does the slice show texels with this interval?
[[nodiscard]] inline bool shows(const Slice& slice, const DepthInterval& interval) {
  return slice.front <= interval.back && interval.front < slice.back;
}

// The slices of a picture, without empty ones. Requires 1 <= layers <= 4096 and
// 0 <= overlap <= layers.
[[nodiscard]] std::vector<Slice> slice_surface(const TexelSurface& surface,
                                               const SliceOptions& options);

// Makes an impostor of pictures. The direction of each follows from its camera: away from the apex,
// or back to the eye. Fails if there is no picture or more than 1024, if one is not valid or its
// camera is parallel, if all are empty, or if two have the same direction (to a milliradian).
[[nodiscard]] Result<LayeredImpostor> make_layered_impostor(std::vector<DepthImage> pictures,
                                                            const SliceOptions& options);

// Each ordered pair of neighbours, ascending, without slices.
[[nodiscard]] std::vector<FillSlices> neighbor_pairs(const ViewSet& views);

// The slopes up to which texels are linked in pictures of these views: of many views another shows
// what is steep in one.
[[nodiscard]] LinkOptions view_links(const ViewSet& views);

// The unit direction towards the viewers whom a picture of this camera serves.
[[nodiscard]] glm::dvec3 view_direction(const Camera& camera);

// The sizes of an impostor, and what the rectangles save.
struct LayeredStats {
  std::size_t covered_texels = 0;  // texels that show something, over all pictures
  std::size_t slices = 0;          // without empty ones
  std::size_t empty_slices = 0;
  double fill_share = 0;        // texels in rectangles / texels in full slices, empty ones included
  double fill_saved = 0;        // 1 - fill_share
  std::size_t paper_bytes = 0;  // 4 * size^2 * views (table 2)
  double hole_slices = 0;       // slices that fill a pair's holes; mean over ordered pairs
  double hole_fill_share = 0;   // their texels / those of all of the neighbour's slices; mean
};
// Computes them.
[[nodiscard]] LayeredStats analyze_layered_impostor(const LayeredImpostor& impostor);

}  // namespace rilievo
