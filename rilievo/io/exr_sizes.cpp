#include "rilievo/io/exr_sizes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

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

// OpenEXR reads these types without a look at the stated size: bytes of a value.
constexpr std::array<std::pair<std::string_view, std::uint32_t>, 24> kFixedSizes = {
    {{"box2f", 16},
     {"box2i", 16},
     {"chromaticities", 32},
     {"compression", 1},
     {"deepImageState", 1},
     {"double", 8},
     {"envmap", 1},
     {"float", 4},
     {"int", 4},
     {"keycode", 28},
     {"lineOrder", 1},
     {"m33d", 72},
     {"m33f", 36},
     {"m44d", 128},
     {"m44f", 64},
     {"rational", 8},
     {"tiledesc", 9},
     {"timecode", 8},
     {"v2d", 16},
     {"v2f", 8},
     {"v2i", 8},
     {"v3d", 24},
     {"v3f", 12},
     {"v3i", 12}}};

// Is this a list of channels, each a name and 16 bytes, that an empty name ends?
bool is_channel_list(std::string_view value) {
  for (std::string_view name; take_string(value, name); value.remove_prefix(16)) {
    if (name.empty()) return value.empty();
    if (value.size() < 16) return false;
  }
  return false;
}

// Will OpenEXR read as many bytes as the attribute states? Otherwise it takes what follows for
// another attribute than we do.
bool is_read_whole(std::string_view type, std::string_view value) {
  const auto* fixed = std::find_if(kFixedSizes.begin(), kFixedSizes.end(),
                                   [&](const auto& known) { return known.first == type; });
  if (fixed != kFixedSizes.end()) return value.size() == fixed->second;
  if (type == "chlist") return is_channel_list(value);
  if (type == "preview") {
    if (value.size() < 8) return false;
    const std::uint64_t pixels =
        std::uint64_t(little_endian(value)) * little_endian(value.substr(4));
    return pixels == (value.size() - 8) / 4 && value.size() % 4 == 0;
  }
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
    if (!is_read_whole(type, rest.substr(0, size)))
      return Error{"", "an attribute has another size than its type"};
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
