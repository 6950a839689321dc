// A scene's materials for the CPU shading model.
//
// Each material with its textures: mip levels, wrapping and texture coordinates. Level 0 of a
// texture is the Scene's own image; the smaller levels are made once for each way of reading the
// image (sRGB or linear, and by each threshold of a mask). Plain numbers, constant over a mesh, for
// shading_model.inl. Read-only after the constructor: any thread.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <vector>

#include "rilievo/render/mip_chain.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The levels of a texture. A texel is four bytes; red is the first in memory.
struct TextureLevels {
  static constexpr int kMaxLevels = 31;
  const std::int32_t* texels = nullptr;   // of level 0
  const std::int32_t* smaller = nullptr;  // of the levels after it
  int count = 1;
  std::int32_t width = 1, height = 1;  // of level 0; level l: width >> l, at least 1
  std::int32_t offset[kMaxLevels] =
      {};  // of the level's first texel in `smaller`; unused for level 0
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool nearest = false;  // no interpolation when magnified
  bool srgb = false;
};

// A texture as a material uses it.
struct SurfaceTexture {
  TextureLevels levels;
  int uv_set = 0;
  glm::vec3 row_u{1, 0, 0}, row_v{0, 1, 0};  // texture coordinates: dot(row, (uv, 1))
};

// A material with its textures.
struct SurfaceMaterial {
  glm::vec4 base_color{1.0f};
  glm::vec3 emissive{0.0f};
  float metallic = 0, roughness = 0.8f, normal_scale = 1, occlusion_strength = 1;
  float alpha_cutoff = 0.5f;
  bool unlit = false, masked = false, blended = false, double_sided = false;
  std::optional<glm::mat4x3> code_from_mesh;  // Material::code_from_mesh
  bool textured = false;                      // has any of the following textures
  std::optional<SurfaceTexture> base, metallic_roughness, normal, occlusion, emission;
  bool uses_uv[2] = {false, false};
};

// A texture without its smaller levels. Requires one that exists and has texels.
[[nodiscard]] SurfaceTexture unscaled_texture(const Scene& scene, const TextureUse& use, bool srgb);

// The materials that get their textures.
enum class TexturedMaterials {
  opaque,   // those that do not blend
  blended,  // the others
  all,
};

// All materials of a scene.
class SurfaceMaterials {
 public:
  // `scene` must be valid and outlive the object; its materials and textures must not change.
  explicit SurfaceMaterials(const Scene& scene,
                            TexturedMaterials textured = TexturedMaterials::opaque);

  SurfaceMaterials(SurfaceMaterials&&) = default;  // pointers into its parts stay valid
  SurfaceMaterials& operator=(SurfaceMaterials&&) = default;

  [[nodiscard]] const SurfaceMaterial& of_mesh(int mesh) const;
  // The memory of the smaller levels, bytes.
  [[nodiscard]] std::size_t bytes() const;

 private:
  // An image and how it is read.
  struct Reading {
    int image = 0;
    bool srgb = false;
    float threshold = 0;  // of a mask, mask_threshold()
    auto operator<=>(const Reading&) const = default;
  };
  [[nodiscard]] std::optional<SurfaceTexture> use(const TextureUse& use, bool srgb,
                                                  float threshold = 0);

  const Scene* scene_;
  std::map<Reading, MipChain> chains_;
  std::vector<SurfaceMaterial> materials_;  // as Scene::materials, then the default material
};

}  // namespace rilievo
