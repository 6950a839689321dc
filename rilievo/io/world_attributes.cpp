#include "rilievo/io/world_attributes.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "rilievo/io/text_scan.h"

namespace rilievo {
namespace {

constexpr char kWorld[] = "world";
constexpr std::string_view kAxes = "xyz";

// Keeps texts short; no place is farther away.
constexpr double kFarthest = 1e12;  // metres

}  // namespace

void store_world(const WorldSpace& world, Attributes& file) {
  if (world == WorldSpace{}) return;
  file[kWorld] = fmt::format("{} {} {} up {} unit {}", world.origin.x, world.origin.y,
                             world.origin.z, kAxes[std::size_t(world.up)], world.metres_per_unit);
}

Result<WorldSpace> world_from(const Attributes& file) {
  const auto found = file.find(kWorld);
  if (found == file.end()) return WorldSpace{};
  const Error broken{"", fmt::format("\"{}\" does not say where its scene lies", found->second)};
  std::string_view text = found->second;
  WorldSpace world;
  for (int c = 0; c < 3; ++c) {
    const std::optional<double> number = number_of(take_word(text));
    if (!number || !(std::abs(*number) <= kFarthest)) return broken;
    world.origin[c] = *number;
  }
  if (take_word(text) != "up") return broken;
  const std::string_view axis = take_word(text);
  if (axis.size() != 1 || kAxes.find(axis) == std::string_view::npos) return broken;
  world.up = UpAxis(kAxes.find(axis));
  if (take_word(text) != "unit") return broken;
  const std::optional<double> unit = number_of(take_word(text));
  if (!unit || !(*unit > 0 && std::isfinite(*unit)) || !take_word(text).empty()) return broken;
  world.metres_per_unit = *unit;
  return world;
}

}  // namespace rilievo
