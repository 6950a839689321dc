// How is an object kept as a few pictures from all around, each drawn as a stack of slices?
//
// A layered impostor (S2) is a set of pictures with depth, one for each direction of a ViewSet.
// Each is cut into slices: a slice shows the texels whose piece of surface (texel_surface.h)
// reaches into its interval, and is drawn as one quad across the capture frustum at the middle of
// that interval (S2.3). A texel lies on every slice that its piece crosses, and intervals may
// overlap besides, so that a surface that passes from one slice to the next does not tear when the
// eye moves (S2.4). Slices keep the rectangle that holds texels; empty ones are dropped (S2.5).
//
// Depths: eye_z of the picture's camera, metres. Rectangles: texels, row 0 on top. Owns its
// pictures. Pure; same result for any number of threads.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "rilievo/capture/view_set.h"
#include "rilievo/core/bounds.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/warp/texel_surface.h"

namespace rilievo {

// Where the slices stand between the picture's nearest and farthest sample.
enum class SliceSpacing {
  // Evenly in eye_z. A sample moves by at most half the spacing, along its ray. A viewer far away
  // on the other side of the object than the apex sees that move at one scale, wherever it is.
  eye_z,
  // Evenly in window_z, as the paper's depth buffer had it: dense near the apex, which for a
  // back-perspective picture is the side that the viewer does not see.
  window_z,
};

struct SliceOptions {
  int layers = 64;       // 1 to 4096
  float overlap = 0.0f;  // by how much of its own thickness an interval reaches beyond, both ends
                         // together; 0: the intervals are disjoint
  bool pieces = true;    // a texel has the interval of its piece, and of the inside of the object
                         // behind it (inside.h); else only its sample's depth
  SliceSpacing spacing = SliceSpacing::eye_z;
};

// Texels x0 <= x < x1, y0 <= y < y1.
struct TexelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  [[nodiscard]] std::size_t area() const { return std::size_t(x1 - x0) * std::size_t(y1 - y0); }
  friend bool operator==(const TexelRect&, const TexelRect&) = default;
};

struct Slice {
  int layer = 0;              // 0 at the apex or eye, counted before empty ones are dropped
  float eye_z = 0;            // where it is drawn
  float front = 0, back = 0;  // it shows texels with front <= eye_z < back
  TexelRect rect;
};

// What shows of a neighbour through the holes of a view (S2.6).
struct FillSlice {
  int slice = 0;   // index into the neighbour's slices
  TexelRect rect;  // of the texels that show
  friend bool operator==(const FillSlice&, const FillSlice&) = default;
};
struct FillSlices {
  int view = 0, neighbor = 0;
  std::vector<FillSlice> slices;  // ascending
};

struct LayeredImpostor {
  std::string name;
  Box bounds;  // of the samples, world
  Vantage
      vantage;  // for default paths; from photographs, which way was up and where they were taken
  SliceOptions slicing;
  ViewSet views;
  std::vector<DepthImage> pictures;        // one a direction
  std::vector<TexelSurface> surfaces;      // one a picture
  std::vector<std::vector<Slice>> slices;  // one list a picture, by ascending layer
  // One a picture: where it shows nothing, does it know that nothing is there? Not if its frustum
  // leaves out where other pictures have samples, or if it lacks samples, as one made of
  // photographs may (S2.7): such texels have colour, but no depth.
  std::vector<bool> complete;
  std::vector<FillSlices> fills;  // not found yet, or one for each ordered pair of
                                  // neighbours, ascending
};

// The interval of eye_z of a texel's piece, or of its sample; and the one that decides on which
// slices it lies, which reaches behind it into the inside. Require texel.q != 0.
[[nodiscard]] DepthInterval piece_interval(const SurfaceTexel& texel, const SliceOptions& options);
[[nodiscard]] DepthInterval sliced_interval(const SurfaceTexel& texel, const SliceOptions& options);
[[nodiscard]] inline bool shows(const Slice& slice, const DepthInterval& interval) {
  return slice.front <= interval.back && interval.front < slice.back;
}

// Requires 1 <= layers <= 4096 and 0 <= overlap <= layers.
[[nodiscard]] std::vector<Slice> slice_surface(const TexelSurface& surface,
                                               const SliceOptions& options);

// Puts pictures together. Their directions are those in which their cameras look away from the
// apex, or back to the eye. Nothing if there is no picture, if one is not valid or not from a
// perspective or back-perspective camera, if all are empty, if two share a direction (to a
// milliradian), or if there are more than 1024.
[[nodiscard]] Result<LayeredImpostor> make_layered_impostor(std::vector<DepthImage> pictures,
                                                            const SliceOptions& options);

// Every ordered pair of neighbours, ascending, without slices.
[[nodiscard]] std::vector<FillSlices> neighbor_pairs(const ViewSet& views);

// The direction towards the viewers whom a picture from this camera serves. Unit.
[[nodiscard]] glm::dvec3 view_direction(const Camera& camera);

// What the rectangles save, and what it all takes.
struct LayeredFigures {
  std::size_t covered_texels = 0;  // that show something, over all pictures
  std::size_t slices = 0;          // left after empty ones are dropped
  std::size_t empty_slices = 0;
  double fill_share = 0;        // texels in rectangles over texels in full slices, before dropping
  double fill_saved = 0;        // 1 - fill_share
  std::size_t paper_bytes = 0;  // 4 * size^2 * views (table 2)
  double hole_slices = 0;       // slices that fill a pair's holes, mean over ordered pairs
  double hole_fill_share = 0;   // their texels over those of all of the neighbour's slices, mean
};
[[nodiscard]] LayeredFigures analyze_layered_impostor(const LayeredImpostor& impostor);

}  // namespace rilievo
