// What does a terminal show while a program is waited for? One line, however long the name: a
// longer one would not be rewritten in its place.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rilievo::app {

// In fewer columns than there are; then the name's end stays of it. 0 columns: any number.
[[nodiscard]] std::string waiting_text(std::string_view name, std::string_view what, int seconds,
                                       std::size_t columns);

}  // namespace rilievo::app
