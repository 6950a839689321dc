// How is a layered impostor made of photographs with depth? (S2.7)
//
// Reprojects all photographs (warp/reproject.h) into each of its views. The views are either the
// photographs' own cameras, each picture completed by what the others saw, or those of a ViewSet
// around the box. With one photograph left out (`rilievo bench rgbd`) and seen from between the
// others, pictures at the cameras are 6 dB better where the capture is exact, equally good where it
// is not, and leave fewer holes, with a quarter of the texels of 32 views of 512 x 512. So they are
// the default; views around the box serve eyes far from all cameras.
//
// World space of the photographs. The result does not depend on the number of threads.
#pragma once

#include <optional>
#include <span>

#include "rilievo/layered_impostor/layered_impostor.h"
#include "rilievo/warp/reproject.h"

namespace rilievo {

// Where the views of the impostor are.
enum class PhotographViews {
  at_cameras,  // at the photographs' cameras
  around,      // around the box, back-perspective or as the options say
};

// The region, the views and the slicing.
struct PhotographBakeOptions {
  ReprojectOptions reproject;  // its box is the region of interest
  SliceOptions slicing;
  PhotographViews kind = PhotographViews::at_cameras;
  std::optional<glm::dvec3> up;  // not zero; by default estimated (capture/upright.h)
  int most_views = 32;           // for at_cameras: the most different ones are kept
  ViewSetOptions views;          // for around
  ViewCameraOptions camera;      // for around
};

// The impostor, and how complete its pictures are.
struct PhotographBake {
  LayeredImpostor impostor;           // without fill slices
  std::vector<ReprojectStats> stats;  // one for each view
  ReprojectStats total;
};

// Bakes photographs. Views that show nothing are left out. Fails if the box is empty or no
// photograph has samples in it.
[[nodiscard]] Result<PhotographBake> bake_photographs(std::span<const DepthImage> photographs,
                                                      const PhotographBakeOptions& options);

}  // namespace rilievo
