// How are curves drawn so that a browser shows them without scripts or other files?
//
// Line plots as SVG text, with a legend and round numbers on linear or logarithmic axes. Text takes
// the colour of the page, light or dark. Each plot carries its range of x (data-x-min, data-x-max)
// and the extent of its frame (data-left, data-right, in units of the viewBox), so that a page can
// place a cursor in it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rilievo {

// A named series of points.
struct Curve {
  std::string name;
  std::vector<double> x, y;  // equally many
};

// Curves with their axes.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
  bool log_x = false, log_y = false;
  bool points = false;  // marks the samples, for curves with few of them
};

// The plot as an SVG element. A sample that is not finite, or not positive on a logarithmic axis,
// interrupts its curve.
[[nodiscard]] std::string svg_plot(const Plot& plot);

// The CSS colour of curve `index` in svg_plot.
[[nodiscard]] std::string curve_color(std::size_t index);

}  // namespace rilievo
