#include "rilievo/io/stroke_attributes.h"

#include <fmt/format.h>

#include <optional>

#include "rilievo/io/text_scan.h"

namespace rilievo {
namespace {

constexpr char kStrokes[] = "strokes";
constexpr double kLargest = 1e12;  // metres, or texels: nothing is larger

}  // namespace

void store_strokes(const StrokeSize& strokes, Attributes& file) {
  if (strokes.any()) file[kStrokes] = fmt::format("{} {}", strokes.disc_radius, strokes.texels);
}

Result<StrokeSize> strokes_from(const Attributes& file) {
  const auto found = file.find(kStrokes);
  if (found == file.end()) return StrokeSize{};
  std::string_view text = found->second;
  const std::optional<double> radius = number_of(take_word(text));
  const std::optional<double> texels = number_of(take_word(text));
  const auto good = [](const std::optional<double>& n) { return n && *n >= 0 && *n <= kLargest; };
  if (!good(radius) || !good(texels) || !take_word(text).empty())
    return Error{"", fmt::format("\"{}\" is no size of points and lines", found->second)};
  return StrokeSize{*radius, *texels};
}

}  // namespace rilievo
