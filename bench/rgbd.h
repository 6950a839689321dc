// What do layered impostors of real places look like, from where a camera really was? (S2.7)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Of a capture (BenchOptions::capture; without one, a made up one) each photograph is left out in
// turn: an impostor is baked of the others, and drawn for the camera that was left out. In three
// ways: pictures at the other cameras, pictures around the box, and, to see what the data would
// give without being kept as pictures, the others reprojected into the camera directly.
//
// Figures, for each WAY (cameras, around, direct): psnr_WAY (of the pixels that are drawn, dB, mean
// over the frames), uncovered_WAY (share of the pixels that are not drawn), uncovered_seen_WAY (the
// same of the pixels that some other camera sees), holes_WAY (share within the views' silhouettes
// that no photograph fills).
[[nodiscard]] Result<BenchReport> rgbd(const BenchOptions& options);

}  // namespace rilievo::bench
