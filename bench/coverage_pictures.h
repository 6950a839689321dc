// What pictures hold, shown: figures 2 and 5 of [Schaufler 1998].
#pragma once

#include <vector>

#include "bench/objects.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"
#include "rilievo/measure/bench_report.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo::bench {

// The object as `camera` sees it: what the picture taken by `taken` samples in its own shades, what
// it does not in red.
[[nodiscard]] Rgba8Image color_by_coverage(const RayScene& rays, const Camera& taken,
                                           const Camera& camera);

// Figure 2: for an ordinary and a back-perspective picture of one direction the picture itself,
// what it holds seen from the side, and its warp for a higher eye.
[[nodiscard]] Result<std::vector<BenchPicture>> figure_2(const BenchObject& object, int size);

// Figure 5: the 32 back-perspective pictures, and a frame warped from them with the dodecahedron
// whose faces and vertices they look along, drawn as lines behind and before it by depth.
[[nodiscard]] Result<std::vector<BenchPicture>> figure_5(const BenchObject& object, int size);

}  // namespace rilievo::bench
