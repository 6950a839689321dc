#include "rilievo/scene/builtin/masonry.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "rilievo/core/random.h"

namespace rilievo {
namespace {

// A face of 2 n^2 triangles and a rim of 8 n.
constexpr double kFace = 2, kRim = 8;
// A wall's stones have 2 x 2 cells or more on an average.
constexpr double kMinTriangles = kFace * 4 + kRim * 2;

struct Stone {
  float s0, s1, t0, t1;
};

// The part of `stone` at `s` that lies within the wall.
glm::vec2 cut(const Wall& wall, const Stone& stone, float s) {
  const float low = wall.lower ? std::max(stone.t0, wall.lower(s)) : stone.t0;
  const float high = wall.upper ? std::min(stone.t1, wall.upper(s)) : stone.t1;
  return {low, high};
}

// Height of what the wall leaves of a stone: the mean of three places.
float cut_height(const Wall& wall, const Stone& stone) {
  float sum = 0;
  for (const float share : {0.1f, 0.5f, 0.9f}) {
    const glm::vec2 t = cut(wall, stone, glm::mix(stone.s0, stone.s1, share));
    sum += std::max(0.0f, t.y - t.x);
  }
  return sum / 3;
}

std::vector<Stone> lay(const Wall& wall, float scale, Random& random) {
  std::vector<Stone> stones;
  const int courses = std::max(1, int(std::lround(wall.height / (wall.course * scale))));
  const float course = wall.height / float(courses);
  for (int row = 0; row < courses; ++row) {
    const float t0 = course * float(row), t1 = course * float(row + 1);
    // A short stone first in every other row, so that joints do not line up.
    float s = 0;
    bool first = row % 2 == 1;
    while (s < wall.length - 1e-3f) {
      float end = s + scale * random.between(wall.shortest, wall.longest) * (first ? 0.6f : 1.0f);
      if (end > wall.length - 0.4f * scale * wall.shortest) end = wall.length;
      const Stone stone{s, end, t0, t1};
      const bool left_out = wall.hole && wall.hole(0.5f * (s + end), 0.5f * (t0 + t1));
      if (!left_out && cut_height(wall, stone) > 0.15f * course) stones.push_back(stone);
      s = end, first = false;
    }
  }
  return stones;
}

void add_stone(Mesh& mesh, const Wall& wall, const Stone& stone, int n, Random& random) {
  BoxShape shape;
  shape.n = {n, n, 1};
  shape.back = wall.two_sided;
  // Each in a statement of its own, for the same order with every compiler.
  const float blue = random.between(-1, 1);
  const float red = random.between(-1, 1);
  const float tint = random.between(-1, 1);
  const glm::vec3 color =
      wall.color * (1 + wall.tints * tint) * (1.0f + 0.04f * glm::vec3(red, 0, blue));
  const std::uint64_t seed = random.next();
  const float width = stone.s1 - stone.s0 - 2 * wall.joint;
  add_box(mesh, shape, [&](const glm::vec3& c) {
    const float s = stone.s0 + wall.joint + width * (0.5f + 0.5f * c.x);
    glm::vec2 t = cut(wall, stone, s) + glm::vec2(wall.joint, -wall.joint);
    // Where the wall's edge leaves nothing, a sliver remains: hidden by what lies along the edge.
    if (t.y < t.x + 0.02f) t = glm::vec2(0.5f * (t.x + t.y)) + glm::vec2(-0.01f, 0.01f);
    // Flat in the middle, round at the rim, and uneven.
    const auto round = [](float x) { return 1 - x * x * x * x; };
    const float pillow = round(c.x) * round(c.y);
    const float out =
        wall.bulge * pillow * (0.8f + 0.45f * noise({2.2f * c.x, 2.2f * c.y, 0}, seed));
    const float d = c.z > 0 ? out : wall.two_sided ? -wall.depth - out : -wall.depth;
    return BuiltVertex{wall.place({s, glm::mix(t.x, t.y, 0.5f + 0.5f * c.y), d}),
                       color * (0.85f + 0.15f * pillow)};
  });
}

void add_bed(Mesh& mesh, const Wall& wall) {
  GridShape shape;
  shape.nu = std::clamp(int(wall.length / 0.7f), 2, 64);
  shape.nv = 1;
  const float d = -0.5f * wall.depth;
  add_grid(mesh, shape, [&](float u, float v) {
    const float s = u * wall.length;
    glm::vec2 t = cut(wall, {0, wall.length, 0, wall.height}, s);
    if (t.y < t.x + 0.02f) t = glm::vec2(0.5f * (t.x + t.y)) + glm::vec2(-0.01f, 0.01f);
    return BuiltVertex{wall.place({s, glm::mix(t.x, t.y, v), d}), wall.color * 0.7f};
  });
}

}  // namespace

void add_wall(Mesh& mesh, const Wall& wall, double density, std::uint64_t seed,
              TriangleBudget& budget) {
  const double mean = 0.5 * (wall.shortest + wall.longest) * wall.course;
  const double fit = std::sqrt(kMinTriangles / std::max(density * mean, 1e-6));
  Random random(seed);
  const std::vector<Stone> stones = lay(wall, float(std::max(1.0, fit)), random);
  for (const Stone& stone : stones) {
    const double area = double(stone.s1 - stone.s0) * cut_height(wall, stone);
    const double sides = wall.two_sided ? 2 : 1;
    const int n = budget.divide(density * area * sides, kFace * sides, kRim, 1);
    add_stone(mesh, wall, stone, n, random);
  }
  if (!wall.two_sided) add_bed(mesh, wall);
}

}  // namespace rilievo
