// How is a layered impostor made of photographs with depth? (S2.7)
//
// By reprojecting all of them (warp/reproject.h) into each of its views: those of a ViewSet around
// the box, or pictures at the photographs' own places, each completed by what the others saw. On a
// room seen from eight places (`rilievo bench rgbd`) both draw a ninth place alike: 32 views of
// 512 x 512 around it 0.2 dB better, pictures at the cameras with fewer holes and a quarter of the
// texels. Around is the default, since it serves eyes anywhere.
//
// World space of the photographs. Same bytes for any number of threads.
#pragma once

#include <span>

#include "rilievo/represent/layered_impostor.h"
#include "rilievo/warp/reproject.h"

namespace rilievo {

enum class PhotographViews {
  at_cameras,  // pictures from the photographs' own places
  around,      // pictures around the box, back-perspective or as the options say
};

struct PhotographBakeOptions {
  ReprojectOptions reproject;  // its box: the region of interest
  SliceOptions slicing;
  PhotographViews kind = PhotographViews::around;
  int most_views = 32;       // at_cameras: those that look most differently
  ViewSetOptions views;      // around
  ViewCameraOptions camera;  // around
};

struct PhotographBake {
  LayeredImpostor impostor;               // without fill slices
  std::vector<ReprojectFigures> figures;  // one a view
  ReprojectFigures total;
};

// Views that show nothing are left out. Nothing if the box is empty or no photograph has samples in
// it.
[[nodiscard]] Result<PhotographBake> bake_photographs(std::span<const DepthImage> photographs,
                                                      const PhotographBakeOptions& options);

}  // namespace rilievo
