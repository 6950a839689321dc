// How is a layered impostor made of photographs with depth? (S2.7)
//
// By reprojecting all of them (warp/reproject.h) into each of its views: pictures at the
// photographs' own places, each completed by what the others saw, or those of a ViewSet around the
// box. Measured by leaving one photograph out (`rilievo bench rgbd`): from a place between the
// others, pictures at the cameras are 6 dB better where the capture is exact, as good where it is
// not, and leave fewer holes, with a quarter of the texels of 32 views of 512 x 512. So they are
// the default; views around the box are for eyes far from where any camera was.
//
// World space of the photographs. Same bytes for any number of threads.
#pragma once

#include <optional>
#include <span>

#include "rilievo/layered_impostor/layered_impostor.h"
#include "rilievo/warp/reproject.h"

namespace rilievo {

enum class PhotographViews {
  at_cameras,  // pictures from the photographs' own places
  around,      // pictures around the box, back-perspective or as the options say
};

struct PhotographBakeOptions {
  ReprojectOptions reproject;  // its box: the region of interest
  SliceOptions slicing;
  PhotographViews kind = PhotographViews::at_cameras;
  std::optional<glm::dvec3> up;  // not zero; else estimated (capture/upright.h)
  int most_views = 32;           // at_cameras: those that look most differently
  ViewSetOptions views;          // around
  ViewCameraOptions camera;      // around
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
