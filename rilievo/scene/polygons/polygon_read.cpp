#include "rilievo/scene/polygons/polygon_read.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "rilievo/scene/far_origin.h"
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

// By some of the positions, evenly spread over the file.
glm::dvec3 origin_of(const PolygonSoup& soup) {
  constexpr std::size_t kSamples = 1 << 16;
  std::vector<glm::dvec3> samples;
  const std::size_t step = 1 + soup.positions.size() / kSamples;
  for (std::size_t i = 0; i < soup.positions.size(); i += step)
    if (is_finite(glm::vec3(soup.positions[i]))) samples.push_back(soup.positions[i]);
  return far_origin(std::move(samples));
}

}  // namespace

Scene scene_of(PolygonSoup soup, const std::vector<SoupPart>& parts, Scene scene,
               LoadContext& context) {
  scene.name = context.name;
  soup.origin = scene.world.origin = origin_of(soup);
  if (soup.cut_short)
    context.warn("polygons that cross themselves, or have too many corners, are drawn as fans");
  std::vector<Mesh> strokes;  // first: what makes normals takes positions that are not finite away
  for (const Primitive primitive : {Primitive::lines, Primitive::points})
    for (Mesh& mesh : stroke_meshes(soup, primitive, parts.size(), context.budget))
      strokes.push_back(std::move(mesh));
  add_missing_normals(soup, context.budget);
  std::vector<Mesh> meshes = weld(soup, parts.size(), context.budget);
  std::move(strokes.begin(), strokes.end(), std::back_inserter(meshes));
  int plain = -1;
  std::map<std::string, int> models;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const std::size_t part = k % parts.size();
    if (meshes[k].indices.empty()) continue;
    if (!parts[part].colored) meshes[k].colors.clear();
    if (!meshes[k].normals.empty()) repair_normals(meshes[k]);
    if (repair_attributes(meshes[k]) > 0)
      context.warn("attributes that are not finite are replaced");
    const auto [model, fresh] = models.try_emplace(parts[part].object, int(scene.models.size()));
    if (fresh) {
      context.budget.take(2 * (sizeof(Model) + sizeof(Object)) + 2 * parts[part].object.size());
      Object object;
      object.name = parts[part].object;
      object.model = model->second;
      scene.models.emplace_back().name = parts[part].object;
      scene.objects.push_back(std::move(object));
    }
    context.budget.take(2 * (sizeof(Part) + sizeof(Mesh)));
    scene.models[model->second].parts.push_back({int(scene.meshes.size())});
    meshes[k].name = parts[part].object;
    meshes[k].material = parts[part].material;
    if (parts[part].material < 0 && plain < 0) {
      plain = int(scene.materials.size());
      scene.materials.push_back(plain_material(!soup.colors.empty()));
    }
    if (parts[part].material < 0) meshes[k].material = plain;
    scene.meshes.push_back(std::move(meshes[k]));
  }
  return scene;
}

}  // namespace rilievo
