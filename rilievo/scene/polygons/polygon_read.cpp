#include "rilievo/scene/polygons/polygon_read.h"

#include <map>

#include "rilievo/scene/mesh_tools.h"

namespace rilievo {

namespace {

// What is drawn without a material. None of these formats says which side of a surface shows.
Material plain_material(bool colored) {
  Material material;
  material.name = "plain";
  material.base_color = colored ? glm::vec4(1.0f) : glm::vec4(0.7f, 0.7f, 0.7f, 1.0f);
  material.double_sided = true;
  return material;
}

}  // namespace

Scene scene_of(PolygonSoup soup, const std::vector<SoupPart>& parts, Scene scene,
               LoadContext& context) {
  scene.name = context.name;
  if (soup.cut_short)
    context.warn("polygons that cross themselves, or have too many corners, are drawn as fans");
  add_missing_normals(soup, context.budget);
  std::vector<Mesh> meshes = weld(soup, parts.size(), context.budget);
  int plain = -1;
  std::map<std::string, int> models;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (meshes[i].indices.empty()) continue;
    if (!parts[i].colored) meshes[i].colors.clear();
    repair_normals(meshes[i]);
    if (repair_attributes(meshes[i]) > 0)
      context.warn("attributes that are not finite are replaced");
    const auto [model, fresh] = models.try_emplace(parts[i].object, int(scene.models.size()));
    if (fresh) {
      context.budget.take(2 * (sizeof(Model) + sizeof(Object)) + 2 * parts[i].object.size());
      Object object;
      object.name = parts[i].object;
      object.model = model->second;
      scene.models.emplace_back().name = parts[i].object;
      scene.objects.push_back(std::move(object));
    }
    context.budget.take(2 * (sizeof(Part) + sizeof(Mesh)));
    scene.models[model->second].parts.push_back({int(scene.meshes.size())});
    meshes[i].name = parts[i].object;
    meshes[i].material = parts[i].material;
    if (parts[i].material < 0 && plain < 0) {
      plain = int(scene.materials.size());
      scene.materials.push_back(plain_material(!soup.colors.empty()));
    }
    if (parts[i].material < 0) meshes[i].material = plain;
    scene.meshes.push_back(std::move(meshes[i]));
  }
  return scene;
}

}  // namespace rilievo
