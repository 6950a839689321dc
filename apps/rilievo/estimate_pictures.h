// How long will the pictures of a bake take? Found out by coarse ones.
#pragma once

#include <vector>

#include "apps/rilievo/progress.h"
#include "rilievo/capture/store/capture_pieces.h"
#include "rilievo/core/result.h"

namespace rilievo::app {

// The seconds that each picture will take: of processor time, ours and that of the programs that we
// started, because other work on the machine lengthens all else. By the clock where nearly none is
// taken: then something else renders, such as a GPU or another machine.
[[nodiscard]] Result<std::vector<double>> estimate_seconds(
    const std::vector<CapturePiece>& pictures, CaptureSource& light, Progress& progress);

}  // namespace rilievo::app
