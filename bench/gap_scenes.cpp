#include "bench/gap_scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rilievo::bench {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

bool cast_ball(const GapSolid& s, const glm::dvec3& m, const glm::dvec3& d, double& in,
               double& out) {
  const double a = glm::dot(d, d), half = glm::dot(m, d);
  const double square = half * half - a * (glm::dot(m, m) - s.radius * s.radius);
  if (square < 0) return false;
  in = (-half - std::sqrt(square)) / a, out = (-half + std::sqrt(square)) / a;
  return true;
}

bool cast_box(const GapSolid& s, const glm::dvec3& m, const glm::dvec3& d, double& in,
              double& out) {
  in = -kNowhere, out = kNowhere;
  for (int i = 0; i < 3; ++i) {
    const double p = glm::dot(m, s.axes[i]), q = glm::dot(d, s.axes[i]);
    if (q == 0) {
      if (std::abs(p) > s.half[i]) return false;
      continue;
    }
    const double a = (-s.half[i] - p) / q, b = (s.half[i] - p) / q;
    in = std::max(in, std::min(a, b)), out = std::min(out, std::max(a, b));
  }
  return in <= out;
}

bool cast_disc(const GapSolid& s, const glm::dvec3& m, const glm::dvec3& d, double& in,
               double& out) {
  const double towards = glm::dot(d, s.axes[2]);
  if (towards == 0) return false;
  in = out = -glm::dot(m, s.axes[2]) / towards;
  const glm::dvec3 at = m + in * d;
  return glm::dot(at, at) <= s.radius * s.radius;
}

glm::dmat3 axes_of(const glm::dvec3& x, const glm::dvec3& near_y) {
  const glm::dvec3 a = glm::normalize(x), c = glm::normalize(glm::cross(a, near_y));
  return {a, glm::cross(c, a), c};
}

GapSolid ball(const glm::dvec3& center, double radius) {
  GapSolid s;
  s.center = center, s.radius = radius;
  return s;
}

GapSolid box_of(const glm::dvec3& center, const glm::dvec3& half,
                const glm::dmat3& axes = glm::dmat3(1.0)) {
  GapSolid s;
  s.kind = GapSolid::Kind::box, s.center = center, s.half = half, s.axes = axes;
  return s;
}

GapSolid disc(const glm::dvec3& center, double radius, const glm::dvec3& normal) {
  GapSolid s;
  s.kind = GapSolid::Kind::disc, s.center = center, s.radius = radius;
  const glm::dvec3 other = std::abs(normal.x) < 0.8 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(normal, other));
  s.axes = {x, glm::cross(normal, x), normal};
  return s;
}

void add_leaves(GapScene& scene, int count, double size, const glm::dvec3& center, double spread,
                SplitMix64& random) {
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 at = center + random.vector(spread * std::cbrt(random.next()));
    const double radius = size * random.between(0.3, 1);
    scene.solids.push_back(disc(at, radius, random.direction()));
  }
}

}  // namespace

bool GapScene::cast(const glm::dvec3& origin, const glm::dvec3& direction, double& first,
                    double& last) const {
  first = kNowhere, last = -kNowhere;
  for (const GapSolid& s : solids) {
    const glm::dvec3 m = origin - s.center;
    double in = 0, out = 0;
    const bool hit = s.kind == GapSolid::Kind::ball  ? cast_ball(s, m, direction, in, out)
                     : s.kind == GapSolid::Kind::box ? cast_box(s, m, direction, in, out)
                                                     : cast_disc(s, m, direction, in, out);
    if (hit && in > 0) first = std::min(first, in), last = std::max(last, out);
  }
  return first < kNowhere;
}

double GapScene::reach() const {
  double reach = 0;
  for (const GapSolid& s : solids) {
    glm::dvec3 r(s.radius);
    if (s.kind == GapSolid::Kind::box)
      for (int i = 0; i < 3; ++i)
        r[i] = std::abs(s.axes[0][i]) * s.half.x + std::abs(s.axes[1][i]) * s.half.y +
               std::abs(s.axes[2][i]) * s.half.z;
    for (int i = 0; i < 3; ++i) reach = std::max(reach, std::abs(s.center[i]) + r[i]);
  }
  return reach;
}

GapScene make_gap_scene(std::size_t kind, SplitMix64& random) {
  GapScene scene;
  const auto add = [&](const GapSolid& s) { scene.solids.push_back(s); };
  const auto in = [&](double low, double high) { return random.between(low, high); };
  switch (kind) {
    case 0:
      add(ball({0, 0, 0}, in(0.5, 2)));
      break;
    case 1: {
      const glm::dvec3 half{in(0.4, 1.2), in(0.4, 1.2), in(0.4, 1.2)};
      const glm::dvec3 x = random.direction(), y = random.direction();
      add(box_of({0, 0, 0}, half, axes_of(x, y)));
      break;
    }
    case 2: {
      const glm::dvec3 center{in(-0.5, 0.5), in(-0.5, 0.5), 0};
      add(box_of(center, {1, 1, in(0.3, 2)}));
      break;
    }
    case 3:
      add(box_of({0, 0, 1}, {1, 1, 0.03}));
      for (int i = 0; i < 4; ++i) {
        const glm::dvec3 center{in(0.2, 1.6), in(-0.8, 0.8), in(-1.5, 0.5)};
        add(box_of(center, {1, in(0.05, 0.2), 0.05}));
      }
      break;
    case 4:  // bars wholly behind the plate, for an eye some ten metres away
      add(box_of({0, 0, 1}, {1, 1, 0.03}));
      for (int i = 0; i < 3; ++i) {
        const double side = random.next() < 0.5 ? -1 : 1;
        add(box_of({side * in(0.7, 0.8), 0, in(-1.5, 0.5)}, {0.15, 0.7, 0.05}));
      }
      break;
    case 5: {
      const double depth = in(0.2, 1.2), width = in(0.03, 0.07);
      for (int i = 0; i < 12; ++i) add(box_of({-1.4 + 2.8 * i / 11, 0, 0}, {width, 1, depth}));
      add(box_of({0, 1, 0}, {1.5, 0.1, depth}));
      if (random.next() < 0.5) add(box_of({0, 0, -depth - 0.2}, {1.5, 1, 0.05}));
      break;
    }
    case 6: {
      double z = 1;
      for (int layer = 0; layer < 3; ++layer) {
        const double width = in(0.03, 0.08), apart = in(0.18, 0.4);
        for (double x = -1.5 + in(0, 0.3); x < 1.5; x += apart)
          add(box_of({x, 0, z}, {width, 1, 0.03}));
        z -= in(0.3, 1);
      }
      if (random.next() < 0.5) add(box_of({0, 0, z}, {1.6, 1.1, 0.03}));
      break;
    }
    case 7:
      add_leaves(scene, random.next() < 0.5 ? 50 : 160, 0.3, {0, 0, 0}, 1.5, random);
      break;
    case 8:
      add(box_of({0, -0.8, 0}, {0.12, 1.2, 0.12}));
      add_leaves(scene, 90, 0.22, {0, 0.7, 0}, 1.1, random);
      add(box_of({0, -2, 0}, {1.8, 0.05, 1.8}));
      break;
    case 9:
      add(box_of({0, -0.8, 0}, {2, 0.05, 3}));
      for (int i = 0; i < 14; ++i) {
        const double radius = in(0.1, 0.4);
        add(ball({in(-1.5, 1.5), i % 2 ? in(-0.3, 1.2) : radius - 0.75, in(-2, 2)}, radius));
      }
      break;
    case 10:
      for (int i = 0; i < 18; ++i) {
        const double width = in(0.04, 0.2);
        const glm::dvec3 center{in(-1.5, 1.5), 0, in(-3, 2)};
        const glm::dvec3 x{1, in(-0.2, 0.2), in(-1, 1)}, y{in(-0.2, 0.2), 1, 0};
        add(box_of(center, {width, 1, width}, axes_of(x, y)));
      }
      break;
    default:
      for (int i = 0; i < 9; ++i) {
        const glm::dvec3 center{in(-1.2, 1.2), in(-1, 1), in(-2.5, 1.5)};
        const glm::dvec3 half{in(0.1, 0.6), in(0.1, 0.6), 0.02};
        const glm::dvec3 x{1, 0, in(-0.3, 0.3)}, y{in(-0.3, 0.3), 1, in(-0.3, 0.3)};
        add(box_of(center, half, axes_of(x, y)));
      }
  }
  return scene;
}

}  // namespace rilievo::bench
