#include "rilievo/io/lens_distortion.h"

#include <cmath>

namespace rilievo {
namespace {

// What the radius is multiplied by.
double stretch(const LensDistortion& lens, double r2) {
  const std::array<double, 6>& k = lens.k;
  if (lens.model == LensDistortion::Model::fisheye) {
    const double r = std::sqrt(r2), t = std::atan(r), t2 = t * t;
    const double bent = 1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])));
    return r > 1e-9 ? t * bent / r : 1.0;
  }
  if (lens.model == LensDistortion::Model::series)
    return 1 + r2 * (k[0] + r2 * (k[1] + r2 * (k[2] + r2 * k[3])));
  return (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[2]))) / (1 + r2 * (k[3] + r2 * (k[4] + r2 * k[5])));
}

}  // namespace

glm::dvec2 distorted(const LensDistortion& lens, const glm::dvec2& point) {
  if (lens.model == LensDistortion::Model::none) return point;
  const double a = point.x, b = point.y, r2 = a * a + b * b;
  const double s = stretch(lens, r2), p1 = lens.p[0], p2 = lens.p[1];
  if (lens.model == LensDistortion::Model::fisheye) return s * point;
  return {a * s + 2 * p1 * a * b + p2 * (r2 + 2 * a * a),
          b * s + p1 * (r2 + 2 * b * b) + 2 * p2 * a * b};
}

double largest_radius(const LensDistortion& lens, double farthest) {
  constexpr int kSteps = 1000;
  double before = 0;
  for (int i = 1; i <= kSteps; ++i) {
    const double r = farthest * i / kSteps, bent = r * stretch(lens, r * r);
    if (!(bent > before)) return farthest * (i - 1) / kSteps;
    before = bent;
  }
  return farthest;
}

}  // namespace rilievo
