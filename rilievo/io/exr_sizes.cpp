#include "rilievo/io/exr_sizes.h"

#include <cstdint>

namespace rilievo {
namespace {

constexpr std::string_view kMagic("\x76\x2f\x31\x01", 4);
constexpr std::uint32_t kMultiPart = 0x1000;  // a flag of the version field

const Error kCutShort{"", "ends within its header"};

std::uint32_t little_endian(std::string_view four) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | std::uint8_t(four[std::size_t(i)]);
  return value;
}

// Takes a string up to its 0 off the front of `rest`; false if there is no 0.
bool take_string(std::string_view& rest, std::string_view& out) {
  const std::size_t end = rest.find('\0');
  if (end == std::string_view::npos) return false;
  out = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  return true;
}

// Takes one part's attributes off the front of `rest`; `empty` if there were none.
Result<> take_part(std::string_view& rest, bool& empty) {
  empty = true;
  for (std::string_view name, type; true; empty = false) {
    if (!take_string(rest, name)) return kCutShort;
    if (name.empty()) return Done{};
    if (!take_string(rest, type) || rest.size() < 4) return kCutShort;
    const std::uint32_t size = little_endian(rest);
    rest.remove_prefix(4);
    if (size > rest.size())
      return Error{"", "an attribute claims " + std::to_string(size) + " bytes, more than follow"};
    rest.remove_prefix(size);
  }
}

}  // namespace

Result<> check_exr_sizes(std::string_view file) {
  if (!file.starts_with(kMagic)) return Error{"", "is not an OpenEXR file"};
  if (file.size() < 8) return kCutShort;
  const bool multi_part = (little_endian(file.substr(4)) & kMultiPart) != 0;
  std::string_view rest = file.substr(8);
  bool empty = false;
  do {
    if (Result<> part = take_part(rest, empty); !part) return part;
  } while (multi_part && !empty);
  return Done{};
}

}  // namespace rilievo
