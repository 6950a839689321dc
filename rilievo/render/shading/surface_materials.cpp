#include "rilievo/render/shading/surface_materials.h"

#include <bit>

#include "rilievo/core/expects.h"
#include "rilievo/render/mask_coverage.h"

namespace rilievo {
namespace {

static_assert(sizeof(glm::u8vec4) == sizeof(std::int32_t));
// Red is the lowest byte of a texel.
static_assert(std::endian::native == std::endian::little);

const std::int32_t* words(const glm::u8vec4* texels) {
  return reinterpret_cast<const std::int32_t*>(texels);
}

}  // namespace

SurfaceTexture unscaled_texture(const Scene& scene, const TextureUse& use, bool srgb) {
  const Texture& texture = scene.textures[std::size_t(use.texture)];
  const Rgba8Image& image = scene.images[std::size_t(texture.image)];
  RILIEVO_EXPECTS(!image.empty());
  SurfaceTexture out;
  TextureLevels& levels = out.levels;
  levels.texels = words(image.texels().data());
  // Never null: where there is but one level, nothing is read but something may be addressed.
  levels.smaller = levels.texels;
  levels.width = image.width(), levels.height = image.height();
  levels.wrap_u = texture.wrap_u, levels.wrap_v = texture.wrap_v;
  levels.nearest = texture.nearest;
  levels.srgb = srgb;
  out.uv_set = use.uv_set;
  const glm::mat3 rows = glm::transpose(use.texture_from_uv);
  out.row_u = rows[0], out.row_v = rows[1];
  return out;
}

std::optional<SurfaceTexture> SurfaceMaterials::use(const TextureUse& use, bool srgb,
                                                    float threshold) {
  if (use.texture < 0) return std::nullopt;
  const int number = scene_->textures[std::size_t(use.texture)].image;
  const Rgba8Image& image = scene_->images[std::size_t(number)];
  if (image.empty()) return std::nullopt;
  MipChain& chain = chains_[{number, srgb, threshold}];
  if (chain.levels.empty())
    chain =
        threshold > 0 ? build_mask_mip_chain(image, srgb, threshold) : build_mip_chain(image, srgb);
  SurfaceTexture out = unscaled_texture(*scene_, use, srgb);
  TextureLevels& levels = out.levels;
  levels.count = int(chain.levels.size());
  RILIEVO_EXPECTS(levels.count <= TextureLevels::kMaxLevels);
  if (!chain.texels.empty()) levels.smaller = words(chain.texels.data());
  for (int l = 1; l < levels.count; ++l) {
    const MipChain::Level& level = chain.levels[std::size_t(l)];
    levels.offset[l] = std::int32_t(level.offset);
  }
  return out;
}

SurfaceMaterials::SurfaceMaterials(const Scene& scene, TexturedMaterials textured)
    : scene_(&scene) {
  const Material fallback;
  for (std::size_t i = 0; i <= scene.materials.size(); ++i) {
    const Material& m = i < scene.materials.size() ? scene.materials[i] : fallback;
    SurfaceMaterial out;
    out.base_color = m.base_color;
    out.emissive = m.emissive;
    out.metallic = m.metallic, out.roughness = m.roughness;
    out.normal_scale = m.normal_scale, out.occlusion_strength = m.occlusion_strength;
    out.alpha_cutoff = m.alpha_cutoff;
    out.code_from_mesh = m.code_from_mesh;
    out.unlit = m.unlit, out.double_sided = m.double_sided;
    out.masked = m.alpha_mode == AlphaMode::mask;
    out.blended = m.alpha_mode == AlphaMode::blend;
    if (textured == TexturedMaterials::all ||
        out.blended == (textured == TexturedMaterials::blended)) {
      out.base = use(m.base_color_texture, true, mask_threshold(m));
      if (!m.unlit) {
        out.metallic_roughness = use(m.metallic_roughness_texture, false);
        out.normal = use(m.normal_texture, false);
        out.occlusion = use(m.occlusion_texture, false);
        if (m.emissive != glm::vec3(0)) out.emission = use(m.emissive_texture, true);
      }
    }
    for (const auto* texture :
         {&out.base, &out.metallic_roughness, &out.normal, &out.occlusion, &out.emission})
      if (*texture) {
        out.textured = true;
        out.uses_uv[(*texture)->uv_set] = true;
      }
    materials_.push_back(out);
  }
}

const SurfaceMaterial& SurfaceMaterials::of_mesh(int mesh) const {
  const int material = scene_->meshes[std::size_t(mesh)].material;
  return material < 0 ? materials_.back() : materials_[std::size_t(material)];
}

std::size_t SurfaceMaterials::bytes() const {
  std::size_t bytes = 0;
  for (const auto& [reading, chain] : chains_) bytes += chain.bytes();
  return bytes;
}

}  // namespace rilievo
