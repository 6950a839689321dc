// How are names from untrusted files shown on a terminal, which obeys some characters?
//
// Control characters (C0, DEL, C1), characters that change the direction of writing, and bytes that
// are not UTF-8 become \xNN, byte by byte; everything else is unchanged.
#pragma once

#include <string>
#include <string_view>

namespace rilievo::app {

[[nodiscard]] std::string printable(std::string_view text);

}  // namespace rilievo::app
