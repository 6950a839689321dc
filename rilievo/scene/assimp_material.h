// Materials as OBJ, PLY and STL know them, turned into metallic-roughness. Internal to loading.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "rilievo/scene/load_context.h"
#include "rilievo/scene/scene.h"

struct aiScene;
struct aiMaterial;

namespace rilievo {

// Reads a material, and the pictures it needs, when a mesh first uses it.
class AssimpMaterials {
 public:
  AssimpMaterials(const aiScene& from, LoadContext& context, Scene& scene)
      : from_(from), context_(context), scene_(scene) {}

  // Index into Scene::materials. `colored`: the mesh has colours, which the material's own must not
  // dim.
  [[nodiscard]] int use(unsigned i, bool colored);

 private:
  [[nodiscard]] Material read(const aiMaterial& from, bool colored);
  void read_opacity(const aiMaterial& from, Material& material);
  // Index into Scene::textures of the picture at `path`, or -1. `opacity`: another picture (or "")
  // whose brightness becomes its alpha.
  [[nodiscard]] int texture(const std::string& path, const std::string& opacity);

  const aiScene& from_;
  LoadContext& context_;
  Scene& scene_;
  std::map<std::pair<unsigned, bool>, int> materials_;
  std::map<std::pair<std::string, std::string>, int> textures_;
};

}  // namespace rilievo
