// Contrast sensitivity, section 4.1.1: in an opponent channel the filter is
//
//   s(r) = sum over i of a_i sqrt(pi / b_i) exp(-pi^2 r^2 / b_i),        r in degrees,
//
// normalised to sum to 1 over the square of radius 3 standard deviations of the widest. Each term
// is a product of two equal Gaussians; so with S_i the sum of term i's along one axis, the square
// sums to the sum of A_i S_i^2, A_i = a_i sqrt(pi / b_i), and normalised Gaussians have weight
// A_i S_i^2 over that.
//
// Features, section 4.2.1: with w = 0.082 degrees from peak to trough, a Gaussian of standard
// deviation w / 2 and its derivatives -x g(x) g(y) and (x^2 / sd^2 - 1) g(x) g(y), whose sign
// depends on x alone: normalising positive and negative weights is done along x, and g(y) sums
// to 1.

#include "rilievo/measure/flip_kernels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rilievo {
namespace {

struct Term {
  double a, b;
};
constexpr Term kAchromatic{1, 0.0047}, kRedGreen{1, 0.0053};
constexpr Term kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};
constexpr double kWidest = 0.04;
constexpr double kFeatureWidth = 0.082;
// Weights below this are nothing to floats.
constexpr double kNegligible = 1e-9;

constexpr double kPi = std::numbers::pi;

struct Gaussian {
  std::vector<double> weights;  // not normalised
  double sum = 0;
};

Gaussian gaussian(double falloff, int radius) {
  Gaussian g;
  for (int x = -radius; x <= radius; ++x) {
    g.weights.push_back(std::exp(-falloff * x * x));
    g.sum += g.weights.back();
  }
  return g;
}

// The Gaussian scaled to the sum `total`, without its negligible ends.
FlipKernel kernel(const Gaussian& g, double total) {
  std::size_t skip = 0;
  while (skip < g.weights.size() / 2 && g.weights[skip] < kNegligible) ++skip;
  FlipKernel out;
  for (std::size_t i = skip; i < g.weights.size() - skip; ++i)
    out.push_back(float(g.weights[i] / g.sum * total));
  return out;
}

// Positive weights to sum to 1, negative ones to -1.
FlipKernel balanced(const std::vector<double>& weights) {
  double positive = 0, negative = 0;
  for (double w : weights) (w > 0 ? positive : negative) += w;
  FlipKernel out;
  for (double w : weights) out.push_back(float(w > 0 ? w / positive : -w / negative));
  return out;
}

}  // namespace

FlipKernels make_flip_kernels(double pixels_per_degree) {
  FlipKernels out;
  const double ppd = pixels_per_degree;
  out.radius = int(std::ceil(3 * std::sqrt(kWidest / (2 * kPi * kPi)) * ppd));
  const auto sensitivity = [&](const Term& term) {
    return gaussian(kPi * kPi / (term.b * ppd * ppd), out.radius);
  };
  out.achromatic = kernel(sensitivity(kAchromatic), 1);
  out.red_green = kernel(sensitivity(kRedGreen), 1);
  double share[2], whole = 0;
  for (int i = 0; i < 2; ++i) {
    const double sum = sensitivity(kBlueYellow[i]).sum;
    share[i] = kBlueYellow[i].a * std::sqrt(kPi / kBlueYellow[i].b) * sum * sum;
    whole += share[i];
  }
  for (int i = 0; i < 2; ++i) {
    out.blue_yellow[i] = kernel(sensitivity(kBlueYellow[i]), share[i] / whole);
    out.blue_yellow_down[i] = kernel(sensitivity(kBlueYellow[i]), 1);
  }

  const double sd = 0.5 * kFeatureWidth * ppd;
  const int radius = int(std::ceil(3 * sd));
  const Gaussian g = gaussian(1 / (2 * sd * sd), radius);
  std::vector<double> slope, curve;
  for (int x = -radius; x <= radius; ++x) {
    const double w = g.weights[std::size_t(x + radius)];
    slope.push_back(-x * w);
    curve.push_back((x * x / (sd * sd) - 1) * w);
  }
  FlipKernel smooth;
  for (double w : g.weights) smooth.push_back(float(w / g.sum));
  out.smooth = smooth;
  out.slope = balanced(slope);
  out.curve = balanced(curve);
  out.radius = std::max(out.radius, radius);
  return out;
}

}  // namespace rilievo
