// Whose is the error of an old picture? The colours', the silhouettes', the hidden parts'.
//
// An old picture has the colours that its own eye saw: highlights and reflections move with the
// eye, and no warp can mend that. The rest is the warp's.
#pragma once

#include "bench/bench.h"
#include "bench/impostor_judge.h"

namespace rilievo::bench {

// The object's true surfaces as `now` sees them, with the light that left them towards the eye of
// `before`; what that eye did not see, as `now` sees it: what a perfect warp would show that knows
// all surfaces, and lacks nothing but the new eye's colours.
struct OldLight {
  DepthImage picture;
  Image<std::uint8_t> hidden;  // 1: `before` does not see what the pixel's centre shows
};
[[nodiscard]] OldLight old_light(const TracedScene& traced, const Camera& before, const Camera& now,
                                 int samples);

// Shares of the summed squared difference of two frames.
struct ErrorShares {
  double silhouettes = 0;    // within two pixels of an edge of the depths
  double hidden = 0;         // else: within two pixels of what the old eye did not see
  double hidden_pixels = 0;  // hidden ones, over all that show something
};
// `drawn` and `truth`: the part of the frame at `corner`.
[[nodiscard]] ErrorShares error_shares(const Rgba8Image& drawn, const Rgba8Image& truth,
                                       const glm::ivec2& corner, const OldLight& light);

// Pictures 100 and 500 ms old of an orbit (`turn`: radians a second), taken apart; as a table, with
// figures.
[[nodiscard]] Result<> stale_parts(const TracedScene& traced, ImpostorJudge& judge, double turn,
                                   int eyes, const WorkerOptions& options, BenchReport& report);

}  // namespace rilievo::bench
