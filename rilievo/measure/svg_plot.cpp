#include "rilievo/measure/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/expects.h"
#include "rilievo/measure/html.h"

namespace rilievo {
namespace {

// Sizes in units of the viewBox; the page scales it.
constexpr double kWidth = 640, kHeight = 300;
constexpr double kLeft = 62, kRight = kWidth - 14, kTop = 58, kBottom = kHeight - 44;

// Distinguishable with any kind of colour vision, on white and on black.
constexpr const char* kColors[] = {"#0a84d0", "#e0602a", "#14a37f", "#c774b2",
                                   "#d9a300", "#7d8ee8", "#8a8f98", "#a0522d"};

constexpr double kLegendRow = 18;

// Colours come again, dashed.
std::string stroke(std::size_t curve) {
  return fmt::format("stroke=\"{}\"{}", curve_color(curve),
                     curve >= std::size(kColors) ? " stroke-dasharray=\"5 3\"" : "");
}

// One axis: values between low and high (their logarithms if log) onto from ... to.
struct Axis {
  bool log = false;
  double low = 0, high = 1, from = 0, to = 1;

  [[nodiscard]] bool shows(double v) const { return std::isfinite(v) && (!log || v > 0); }
  [[nodiscard]] double place(double v) const {
    const auto t = [&](double value) { return log ? std::log10(value) : value; };
    return from + (t(v) - t(low)) / (t(high) - t(low)) * (to - from);
  }
};

// Round numbers 1, 2, 5 * 10^k, about `wanted` of them between low and high.
std::vector<double> linear_ticks(double low, double high, int wanted) {
  const double rough = (high - low) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (double round : {1.0, 2.0, 5.0})
    if (round * power >= rough) {
      step = round * power;
      break;
    }
  std::vector<double> ticks;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
    ticks.push_back(k == 0 ? 0.0 : k * step);
  return ticks;
}

// Decades; 2 and 5 of each too if there are few of them; every second or third if there are many.
std::vector<double> log_ticks(double low, double high) {
  const double first = std::floor(std::log10(low)), last = std::ceil(std::log10(high));
  const double step = std::max(1.0, std::ceil((last - first) / 7));
  std::vector<double> ticks;
  for (double e = first; e <= last; e += step)
    for (double m : {1.0, 2.0, 5.0}) {
      if (m > 1 && last - first > 3) break;
      const double v = m * std::pow(10.0, e);
      if (v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9)) ticks.push_back(v);
    }
  return ticks;
}

Axis make_axis(const std::vector<Curve>& curves, std::vector<double> Curve::*values, bool log,
               double from, double to) {
  Axis axis{log, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
            from, to};
  for (const Curve& curve : curves)
    for (double v : curve.*values)
      if (axis.shows(v)) {
        axis.low = std::min(axis.low, v);
        axis.high = std::max(axis.high, v);
      }
  if (axis.low > axis.high) axis.low = axis.high = 1;  // nothing to show
  return axis;
}

// Values that differ by rounding alone are one value: ticks between them would have no end.
bool is_one_value(const Axis& axis) {
  return axis.high - axis.low <= 1e-9 * std::max(std::abs(axis.low), std::abs(axis.high));
}

// Some room for curves that are constant, and above and below the others.
void widen(Axis& axis) {
  if (axis.log) {
    if (is_one_value(axis)) axis.low /= 2, axis.high *= 2;
    const double margin = std::pow(axis.high / axis.low, 0.05);
    axis.low /= margin, axis.high *= margin;
    return;
  }
  if (is_one_value(axis)) {
    const double half = axis.low == 0 ? 1 : 0.1 * std::abs(axis.low);
    axis.low -= half, axis.high += half;
  }
  // Figures that are never negative begin at 0 if that costs little of the height.
  const bool from_zero = axis.low >= 0 && axis.low < 0.35 * axis.high;
  const double margin = 0.05 * (axis.high - axis.low);
  axis.low = from_zero ? 0 : axis.low - margin;
  axis.high += margin;
}

std::string number(double v) {
  const double size = std::abs(v);
  if (size != 0 && size < 1e-4) return fmt::format("{:.0e}", v);
  if (size >= 1e15) return fmt::format("{:.0e}", v);
  if (size >= 1e9) return fmt::format("{:.6g}G", v / 1e9);
  if (size >= 1e6) return fmt::format("{:.6g}M", v / 1e6);
  if (size >= 1e4) return fmt::format("{:.6g}k", v / 1e3);
  return fmt::format("{:.6g}", v);
}

std::string ticks_of(const Axis& x, const Axis& y) {
  std::string out;
  for (double v : y.log ? log_ticks(y.low, y.high) : linear_ticks(y.low, y.high, 7))
    out += fmt::format(
        "<line class=\"grid\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        kLeft, kRight, y.place(v), kLeft - 7, y.place(v) + 4, number(v));
  for (double v : x.log ? log_ticks(x.low, x.high) : linear_ticks(x.low, x.high, 8))
    out += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>"
        "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text>\n",
        x.place(v), kTop, kBottom, kBottom + 17, number(v));
  return out;
}

std::string curve_path(const Curve& curve, const Axis& x, const Axis& y, bool points,
                       std::size_t index) {
  const std::string color = curve_color(index);
  std::string path, marks;
  bool pen_down = false;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!x.shows(curve.x[i]) || !y.shows(curve.y[i])) {
      pen_down = false;
      continue;
    }
    const double px = x.place(curve.x[i]), py = y.place(curve.y[i]);
    path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", px, py);
    // A sample alone has no line to be seen by.
    const bool alone = !pen_down && (i + 1 == curve.x.size() || !x.shows(curve.x[i + 1]) ||
                                     !y.shows(curve.y[i + 1]));
    if (points || alone)
      marks +=
          fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.2\" fill=\"{}\"/>", px, py, color);
    pen_down = true;
  }
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" {} stroke-width=\"2\" stroke-linejoin=\"round\"/>{}\n", path,
      stroke(index), marks);
}

// In as many rows as it takes; `rows` is how many that are.
std::string legend(const std::vector<Curve>& curves, int& rows) {
  std::string out;
  double at = kLeft;
  rows = 1;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const double width = 42 + 6.6 * double(curves[i].name.size());
    if (at > kLeft && at + width > kWidth + 10) at = kLeft, ++rows;
    const double y = 40 + kLegendRow * (rows - 1);
    out += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2}\" y2=\"{2}\" {3} stroke-width=\"3\"/>"
        "<text x=\"{4:.1f}\" y=\"{5}\">{6}</text>\n",
        at, at + 18, y, stroke(i), at + 23, y + 4, html_text(curves[i].name));
    at += width;
  }
  return out;
}

}  // namespace

std::string curve_color(std::size_t index) { return kColors[index % std::size(kColors)]; }

std::string svg_plot(const Plot& plot) {
  for ([[maybe_unused]] const Curve& curve : plot.curves)
    RILIEVO_EXPECTS_EQ(curve.x.size(), curve.y.size());
  Axis x = make_axis(plot.curves, &Curve::x, plot.log_x, kLeft, kRight);
  Axis y = make_axis(plot.curves, &Curve::y, plot.log_y, kBottom, kTop);
  if (is_one_value(x) || plot.log_x) widen(x);
  widen(y);
  int rows = 1;
  const std::string names = legend(plot.curves, rows);
  const double down = kLegendRow * (rows - 1);

  std::string out = fmt::format(
      "<svg class=\"plot\" viewBox=\"0 0 {} {}\" xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" "
      "data-left=\"{}\" data-right=\"{}\" data-x-min=\"{}\" data-x-max=\"{}\" "
      "font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"currentColor\">\n"
      "<style>.grid{{stroke:currentColor;stroke-opacity:.14}}</style>\n"
      "<text x=\"{}\" y=\"20\" font-size=\"15\" font-weight=\"600\">{}</text>\n",
      kWidth, kHeight + down, kLeft, kRight, x.low, x.high, kLeft, html_text(plot.title));
  out += names;
  out += fmt::format("<g transform=\"translate(0 {})\">\n", down);
  out += ticks_of(x, y);
  for (std::size_t i = 0; i < plot.curves.size(); ++i)
    out += curve_path(plot.curves[i], x, y, plot.points, i);
  out += fmt::format(
      "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n"
      "<text transform=\"translate(14 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n"
      "<line class=\"cursor\" x1=\"-9\" x2=\"-9\" y1=\"{}\" y2=\"{}\" stroke=\"currentColor\" "
      "stroke-dasharray=\"3 3\"/>\n</g>\n</svg>\n",
      0.5 * (kLeft + kRight), kHeight - 8, html_text(plot.x_label), 0.5 * (kTop + kBottom),
      html_text(plot.y_label), kTop, kBottom);
  return out;
}

}  // namespace rilievo
