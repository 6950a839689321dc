// The materials of an OBJ file (.mtl), turned into metallic-roughness. Internal to loading.
//
//   Kd  base colour, unless there is a picture of it (map_Kd): exporters write both as alternatives
//   d   opacity, Tr its opposite; map_d a picture of it; a picture's own alpha counts, too
//   Ke  emission        Ns  exponent of the highlight -> roughness        Pr, Pm  as they are
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "rilievo/io/load_context.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

class ObjMaterials {
 public:
  explicit ObjMaterials(LoadContext& context) : context_(context) {}

  // Adds the definitions of the libraries named in a mtllib statement; one that cannot be read is a
  // warning.
  void read(const std::string& names);

  // The material of that name, read with its pictures; -1 if there is none. `colored`: the mesh has
  // colours of its own.
  [[nodiscard]] int use(const std::string& name, bool colored);

  [[nodiscard]] std::vector<Material> take_materials() { return std::move(materials_); }
  [[nodiscard]] std::vector<Texture> take_textures() { return std::move(textures_); }

 private:
  struct Map {
    std::string file;
    glm::dvec3 scale{1.0}, offset{0.0};
    bool clamp = false;
  };
  struct Definition {
    Material material;
    double opacity = 1.0;
    std::map<std::string, Map> maps;  // by statement: "map_kd"
  };

  void parse(std::string_view text);
  [[nodiscard]] Map parse_map(std::string_view rest);
  [[nodiscard]] TextureUse texture_use(const Map& map, const std::string& opacity);
  void finish(Definition& definition, bool colored);

  LoadContext& context_;
  std::map<std::string, Definition> definitions_;
  std::map<std::string, int> used_;
  std::map<std::tuple<std::string, std::string, bool>, int> pictures_;
  std::vector<Material> materials_;
  std::vector<Texture> textures_;
};

}  // namespace rilievo
