// Materials, textures and samplers of a glTF document. Internal; throws LoadError.
#pragma once

#include <map>
#include <tuple>
#include <vector>

#include "rilievo/scene/gltf/document.h"
#include "rilievo/scene/scene.h"

namespace rilievo::gltf {

// Reads materials when they are first used, and with them their pictures: what no drawn triangle
// needs is not decoded.
class Materials {
 public:
  Materials(Document& document, Scene& scene) : document_(document), scene_(scene) {}

  // Index into Scene::materials of materials[i], or of glTF's default material for i = -1.
  [[nodiscard]] int use(int i);

 private:
  [[nodiscard]] TextureUse texture_use(const JsonValue& info);
  [[nodiscard]] int texture(int i);
  [[nodiscard]] int load_texture(const JsonValue& texture);
  [[nodiscard]] int image(int i);
  [[nodiscard]] int load_image(const JsonValue& source);
  [[nodiscard]] Material read(const JsonValue& from);
  void read_specular_glossiness(const JsonValue& from, Material& material);

  Document& document_;
  Scene& scene_;
  std::map<int, int> materials_, textures_, images_;  // glTF's index -> the scene's, or -1
  // What many textures, or many images of glTF, may have in common: an image and how it is sampled;
  // the bytes of a view; a file, or a data URI.
  std::map<std::tuple<int, Wrap, Wrap, bool>, int> sampled_;
  std::map<std::pair<const std::uint8_t*, std::size_t>, int> views_;
  std::map<std::string, int> uris_;
};

}  // namespace rilievo::gltf
