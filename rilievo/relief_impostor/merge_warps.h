// What do the warps of two pictures show together, for one eye?
//
// Both are nailboards as their common eye would have captured them, on different planes: a
// homography takes the texels of one to the other's, without parallax. What one picture did not
// see, behind a silhouette or where it is stretched over a gap, comes from the other; where both
// see the same surface, colours are mixed, so that highlights change from picture to picture
// instead of jumping.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/relief_impostor/impostor_warp.h"

namespace rilievo {

// The rectangle that a warp fills in the raster of `picture`, whose eye may be another one: left,
// top, right, bottom, texels. None if the warp's eye does not see all of it in front of it.
[[nodiscard]] std::optional<glm::dvec4> rectangle_on(const PictureGeometry& picture,
                                                     const Prewarped& warp);

// Adds what `other` shows to `main`. The flags are those of ImpostorWarpScratch; texels of `main`
// that are replaced lose them. `share`: of other's colours, where both show the same surface; 0
// to 1. Requires 16 bits of Delta and one eye. `texels` is a buffer that is kept from merge to
// merge. On all cores, or on the calling thread alone, with the same result.
void merge_warps(Prewarped& main, std::span<std::uint16_t> main_flags, const Prewarped& other,
                 std::span<const std::uint16_t> other_flags, double share,
                 std::vector<WarpTexel>& texels, bool parallel);

// Buffers that are kept from pair to pair.
struct WarpPairScratch {
  ImpostorWarpScratch main, other;
  Prewarped board;  // of the other
  std::vector<WarpTexel> texels;
};

// Warps two pictures for an eye and merges them. The one whose eye is nearer is the main one: alone
// where it is a hundredth as far as the other, so that a picture is shown as it is from its own
// eye, or where the other cannot be warped. Colours are mixed where the eye lies between the two.
// None if neither can be warped. Counts the main warp's texels.
[[nodiscard]] std::optional<WarpedTexels> warp_pair(const ImpostorPicture& one,
                                                    const ImpostorPicture& two,
                                                    const glm::dvec3& eye,
                                                    const ImpostorWarpOptions& options,
                                                    WarpPairScratch& scratch, Prewarped& result);

}  // namespace rilievo
