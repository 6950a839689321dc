// A forest that grows away from the eye.
//
// The eye walks along a ridge (z = 0, towards +x) and looks over a valley (towards -z) whose far
// side rises, so that distant trees show above near ones. Trees stand in the cells of a square
// grid; what stands in a cell follows from the cell's number and the seed alone, and cells are
// taken in the order of their distance: a larger forest contains the smaller one. Ten times the
// triangles are three times the trees, of three times the triangles each, so that a small forest
// fills the same view with coarser trees.

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo {
namespace {

constexpr float kCell = 7.5f;            // metres; one tree each
constexpr float kTile = 96.0f;           // metres; one ground object each
constexpr int kTileCells = 8;            // 128 triangles
constexpr float kMinGround = 300;        // metres of ground ahead, however few trees there are
constexpr float kBeyondTrees = 100;      // metres of ground beyond the last tree
constexpr double kForestSeconds = 30.0;  // length of the walk

float height(float x, float z, std::uint64_t seed) {
  const float ahead = -z;
  // A ridge, a steep side, a valley, and a slope of 8 % on its far side.
  const float fall = -18.0f * glm::smoothstep(-4.0f, 26.0f, ahead);
  const float rise = 0.08f * std::max(0.0f, ahead - 90.0f);
  const float rolling =
      glm::smoothstep(15.0f, 80.0f, ahead) * 3.0f + glm::smoothstep(100.0f, 500.0f, ahead) * 8.0f;
  return fall + rise + rolling * noise({x / 70.0f, 0.5f, z / 70.0f}, seed);
}

// Does the walk see (x, z), or come close to seeing it? A wedge of 2 x 40.5 degrees whose apex lies
// behind the walk by as much as the wedge needs to hold the view from both of its ends.
bool in_view(float x, float z, float margin) {
  const float half_length = float(0.5 * kForestSeconds * kWalkingSpeed);
  constexpr float slope = 0.854f;
  return std::abs(x) < half_length + slope * -z + 1.32f * margin;  // 1 / cos(40.5 degrees)
}

struct Tree {
  float distance;  // from the middle of the walk
  float x, z;
  std::uint64_t key;
};

// All trees in view up to `radius`, nearest first.
std::vector<Tree> trees_within(float radius, std::uint64_t seed) {
  std::vector<Tree> trees;
  const int reach = int(radius / kCell) + 1;
  for (int j = -reach; j <= 0; ++j)
    for (int i = -reach; i <= reach; ++i) {
      const std::uint64_t key = combine(seed, i, j);
      Random random(key);
      const float x = (float(i) + random.between(0.15f, 0.85f)) * kCell;
      const float z = (float(j) + random.between(0.15f, 0.85f)) * kCell;
      const float distance = std::hypot(x, z);
      // The ridge and its steep side stay free: the nearest tree is 24 m from the walk.
      if (distance > radius || z > -24.0f || !in_view(x, z, 0.0f)) continue;
      trees.push_back({distance, x, z, random.next()});
    }
  std::sort(trees.begin(), trees.end(), [](const Tree& a, const Tree& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.key < b.key;
  });
  return trees;
}

struct Tile {
  float distance;  // of its nearest point
  glm::vec2 corner;
};

std::vector<Tile> tiles_within(float radius) {
  std::vector<Tile> tiles;
  const int reach = int(radius / kTile) + 1;
  for (int j = -reach; j <= 0; ++j)
    for (int i = -reach; i < reach; ++i) {
      // The last row ends 8 m behind the walk.
      const glm::vec2 corner{float(i) * kTile, float(j) * kTile + 8 - kTile};
      const glm::vec2 nearest = glm::clamp(glm::vec2(0), corner, corner + kTile);
      const float distance = glm::length(nearest);
      const glm::vec2 center = corner + 0.5f * kTile;
      if (distance > radius || !in_view(center.x, center.y, 0.71f * kTile)) continue;
      tiles.push_back({distance, corner});
    }
  std::stable_sort(tiles.begin(), tiles.end(),
                   [](const Tile& a, const Tile& b) { return a.distance < b.distance; });
  return tiles;
}

// Kind and size of a tree, out of its key.
struct Specimen {
  int kind;
  float scale, yaw;
};
Specimen specimen_of(std::uint64_t key) {
  Random random(key);
  const float pick = random.unit();
  const int kind = pick < 0.26f ? 0 : pick < 0.36f ? 1 : pick < 0.68f ? 2 : pick < 0.9f ? 3 : 4;
  return {kind, random.between(0.75f, 1.15f), random.between(0.0f, 6.2831853f)};
}

}  // namespace

BuiltinScene make_forest(std::uint64_t triangles, std::uint64_t seed) {
  BuiltinScene built;
  Scene& scene = built.scene;
  scene.name = "forest";
  Material leaves, earth;
  leaves.name = "tree", leaves.roughness = 0.9f;
  earth.name = "earth", earth.roughness = 0.95f;
  scene.materials = {leaves, earth};

  constexpr int kTreeTriangles[kTreeKinds] = {3600, 2000, 2400, 2800, 1500};  // of ten million
  const double detail = std::sqrt(double(triangles) / 1e7);
  std::uint64_t counts[kTreeKinds];
  for (int kind = 0; kind < kTreeKinds; ++kind) {
    add_model(scene, make_tree(TreeKind(kind), seed, int(detail * kTreeTriangles[kind])), 0);
    counts[kind] = scene.meshes.back().triangles();
  }

  // Trees, and the ground they need, in order of distance until the count is reached.
  std::vector<Tree> trees;
  std::vector<Tile> tiles;
  std::size_t tree_count = 0, tile_count = 0;
  std::uint64_t total = 0;
  constexpr std::uint64_t kTileTriangles = 2 * kTileCells * kTileCells;
  for (float radius = 200.0f; total < triangles; radius *= 1.5f) {
    trees = trees_within(radius, seed);
    tiles = tiles_within(std::max(radius, kMinGround) + kBeyondTrees);
    tree_count = tile_count = 0, total = 0;
    for (; tree_count < trees.size() && total < triangles; ++tree_count) {
      const float ground = std::max(trees[tree_count].distance, kMinGround) + kBeyondTrees;
      for (; tile_count < tiles.size() && tiles[tile_count].distance <= ground; ++tile_count)
        total += kTileTriangles;
      total += counts[specimen_of(trees[tree_count].key).kind];
    }
  }
  trees.resize(tree_count), tiles.resize(tile_count);

  const Ground ground{[&](float x, float z) { return height(x, z, seed); },
                      [&](const glm::vec3& p) {
                        const float patch = noise(p / 23.0f, seed + 1);
                        return glm::mix(glm::vec3(0.085f, 0.11f, 0.04f),
                                        glm::vec3(0.14f, 0.14f, 0.07f), 0.5f + 0.5f * patch);
                      }};
  float farthest = 0;
  for (const Tile& tile : tiles) {
    const int model = add_model(scene, make_ground(ground, tile.corner, kTile, kTileCells), 1);
    const glm::vec2 center = tile.corner + 0.5f * kTile;
    add_object(scene, "ground", model,
               glm::translate(glm::mat4(1), glm::vec3(center.x, 0, center.y)));
    farthest = std::max(farthest, glm::length(center) + kTile);
  }
  for (const Tree& tree : trees) {
    const Specimen specimen = specimen_of(tree.key);
    glm::mat4 world_from_model =
        glm::translate(glm::mat4(1), {tree.x, height(tree.x, tree.z, seed), tree.z});
    world_from_model = glm::rotate(world_from_model, specimen.yaw, {0, 1, 0});
    world_from_model = glm::scale(world_from_model, glm::vec3(specimen.scale));
    add_object(scene, "tree", specimen.kind, world_from_model);
  }
  finish(scene);

  // On foot along the ridge, eyes at 1.7 m, looking over the valley and a little down.
  const double half = 0.5 * kForestSeconds * kWalkingSpeed;
  for (const double end : {-1.0, 1.0}) {
    const glm::dvec3 eye{end * half, 1.7, 0};
    built.path.keys.push_back(look_key((0.5 + 0.5 * end) * kForestSeconds, eye,
                                       eye + glm::dvec3(0, -0.1, -1), {0, 1, 0}, kBuiltinFov));
  }
  built.path.z_near = 0.5;
  built.path.z_far = 1.1 * farthest + 50;
  return built;
}

}  // namespace rilievo
