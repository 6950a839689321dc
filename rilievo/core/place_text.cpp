#include "rilievo/core/place_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

std::string number_text(double value, double size) {
  std::string short_text = fmt::format("{:.4g}", value);
  if (!std::isfinite(value) || !(size > 0)) return short_text;
  // The step of four digits, and the one that is asked for: 10 to the power of.
  const double step = value == 0 ? -9 : std::floor(std::log10(std::abs(value))) - 3;
  const double wanted = std::floor(std::log10(size)) - 3;
  if (step <= wanted) return short_text;
  const int decimals = int(std::clamp(-wanted, 0.0, 9.0));
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (decimals > 0) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

}  // namespace

std::string place_text(const glm::dvec3& place, double size) {
  return number_text(place.x, size) + " " + number_text(place.y, size) + " " +
         number_text(place.z, size);
}

}  // namespace rilievo
