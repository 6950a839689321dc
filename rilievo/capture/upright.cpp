// A camera with axes x (right), y (up), z (back) that is rolled and nodded by small angles about
// the true up u has  x . u = sin(roll),  z . u = sin(nod).  With both normally distributed,
//
//   u = argmin over unit vectors of  u^T M u,   M = sum_i w_i (x_i x_i^T / roll^2 + z_i z_i^T /
//   nod^2)
//
// the eigenvector of M's smallest eigenvalue; which of its two signs, the y axes say. Cameras that
// look to one side only leave the nod to the z axes: the mean of the y axes, in short. The more
// they turn, the more the x axes tell, which roll less than people nod.
//
// Weights w_i = 1 / (1 + r_i^2 / 4)^2 of the residuals r_i (Geman, McClure), iterated from the y
// axis with the least sum of angles to the others, make outliers count for nothing.

#include "rilievo/capture/upright.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rilievo {
namespace {

constexpr double kRoll = 0.05, kNod = 0.44;  // radians: 3 and 25 degrees
constexpr int kRounds = 20;
// All pairs are compared: of longer captures every n-th camera.
constexpr std::size_t kMaxCompared = 512;

struct Axes {
  glm::dvec3 x, y, z;
};

double angle(const glm::dvec3& a, const glm::dvec3& b) {
  return std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0));
}

// The index with the least sum of distances to the others.
template <class Distance>
std::size_t medoid(std::size_t count, const Distance& distance) {
  std::size_t best = 0;
  double least = 1e300;
  const std::size_t stride = (count + kMaxCompared - 1) / kMaxCompared;
  for (std::size_t i = 0; i < count; i += stride) {
    double sum = 0;
    for (std::size_t k = 0; k < count; k += stride) sum += distance(i, k);
    if (sum < least) least = sum, best = i;
  }
  return best;
}

// In units of the standard deviations; upside down is as far off as can be.
double squared_residual(const Axes& axes, const glm::dvec3& up) {
  const double roll = glm::dot(axes.x, up) / kRoll, nod = glm::dot(axes.z, up) / kNod;
  return glm::dot(axes.y, up) > 0 ? roll * roll + nod * nod : 1 / (kRoll * kRoll);
}

// Of the smallest eigenvalue, by inverse iteration from `start`. M is positive semi-definite.
glm::dvec3 least_eigenvector(const glm::dmat3& m, const glm::dvec3& start) {
  const double scale = m[0][0] + m[1][1] + m[2][2];
  const glm::dmat3 inverse = glm::inverse(m / scale + 1e-9 * glm::dmat3(1));
  glm::dvec3 v = start;
  for (int i = 0; i < 100; ++i) v = glm::normalize(inverse * v);
  return v;
}

double median_eye_z(const DepthImage& photograph, const Box& box) {
  std::vector<double> depths;
  for (int y = 0; y < photograph.camera.height; y += 4)
    for (int x = 0; x < photograph.camera.width; x += 4) {
      if (!photograph.covered(x, y)) continue;
      const glm::dvec3 world =
          world_from_raster(photograph.camera, {x + 0.5, y + 0.5}, photograph.depth(x, y));
      const bool inside = glm::all(glm::greaterThanEqual(world, glm::dvec3(box.min))) &&
                          glm::all(glm::lessThanEqual(world, glm::dvec3(box.max)));
      if (inside) depths.push_back(photograph.depth(x, y));
    }
  if (depths.empty()) return 0;
  const auto middle = depths.begin() + std::ptrdiff_t(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

}  // namespace

glm::dvec3 estimate_up(std::span<const Camera> cameras) {
  if (cameras.empty()) return {0, 1, 0};
  std::vector<Axes> axes;
  for (const Camera& camera : cameras) {
    const glm::dmat3 m(camera.world_from_eye);
    axes.push_back({m[0], m[1], m[2]});
  }
  const std::size_t first = medoid(
      axes.size(), [&](std::size_t i, std::size_t k) { return angle(axes[i].y, axes[k].y); });
  glm::dvec3 up = axes[first].y;
  for (int round = 0; round < kRounds; ++round) {
    glm::dmat3 m(0.0);
    double above = 0;
    for (const Axes& a : axes) {
      // The first rounds forgive more: the start may be off by a nod.
      const double forgiving = round < 5 ? 16.0 : 4.0;
      const double w = 1 / std::pow(1 + squared_residual(a, up) / forgiving, 2);
      m += w * (glm::outerProduct(a.x, a.x) / (kRoll * kRoll) +
                glm::outerProduct(a.z, a.z) / (kNod * kNod));
    }
    up = least_eigenvector(m, up);
    for (const Axes& a : axes) above += glm::dot(a.y, up) > 0 ? 1 : -1;
    if (above < 0) up = -up;
  }
  return up;
}

Vantage estimate_vantage(std::span<const DepthImage> photographs, const Box& box) {
  std::vector<Camera> cameras, seeing;
  std::vector<double> depths;
  for (const DepthImage& photograph : photographs) {
    cameras.push_back(photograph.camera);
    const double depth = median_eye_z(photograph, box);
    if (!(depth > 0)) continue;
    seeing.push_back(photograph.camera);
    depths.push_back(depth);
  }
  Vantage vantage{estimate_up(cameras), {}};
  if (seeing.empty()) return vantage;
  const std::size_t middle = medoid(seeing.size(), [&](std::size_t i, std::size_t k) {
    return glm::distance(seeing[i].position(), seeing[k].position()) +
           depths[i] * glm::distance(seeing[i].forward(), seeing[k].forward());
  });
  const glm::dvec3 forward = seeing[middle].forward(), eye = seeing[middle].position();
  if (glm::length(glm::cross(forward, vantage.up)) < 0.05) return vantage;
  vantage.gaze = Vantage::Gaze{eye, eye + depths[middle] * forward};
  return vantage;
}

}  // namespace rilievo
