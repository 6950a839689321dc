#include "rilievo/scene/polygons/ply_textures.h"

#include "rilievo/io/picture_decode.h"
#include "rilievo/io/text_scan.h"
#include "rilievo/scene/polygons/obj_material.h"

namespace rilievo {

void PlyTextures::read_comment(std::string_view rest) {
  std::string word = lower_case(take_word(rest));
  if (word.ends_with(':')) word.pop_back();
  if (word != "texturefile" && word != "texture_file") return;
  std::string_view name = trimmed(rest);
  if (name.starts_with(':')) name = trimmed(name.substr(1));
  if (name.size() >= 2 && name.front() == '"' && name.back() == '"')
    name = name.substr(1, name.size() - 2);
  if (name.empty()) return;
  context_.budget.take(2 * sizeof(std::string) + name.size());
  files_.emplace_back(name);
}

int PlyTextures::material(double number) {
  if (!(number >= 0 && number < double(files_.size()))) return -1;
  const auto [known, fresh] = materials_.try_emplace(std::size_t(number), -1);
  if (!fresh) return known->second;
  const std::string& file = files_[std::size_t(number)];
  try {
    const std::string encoded = read_neighbor(context_, file);
    Rgba8Image image = decode_picture(bytes_of(encoded), context_.budget);
    context_.budget.take(sizeof(Material) + sizeof(Texture) + sizeof(Rgba8Image) + 2 * file.size());
    Texture texture;
    texture.name = file;
    texture.image = int(scene_.images.size());
    Material material;
    material.name = file;
    material.base_color = glm::vec4(1.0f);
    material.double_sided = true;
    material.alpha_mode = alpha_mode_of(image);
    material.base_color_texture.texture = int(scene_.textures.size());
    scene_.images.push_back(std::move(image));
    scene_.textures.push_back(std::move(texture));
    scene_.materials.push_back(std::move(material));
    known->second = int(scene_.materials.size()) - 1;
  } catch (const LoadError& fault) {
    const bool named = fault.reason.find(file) != std::string::npos;
    context_.warn("a texture is left out: " + (named ? "" : "'" + file + "' ") + fault.reason);
  }
  return known->second;
}

}  // namespace rilievo
