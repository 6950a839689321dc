// How are names of strangers' files shown on a terminal, which takes some characters for orders?
//
// Control characters (C0, DEL, C1), characters that turn the direction of writing, and bytes that
// are not UTF-8 come out as \xNN, byte by byte; all else as it is.
#pragma once

#include <string>
#include <string_view>

namespace rilievo::app {

[[nodiscard]] std::string printable(std::string_view text);

}  // namespace rilievo::app
