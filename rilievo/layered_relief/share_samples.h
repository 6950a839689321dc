// What do the lines of sight of one picture miss that those of the others hit? Faces that they
// graze.
//
// A face seen edge-on has samples far apart, or none, and turned towards the eye it shows cracks.
// Lines of sight along three axes hit every face at no less than 35 degrees (a layered depth cube
// [Lischinski, Rappoport 1998]), so each picture gets from the others what it has not got. World
// space, metres.
#pragma once

#include <span>

#include "rilievo/layered_relief/relief_pictures.h"
#include "rilievo/layered_relief/sample_sides.h"

namespace rilievo {

// Places between samples that are added are at most so many units (share_unit) apart.
inline constexpr double kBetween = 0.5;

// The unit of what a picture gets, metres: its texel, and more of a picture with finer texels than
// the largest texel of all, whose splats are larger (relief_splat_scale): between its texel and the
// splats'.
[[nodiscard]] double share_unit(const Camera& camera, double largest_texel);

// Are there places beside a sample that a picture which looks along `forward` gets? Where it goes
// into a closed object, is seen by that picture's viewers, and its own picture sees it well. Other
// pictures have the rest.
[[nodiscard]] bool has_places_beside(const SampleSides& sides, std::size_t sample,
                                     const glm::dvec3& forward);

// Adds to each picture the samples of the others that have none within `reach` of its units, in
// space, and of closed objects what lies between samples (between_samples.h). They stand in the
// middle of the texel that they fall into, up to half its diagonal from
// where they were seen or lie on the surface (Picture::moved); and Picture::lacks is set. Those
// that show the side which the picture's viewers see come first, and samples of the inner sides of
// bodies get the outer side's colour (sample_sides.h). Requires parallel pictures.
void share_samples(ReliefPictures& pictures, double reach);

}  // namespace rilievo
