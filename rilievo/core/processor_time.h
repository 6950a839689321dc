// How much work was it? Processor time, which other programs' work does not lengthen.
#pragma once

namespace rilievo {

// Seconds of processor time of this process with all its threads, and of what it started, with all
// that those started in turn, whether it runs still or was waited for. Linux: what /proc does not
// tell is left out.
[[nodiscard]] double processor_seconds();

}  // namespace rilievo
