// How do the materials of an OBJ file (.mtl) become metallic-roughness? Internal to loading.
//
//   Kd  base colour, unless there is a picture of it (map_Kd): exporters write both as alternatives
//   d   opacity, before Tr, its opposite; map_d a picture of it; a picture's own alpha counts, too
//   Ke  emission        Ns  exponent of the highlight -> roughness        Pr, Pm  as they are
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rilievo/io/load_context.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// How a picture's own alpha is drawn: a cut-out, blended, or not at all.
[[nodiscard]] AlphaMode alpha_mode_of(const Rgba8Image& image);

// The materials of one OBJ file, read on demand.
class ObjMaterials {
 public:
  explicit ObjMaterials(LoadContext& context) : context_(context) {}

  // Reads the libraries of an mtllib statement, each library once. A library that cannot be read is
  // a warning, a number that is none throws.
  void read(const std::string& names);

  // The index of the named material, loaded with its pictures; -1 if there is none. `colored`: the
  // mesh has vertex colours.
  [[nodiscard]] int use(const std::string& name, bool colored);

  // A scene of the materials in use, with their textures and images.
  [[nodiscard]] Scene take();

 private:
  struct Map {
    std::string file;    // as the library names it
    std::string folder;  // of the library, as mtllib names it; empty: the scene's
    glm::dvec3 scale{1.0}, offset{0.0};
    bool clamp = false;
  };
  struct Definition {
    Material material;
    std::optional<double> opacity, transparency;  // d and Tr
    std::map<std::string, Map> maps;              // by statement: "map_kd"
  };

  // Why the library cannot be read, or nothing.
  [[nodiscard]] std::string read_library(const std::string& name);
  void parse(std::string_view text, const std::string& library);
  void parse_line(std::string_view line, const std::string& library, Definition*& now);
  [[nodiscard]] Map parse_map(std::string_view rest);
  [[nodiscard]] std::string path_of(const Map& map) const;
  [[nodiscard]] int image(const Map& map);
  [[nodiscard]] int image_with_opacity(int image, int opacity);
  [[nodiscard]] AlphaMode alpha_mode(int image);
  [[nodiscard]] TextureUse texture_use(const Map& map, const Map& opacity);
  void finish(Definition& definition, bool colored);

  LoadContext& context_;
  std::map<std::string, Definition> definitions_;
  std::map<std::string, int> used_;
  std::set<std::string> statements_;  // of mtllib, read before
  std::set<std::filesystem::path> libraries_;
  std::map<std::filesystem::path, int> files_;       // -> images_, or -1
  std::map<std::pair<int, int>, int> with_opacity_;  // image, opacity -> images_
  std::map<int, AlphaMode> alpha_modes_;             // of images_
  std::map<std::pair<int, bool>, int> sampled_;      // image, clamped -> textures_
  std::vector<Material> materials_;
  std::vector<Texture> textures_;
  std::vector<Rgba8Image> images_;
};

}  // namespace rilievo
