// How do figures become a picture that a browser shows without anything else?
//
// Line plots as SVG text: axes with round numbers, linear or logarithmic; a legend; text in the
// colour of its surroundings, so that they fit a light page and a dark one. Every plot carries its
// range of x as data-x-min, data-x-max and its frame as data-left, data-right (in units of the
// viewBox), so that a page can put a cursor into it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rilievo {

struct Curve {
  std::string name;
  std::vector<double> x, y;  // equally many
};

struct Plot {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
  bool log_x = false, log_y = false;
  bool points = false;  // marks at the samples, for curves of few
};

// Samples that are not finite, or not positive on a logarithmic axis, interrupt their curve.
[[nodiscard]] std::string svg_plot(const Plot& plot);

// The colour that svg_plot draws curve `index` in, as CSS.
[[nodiscard]] std::string curve_color(std::size_t index);

}  // namespace rilievo
