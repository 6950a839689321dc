#include "bench/objects.h"

#include <algorithm>
#include <utility>

#include "rilievo/scene/builtin/bridge.h"
#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo::bench {
namespace {

int add_material(Scene& scene, const char* name, float roughness, bool double_sided) {
  Material material;
  material.name = name;
  material.roughness = roughness;
  material.double_sided = double_sided;
  scene.materials.push_back(std::move(material));
  return int(scene.materials.size()) - 1;
}

Scene of_mesh(const char* name, Mesh mesh, float roughness, bool double_sided) {
  Scene scene;
  scene.name = name;
  const int material = add_material(scene, name, roughness, double_sided);
  add_object(scene, name, add_model(scene, std::move(mesh), material), glm::mat4(1));
  finish(scene);
  return scene;
}

Scene stone_bridge(int triangles) {
  Scene scene;
  scene.name = "bridge";
  // Stones of fewer triangles would be too large to be stones.
  const double enough = std::max(triangles, 60000);
  add_stone_bridge(scene, add_material(scene, "stone", 0.9f, true), enough, 1);
  finish(scene);
  return scene;
}

}  // namespace

std::vector<BenchObject> bench_objects(int triangles) {
  constexpr std::uint64_t kSeed = 1;
  std::vector<BenchObject> objects;
  objects.push_back({"teapot", "round, a handle and a spout that stand off it",
                     make_single_teapot(std::uint64_t(triangles)).scene});
  objects.push_back({"car", "smooth, wheels in dark arches",
                     of_mesh("car", make_vehicle(VehicleKind::car, {0.5f, 0.05f, 0.04f}, triangles),
                             0.35f, false)});
  objects.push_back({"oak", "thousands of leaves around branches",
                     of_mesh("oak", make_tree(TreeKind::oak, kSeed, triangles), 0.9f, true)});
  // From below one sees into what stands on the ground.
  objects.push_back({"house", "walls of stones with windows set in, hollow from below",
                     of_mesh("house", make_house(kSeed, triangles), 0.9f, true)});
  objects.push_back(
      {"lamp", "4 m high and thin", of_mesh("lamp", make_lamp_post(triangles), 0.6f, false)});
  objects.push_back({"bridge", "50 m long, vaults to see through", stone_bridge(triangles)});
  return objects;
}

}  // namespace rilievo::bench
