// The stone bridge of the scene `bridge`: three arches on two pillars, walls, parapets, paving.
//
// It runs along x; the middle of the river is x = 0, the water y = 0. Cut into the objects that
// are listed below, which touch and penetrate each other.

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/bridge.h"
#include "rilievo/scene/builtin/masonry.h"

namespace rilievo {
namespace {

constexpr float kSpring = 0.9f;  // height at which the arches begin
constexpr float kRing = 0.7f;    // height of the arch stones
constexpr float kPillarWidth = 2.4f;
constexpr float kBed = -2.0f;  // below the river's bed

struct Arch {
  float center, radius;
};
constexpr Arch kArches[] = {{-12.3f, 4.4f}, {0, 5.5f}, {12.3f, 4.4f}};
constexpr float kPillar = 6.7f;     // x of the pillars' middle
constexpr float kAbutment = 16.7f;  // x at which the outer arches end

const glm::vec3 kStone{0.36f, 0.335f, 0.285f};

// Lower edge of the walls above the arches: a third of the ring up, hidden behind the ring's
// stones.
float above_arches(float x) {
  for (const Arch& arch : kArches) {
    const float r = arch.radius + 0.45f * kRing, dx = x - arch.center;
    if (std::abs(dx) < r) return kSpring + std::sqrt(r * r - dx * dx);
  }
  return kBed;
}

struct Mason {
  Scene& scene;
  int material;
  double density;  // triangles a square metre where the eye comes close
  Random random;
  TriangleBudget budget;

  void add(Mesh& mesh, const Wall& wall, double weight = 1.0) {
    add_wall(mesh, wall, weight * density, random.next(), budget);
  }
  int model(Mesh mesh) { return add_model(scene, std::move(mesh), material); }
};

// Walls between x0 and x1 on the side `side` = +-1 of z.
Mesh make_spandrel(Mason& mason, float x0, float x1, float side) {
  Mesh mesh;
  mesh.name = "bridge wall";
  Wall wall;
  wall.color = kStone;
  wall.length = x1 - x0, wall.height = deck_height(0) - kBed;
  const auto x_of = [=](float s) { return side > 0 ? x0 + s : x1 - s; };
  wall.lower = [=](float s) {
    const float x = x_of(s);
    return std::max(above_arches(x), std::abs(x) > kAbutment ? kBed + 1.5f : kBed) - kBed;
  };
  wall.upper = [=](float s) { return deck_height(x_of(s)) - 0.05f - kBed; };
  wall.place = [=](const glm::vec3& w) {
    return glm::vec3(x_of(w.x), kBed + w.y, side * (kBridgeHalfWidth + w.z));
  };
  mason.add(mesh, wall);
  return mesh;
}

// Arch stones on both faces, and the vault between them. Around the origin of its springing line.
Mesh make_arch(Mason& mason, float radius) {
  Mesh mesh;
  mesh.name = "arch";
  for (const float side : {-1.0f, 1.0f}) {
    Wall ring;
    ring.color = kStone * 1.12f, ring.tints = 0.09f;
    const float middle = radius + 0.5f * kRing;
    ring.length = kPi * middle, ring.height = kRing, ring.course = kRing;
    ring.shortest = 0.42f, ring.longest = 0.5f;
    ring.place = [=](const glm::vec3& w) {
      const float angle = kPi - w.x / middle, r = radius + w.y;
      return glm::vec3(side * r * std::cos(angle), r * std::sin(angle),
                       side * (kBridgeHalfWidth + 0.06f + w.z));
    };
    mason.add(mesh, ring);
  }
  Wall vault;
  vault.color = kStone * 0.72f;
  vault.length = kPi * radius, vault.height = 2 * kBridgeHalfWidth + 0.1f;
  vault.course = 0.8f, vault.bulge = 0.03f;
  vault.place = [=](const glm::vec3& w) {
    const float angle = kPi - w.x / radius, r = radius - w.z;
    return glm::vec3(r * std::cos(angle), r * std::sin(angle), w.y - 0.5f * vault.height);
  };
  mason.add(mesh, vault, 0.5);
  return mesh;
}

// A pillar with a pointed cutwater up- and downstream, around x = 0.
Mesh make_pillar(Mason& mason) {
  Mesh mesh;
  mesh.name = "pillar";
  const float half = 0.5f * kPillarWidth, front = kBridgeHalfWidth + 0.05f, nose = front + 1.7f;
  constexpr float kTop = 3.4f;
  // Corners in the order in which s x t, along the edge and up, looks outwards.
  const glm::vec2 corners[] = {{half, front},   {half, -front}, {0, -nose},
                               {-half, -front}, {-half, front}, {0, nose}};
  for (int i = 0; i < 6; ++i) {
    const glm::vec2 a = corners[i], b = corners[(i + 1) % 6], along = glm::normalize(b - a);
    const bool cutwater = i != 0 && i != 3;
    Wall wall;
    wall.color = kStone * 0.92f;
    wall.length = glm::distance(a, b);
    wall.height = (cutwater ? kTop : kSpring + 0.15f) - kBed;
    wall.place = [=](const glm::vec3& w) {
      const glm::vec2 p = a + along * w.x + glm::vec2(-along.y, along.x) * w.z;
      return glm::vec3(p.x, kBed + w.y, p.y);
    };
    mason.add(mesh, wall);
    if (!cutwater) continue;
    // The cap: a triangle from this edge up to the wall of the bridge.
    const glm::vec3 tip{0, kTop + 1.3f, i < 3 ? -front : front};
    GridShape shape;
    shape.nu = shape.nv = 6, shape.pole_at_end = true;
    add_grid(mesh, shape, [&](float u, float v) {
      const glm::vec2 p = glm::mix(a, b, u);
      return BuiltVertex{glm::mix(glm::vec3(p.x, kTop, p.y), tip, v), kStone * 0.85f};
    });
  }
  return mesh;
}

Mesh make_parapet(Mason& mason, float x0, float x1, float side) {
  Mesh mesh;
  mesh.name = "parapet";
  Wall wall;
  wall.color = kStone * 1.05f;
  wall.two_sided = true, wall.depth = 0.28f;
  wall.length = x1 - x0, wall.height = 0.7f, wall.course = 0.35f;
  wall.shortest = 0.5f, wall.longest = 0.85f;
  const auto x_of = [=](float s) { return side > 0 ? x0 + s : x1 - s; };
  wall.place = [=](const glm::vec3& w) {
    const float x = x_of(w.x);
    return glm::vec3(x, deck_height(x) - 0.1f + w.y, side * (kBridgeHalfWidth - 0.03f + w.z));
  };
  mason.add(mesh, wall);
  // The coping lies flat on top and reaches over both faces.
  Wall coping;
  coping.color = kStone * 1.2f, coping.tints = 0.07f;
  coping.length = wall.length, coping.height = 0.5f, coping.course = 0.5f;
  coping.shortest = 0.9f, coping.longest = 1.3f, coping.depth = 0.16f;
  coping.place = [=](const glm::vec3& w) {
    const float x = x_of(w.x);
    return glm::vec3(x, deck_height(x) + 0.73f + w.z, side * (kBridgeHalfWidth + 0.08f - w.y));
  };
  mason.add(mesh, coping);
  return mesh;
}

Mesh make_paving(Mason& mason, float x0, float x1) {
  Mesh mesh;
  mesh.name = "paving";
  Wall paving;
  paving.color = glm::vec3(0.235f, 0.225f, 0.21f);
  paving.length = x1 - x0, paving.height = 2 * kBridgeHalfWidth - 0.5f;
  paving.course = 0.4f, paving.shortest = 0.5f, paving.longest = 0.7f, paving.bulge = 0.03f;
  paving.place = [=](const glm::vec3& w) {
    const float x = x0 + w.x;
    return glm::vec3(x, deck_height(x) - 0.02f + w.z, 0.5f * paving.height - w.y);
  };
  mason.add(mesh, paving, 0.7);
  return mesh;
}

// What stands in the river below an outer arch and holds up the end of the bridge.
Mesh make_abutment(Mason& mason, float side) {
  Mesh mesh;
  mesh.name = "abutment";
  Wall wall;
  wall.color = kStone * 0.92f;
  wall.length = 2 * kBridgeHalfWidth, wall.height = kSpring + 0.2f - kBed;
  wall.place = [=](const glm::vec3& w) {
    return glm::vec3(side * (kAbutment - w.z), kBed + w.y, side * (w.x - kBridgeHalfWidth));
  };
  mason.add(mesh, wall);
  return mesh;
}

}  // namespace

float deck_height(float x) {
  // 7.5 above the middle, 5.7 at the ends, then slowly down to the road's 4.2.
  const float hump = 1.9f * std::exp(-x * x / 200.0f);
  return 4.2f + 1.4f * (1 - glm::smoothstep(24.0f, 70.0f, std::abs(x))) + hump;
}

void add_stone_bridge(Scene& scene, int material, double triangles, std::uint64_t seed) {
  // Square metres of stones, each with its weight: walls 330, rings 66, vaults 0.5 * 330, pillars
  // 150, parapets 2 * 70 + 50, paving 0.7 * 320, abutments 45; and the rims of the cut ones.
  Mason mason{scene, material, triangles / 1250.0, Random(seed), {}};
  const auto put = [&](const char* name, int model, float x, float y) {
    add_object(scene, name, model, glm::translate(glm::mat4(1), {x, y, 0}));
  };

  const int side_arch = mason.model(make_arch(mason, kArches[0].radius));
  const int middle_arch = mason.model(make_arch(mason, kArches[1].radius));
  put("arch", side_arch, kArches[0].center, kSpring);
  put("arch", middle_arch, kArches[1].center, kSpring);
  put("arch", side_arch, kArches[2].center, kSpring);
  const int pillar = mason.model(make_pillar(mason));
  for (const float side : {-1.0f, 1.0f}) put("pillar", pillar, side * kPillar, 0);

  constexpr float kWallEnds[] = {-kBridgeHalfLength, -kPillar, kPillar, kBridgeHalfLength};
  constexpr float kParapetEnds[] = {-kBridgeHalfLength, -12.5f, 0, 12.5f, kBridgeHalfLength};
  for (const float side : {-1.0f, 1.0f}) {
    for (int i = 0; i < 3; ++i)
      put("bridge wall", mason.model(make_spandrel(mason, kWallEnds[i], kWallEnds[i + 1], side)), 0,
          0);
    for (int i = 0; i < 4; ++i)
      put("parapet", mason.model(make_parapet(mason, kParapetEnds[i], kParapetEnds[i + 1], side)),
          0, 0);
    put("abutment", mason.model(make_abutment(mason, side)), 0, 0);
  }
  for (int i = 0; i < 4; ++i)
    put("paving", mason.model(make_paving(mason, kParapetEnds[i], kParapetEnds[i + 1])), 0, 0);
}

}  // namespace rilievo
