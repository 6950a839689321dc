// The coarse picture of objects for which a frame has neither time nor a picture.
//
// One picture shows all of them, with the frame's own camera but larger texels, captured by rays:
// its cost depends on texels alone, and on how many objects lie behind each other not at all.
#pragma once

#include <span>

#include "rilievo/cache/plan/capture_cost.h"

namespace rilievo {

// Texels of two pixels still tell what each pixel shows.
inline constexpr double kCoarsestFallback = 0.5;

// The scale of the fallback's texels, 1: those of the frame; for objects that cover `pixels`
// pixels, with `budget` left for them (CacheOptions::fallback_cost). At least `coarsest`, where the
// largest picture allows it.
[[nodiscard]] double fallback_scale(const ViewAxes& view, double pixels, double budget,
                                    double coarsest, const CacheOptions& options);

// The geometry of a picture of what lies in `boxes` (not empty) with texels of this scale: those of
// a picture of the whole frame, of the part around the boxes.
[[nodiscard]] PictureGeometry fallback_geometry(const ViewAxes& view, std::span<const Box> boxes,
                                                double scale, const CacheOptions& options);

}  // namespace rilievo
