// Traffic on a stone bridge over a river, between banks with trees and houses. Cf. figure 12 of
// [Schaufler 1997].
//
// Made so that pictures without depth must fail: a bridge in about thirty heavy pieces that touch
// and penetrate each other, lanes so close that vehicles pass within each other's depth range, a
// truck that scrapes the parapet, crowns of trees that grow into one another.

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/bridge.h"
#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/builtin/parts.h"
#include "rilievo/scene/builtin/traffic.h"

namespace rilievo {
namespace {

constexpr double kBridgeSeconds = 16.0;
constexpr float kRoadHalfLength = 100.0f;

// x of the river's middle: straight at the bridge, bent away behind it.
float river(float z) { return -30.0f * glm::smoothstep(-45.0f, -150.0f, z); }

struct Land {
  std::uint64_t seed;

  float height(float x, float z) const {
    const float bank = std::abs(x - river(z));
    const float dry = glm::smoothstep(9.0f, 24.0f, bank);
    // The low rise on the left bank that the walk leads along.
    const float rise = std::exp(-(x + 34) * (x + 34) / 150.0f) * glm::smoothstep(0.0f, 24.0f, z);
    const float far = glm::smoothstep(60.0f, 170.0f, std::hypot(x, z));
    const float rolling = noise({x / 19.0f, 0, z / 19.0f}, seed);
    const float natural =
        -1.6f + dry * (4.2f + 0.35f * rolling + 6.0f * rise + far * (13.0f + 6.0f * rolling));
    // The embankment of the road, up to its edge and sloping down beside it.
    const float road =
        glm::smoothstep(10.5f, 4.0f, std::abs(z)) * glm::smoothstep(17.5f, 22.0f, std::abs(x));
    return glm::mix(natural, deck_height(x) - 0.15f, road);
  }
  glm::vec3 color(const glm::vec3& p) const {
    const float patch = 0.5f + 0.5f * noise({p.x / 11.0f, 3, p.z / 11.0f}, seed);
    const glm::vec3 grass =
        glm::mix(glm::vec3(0.11f, 0.155f, 0.05f), glm::vec3(0.165f, 0.175f, 0.075f), patch);
    return glm::mix(glm::vec3(0.22f, 0.185f, 0.13f), grass, glm::smoothstep(0.3f, 1.6f, p.y));
  }
};

glm::mat4 at(const glm::vec3& position, float yaw, const glm::vec3& scale) {
  return glm::scale(glm::rotate(glm::translate(glm::mat4(1), position), yaw, {0, 1, 0}), scale);
}

int add_material(Scene& scene, const char* name, float roughness, const glm::vec3& color) {
  Material material;
  material.name = name, material.roughness = roughness;
  material.base_color = glm::vec4(color, 1);
  scene.materials.push_back(material);
  return int(scene.materials.size()) - 1;
}

void add_ground(Scene& scene, const Land& land) {
  const int earth = add_material(scene, "earth", 0.95f, glm::vec3(1));
  const int water = add_material(scene, "water", 0.25f, {0.035f, 0.075f, 0.085f});
  const int asphalt = add_material(scene, "asphalt", 0.9f, {0.12f, 0.12f, 0.125f});
  const Ground ground{[&](float x, float z) { return land.height(x, z); },
                      [&](const glm::vec3& p) { return land.color(p); }};
  constexpr float kTile = 32.0f;
  for (float z = -160; z < 64; z += kTile)
    for (float x = -96; x < 160; x += kTile) {
      // Not what lies left of every view along the walk.
      if (x < -64 && z >= -32) continue;
      const int model = add_model(scene, make_ground(ground, {x, z}, kTile, 8), earth);
      add_object(scene, "ground", model,
                 glm::translate(glm::mat4(1), {x + 0.5f * kTile, 0, z + 0.5f * kTile}));
    }

  Mesh surface;
  surface.name = "water";
  add_grid(surface, {}, [](float u, float v) {
    return BuiltVertex{{glm::mix(-75.0f, 30.0f, v), 0, glm::mix(-150.0f, 60.0f, u)}};
  });
  add_object(scene, "water", add_model(scene, std::move(surface), water), glm::mat4(1));

  Mesh road;
  road.name = "road";
  GridShape shape;
  shape.nu = 1, shape.nv = 24;
  add_grid(road, shape, [](float u, float v) {
    const float x = kBridgeHalfLength + (kRoadHalfLength + 4 - kBridgeHalfLength) * v;
    return BuiltVertex{{x, deck_height(x), 6.6f * (u - 0.5f)}};
  });
  const int road_model = add_model(scene, std::move(road), asphalt);
  add_object(scene, "road", road_model, glm::mat4(1));
  add_object(scene, "road", road_model, glm::rotate(glm::mat4(1), 3.14159265f, {0, 1, 0}));
}

// Where trees stand, as rectangles over x, z.
struct Grove {
  float x0, x1, z0, z1;
  int trees;
  bool bushes;
};
constexpr Grove kGroves[] = {
    {-34, -20, -58, -12, 9, false},    // behind the left end of the bridge
    {25, 62, 10, 30, 7, false},        // before the road on the right
    {24, 66, -52, -10, 12, false},     // behind it
    {92, 108, -8, 8, 4, false},        // over the end of the road
    {-55, 120, -125, -62, 26, false},  // on the hills
    {21, 30, -30, 30, 6, true},        // along the water
    {-30, -20, -34, -9, 3, true},     {-26, -20.6f, 9.5f, 15, 2, true},
};

void add_trees(Scene& scene, const Land& land, double triangles, Random& random) {
  const int leaves = add_material(scene, "tree", 0.9f, glm::vec3(1));
  struct Spot {
    glm::vec2 place;
    int kind;
  };
  std::vector<Spot> spots;
  for (const Grove& grove : kGroves)
    for (int planted = 0, tried = 0; planted < grove.trees && tried < 10000; ++tried) {
      const glm::vec2 p{random.between(grove.x0, grove.x1), random.between(grove.z0, grove.z1)};
      const bool end_of_road = grove.x0 > 90;
      const bool in_river = std::abs(p.x - river(p.y)) < 20.5f;
      const bool on_road = std::abs(p.y) < 9.0f && !end_of_road;
      // Nearer than two crowns' radii, farther than two trunks': crowns grow into one another.
      const bool taken = std::any_of(spots.begin(), spots.end(), [&](const Spot& s) {
        return glm::distance(s.place, p) < (grove.bushes ? 2.5f : 4.5f);
      });
      if (in_river || on_road || taken) continue;
      const int kind = grove.bushes ? int(TreeKind::bush) : random.below(kTreeKinds - 1);
      spots.push_back({p, kind});
      ++planted;
    }

  // Every kind has its share of the triangles of a tree; kinds are built once.
  constexpr double kShare[kTreeKinds] = {1.4, 0.9, 0.9, 1.0, 0.5};
  double shares = 0;
  for (const Spot& spot : spots) shares += kShare[spot.kind];
  int models[kTreeKinds];
  for (int kind = 0; kind < kTreeKinds; ++kind)
    models[kind] = add_model(
        scene, make_tree(TreeKind(kind), random.next(), int(triangles * kShare[kind] / shares)),
        leaves);
  for (const Spot& spot : spots) {
    const glm::vec3 foot{spot.place.x, land.height(spot.place.x, spot.place.y), spot.place.y};
    // One after the other, for the same order with every compiler.
    const float scale = random.between(0.8f, 1.15f);
    const float angle = random.between(0, 6.28f);
    add_object(scene, "tree", models[spot.kind], at(foot, angle, glm::vec3(scale)));
  }
}

void add_buildings(Scene& scene, const Land& land, double triangles, Random& random) {
  const int stone = add_material(scene, "masonry", 0.9f, glm::vec3(1));
  const auto put = [&](const char* name, int model, float x, float z, float yaw) {
    add_object(scene, name, model, at({x, land.height(x, z) - 0.2f, z}, yaw, glm::vec3(1)));
  };
  const int house = add_model(scene, make_house(random.next(), int(triangles / 4)), stone);
  put("house", house, 35, 16, 0.35f);
  put("house", house, 44, -16, -0.2f);
  put("house", house, 66, 14, 1.3f);
  put("tower", add_model(scene, make_tower(random.next(), int(triangles / 4)), stone), -24, -20, 0);
}

void add_rocks(Scene& scene, const Land& land, double triangles, Random& random) {
  const int stone = add_material(scene, "rock", 0.9f, glm::vec3(1));
  constexpr int kRocks = 24;
  int models[3];
  for (int& model : models)
    model = add_model(scene, make_rock(random.next(), int(triangles / kRocks)), stone);
  for (int i = 0; i < kRocks; ++i) {
    const float z = random.between(-34, 34), side = i % 3 ? 1.0f : -1.0f;
    const float x = river(z) + side * random.between(15.5f, 19.5f);
    const float size = random.between(0.7f, 2.6f);
    const float height = size * random.between(0.7f, 1.1f);
    const float angle = random.between(0, 6.28f);
    add_object(scene, "rock", models[i % 3],
               at({x, land.height(x, z) + 0.1f * size, z}, angle, glm::vec3(size, height, size)));
  }
}

void add_lamp_posts(Scene& scene, double triangles) {
  const int iron = add_material(scene, "lamp post", 0.6f, glm::vec3(1));
  const int model = add_model(scene, make_lamp_post(int(triangles / 8)), iron);
  for (int i = 0; i < 8; ++i) {
    const float x = -19.5f + 13.0f * float(i / 2), z = i % 2 ? 3.25f : -3.25f;
    add_object(scene, "lamp post", model,
               glm::translate(glm::mat4(1), {x, deck_height(x) - 0.05f, z}));
  }
}

void add_traffic(Scene& scene, double triangles, Random& random) {
  const int paint = add_material(scene, "paint", 0.35f, glm::vec3(1));
  const Road road{kRoadHalfLength, 20.0f, deck_height};
  struct Entry {
    const char* name;
    VehicleKind kind;
    glm::vec3 color;
    float lane, phase;
  };
  // Towards +x on the side of the eye; the phases let several be on the bridge at any time, and
  // the truck meet the bus there.
  const Entry entries[] = {
      {"car", VehicleKind::car, {0.45f, 0.05f, 0.04f}, 1.05f, 0.40f},
      {"truck", VehicleKind::truck, {0.10f, 0.22f, 0.42f}, 2.05f, 0.47f},
      {"car", VehicleKind::car, {0.55f, 0.54f, 0.50f}, 1.1f, 0.56f},
      {"car", VehicleKind::car, {0.08f, 0.20f, 0.12f}, 1.0f, 0.72f},
      {"car", VehicleKind::car, {0.48f, 0.33f, 0.05f}, 1.1f, 0.05f},
      {"car", VehicleKind::car, {0.10f, 0.11f, 0.13f}, 1.2f, 0.22f},
      {"bus", VehicleKind::bus, {0.50f, 0.36f, 0.10f}, -1.6f, 0.46f},
      {"car", VehicleKind::car, {0.30f, 0.32f, 0.36f}, -1.05f, 0.54f},
      {"car", VehicleKind::car, {0.05f, 0.12f, 0.35f}, -1.0f, 0.37f},
      {"truck", VehicleKind::truck, {0.40f, 0.10f, 0.06f}, -2.0f, 0.63f},
      {"car", VehicleKind::car, {0.42f, 0.40f, 0.36f}, -1.1f, 0.87f},
      {"car", VehicleKind::car, {0.35f, 0.03f, 0.08f}, -1.2f, 0.15f},
  };
  for (const Entry& entry : entries) {
    Vehicle vehicle;
    vehicle.name = entry.name;
    vehicle.model = add_model(
        scene, make_vehicle(entry.kind, entry.color, int(triangles / std::size(entries))), paint);
    vehicle.half_length = entry.kind == VehicleKind::car ? 1.3f : 2.8f;
    vehicle.lane = entry.lane, vehicle.phase = entry.phase;
    vehicle.sway = random.between(0.04f, 0.1f);
    add_vehicle(scene, road, vehicle);
  }
}

// On foot along the rise on the left bank towards the bridge, eyes at 1.7 m.
CameraPath walk(const Land& land) {
  CameraPath path;
  const glm::dvec2 start{-33, 37}, way = glm::normalize(glm::dvec2(1, -5));
  for (double time = 0; time <= kBridgeSeconds; time += 2) {
    const glm::dvec2 p = start + kWalkingSpeed * time * way;
    const glm::dvec3 eye{p.x, land.height(float(p.x), float(p.y)) + 1.7, p.y};
    path.keys.push_back(look_key(time, eye, {4, 5.2, -2}, {0, 1, 0}, kBuiltinFov));
  }
  path.z_near = 0.4, path.z_far = 400;
  return path;
}

}  // namespace

BuiltinScene make_bridge(std::uint64_t triangles, std::uint64_t seed) {
  BuiltinScene built;
  Scene& scene = built.scene;
  scene.name = "bridge";
  Random random(seed);
  const Land land{random.next()};
  add_ground(scene, land);
  finish(scene);
  // What the ground leaves is shared out; the bridge itself takes the rest.
  const double heavy = double(triangles) - double(count_triangles(scene));
  add_trees(scene, land, 0.38 * heavy, random);
  add_buildings(scene, land, 0.08 * heavy, random);
  add_rocks(scene, land, 0.03 * heavy, random);
  add_lamp_posts(scene, 0.02 * heavy);
  add_traffic(scene, 0.07 * heavy, random);
  finish(scene);
  const int stone = add_material(scene, "stone", 0.9f, glm::vec3(1));
  add_stone_bridge(scene, stone, double(triangles) - double(count_triangles(scene)), random.next());
  finish(scene);
  built.path = walk(land);
  return built;
}

}  // namespace rilievo
