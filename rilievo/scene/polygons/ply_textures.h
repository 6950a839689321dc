// Which pictures do the faces of a PLY file show? Internal to loading.
//
// Comments of the header name them, "comment TextureFile skin.png"; a face's texnumber counts them.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/io/load_context.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The pictures of one PLY file, decoded on demand.
class PlyTextures {
 public:
  explicit PlyTextures(LoadContext& context) : context_(context) {}

  // Reads what follows "comment" or "obj_info" in the header.
  void read_comment(std::string_view rest);
  [[nodiscard]] bool empty() const { return files_.empty(); }

  // The index of the material that shows picture `number`; -1 if there is none.
  [[nodiscard]] int material(double number);

  // A scene of the materials in use, with their textures and images.
  [[nodiscard]] Scene take() { return std::move(scene_); }

 private:
  LoadContext& context_;
  std::vector<std::string> files_;
  std::map<std::size_t, int> materials_;  // by number
  Scene scene_;
};

}  // namespace rilievo
