#include "apps/rilievo/waiting_text.h"

#include <fmt/format.h>

#include <cstdint>

namespace rilievo::app {

std::string waiting_text(std::string_view name, std::string_view what, int seconds,
                         std::size_t columns) {
  constexpr std::string_view kCut = "...";
  const std::string rest = fmt::format(": waiting for its {}, {} s", what, seconds);
  // The last column stays free: some terminals go on to the next line after it.
  if (columns == 0 || name.size() + rest.size() < columns) return std::string(name) + rest;
  const std::size_t taken = rest.size() + kCut.size() + 1;
  if (columns <= taken) return rest.substr(2, columns - 1);
  // A character takes no more columns than bytes.
  name.remove_prefix(name.size() - (columns - taken));
  while (!name.empty() && (std::uint8_t(name[0]) & 0xC0) == 0x80) name.remove_prefix(1);
  return std::string(kCut).append(name) + rest;
}

}  // namespace rilievo::app
