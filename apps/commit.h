// From which commit was this program built?
#pragma once

namespace rilievo {

// As `git describe --always --dirty` has it; "unknown" outside of a git checkout.
[[nodiscard]] const char* commit();

}  // namespace rilievo
