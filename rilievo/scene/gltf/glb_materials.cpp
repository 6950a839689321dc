#include <algorithm>
#include <cmath>
#include <cstring>

#include "rilievo/io/png.h"
#include "rilievo/scene/gltf/glb_writer.h"
#include "rilievo/scene/scene.h"

namespace rilievo {
namespace {

int wrap_mode(Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return 10497;
    case Wrap::mirrored_repeat:
      return 33648;
    case Wrap::clamp_to_edge:
      return 33071;
  }
  return 10497;
}

// Named after the first texture that shows it.
void add_image(GlbWriter& writer, const Scene& scene, std::size_t index) {
  const std::vector<std::uint8_t> png = encode_png(scene.images[index]);
  std::vector<std::byte> bytes(png.size());
  std::memcpy(bytes.data(), png.data(), png.size());
  GlbJson image{{"bufferView", writer.add_owned_view(std::move(bytes))}, {"mimeType", "image/png"}};
  for (const Texture& texture : scene.textures) {
    if (std::size_t(texture.image) != index) continue;
    if (!texture.name.empty()) image["name"] = texture.name;
    break;
  }
  writer.add("images", std::move(image));
}

void add_texture(GlbWriter& writer, const Texture& texture) {
  const int sampler = writer.add("samplers", {{"magFilter", texture.nearest ? 9728 : 9729},
                                              {"minFilter", 9987},
                                              {"wrapS", wrap_mode(texture.wrap_u)},
                                              {"wrapT", wrap_mode(texture.wrap_v)}});
  writer.add("textures", {{"source", texture.image}, {"sampler", sampler}});
}

// KHR_texture_transform knows offset * rotation * scale:
//   | c sx   s sy   ox |
//   | -s sx  c sy   oy |
// whose columns are orthogonal. sx is taken positive; sy has the sign of the determinant.
GlbJson texture_transform(const glm::mat3& m) {
  const glm::dvec2 x(m[0]), y(m[1]);
  const double sx = glm::length(x), rotation = sx > 0 ? std::atan2(-x.y, x.x) : 0;
  const double sy = y.x * std::sin(rotation) + y.y * std::cos(rotation);
  return {{"offset", {m[2].x, m[2].y}}, {"rotation", rotation}, {"scale", {sx, sy}}};
}

GlbJson texture_info(GlbWriter& writer, const TextureUse& use) {
  GlbJson info{{"index", use.texture}};
  if (use.uv_set) info["texCoord"] = use.uv_set;
  if (use.texture_from_uv != glm::mat3(1.0f)) {
    writer.use_extension("KHR_texture_transform");
    info["extensions"]["KHR_texture_transform"] = texture_transform(use.texture_from_uv);
  }
  return info;
}

GlbJson material_of(GlbWriter& writer, const Material& m) {
  GlbJson out;
  if (!m.name.empty()) out["name"] = m.name;
  GlbJson& pbr = out["pbrMetallicRoughness"];
  pbr["baseColorFactor"] = {m.base_color.r, m.base_color.g, m.base_color.b, m.base_color.a};
  pbr["metallicFactor"] = m.metallic;
  pbr["roughnessFactor"] = m.roughness;
  const auto has = [](const TextureUse& use) { return use.texture >= 0; };
  if (has(m.base_color_texture))
    pbr["baseColorTexture"] = texture_info(writer, m.base_color_texture);
  if (has(m.metallic_roughness_texture))
    pbr["metallicRoughnessTexture"] = texture_info(writer, m.metallic_roughness_texture);
  if (has(m.normal_texture)) {
    out["normalTexture"] = texture_info(writer, m.normal_texture);
    out["normalTexture"]["scale"] = m.normal_scale;
  }
  if (has(m.occlusion_texture)) {
    out["occlusionTexture"] = texture_info(writer, m.occlusion_texture);
    out["occlusionTexture"]["strength"] = m.occlusion_strength;
  }
  if (has(m.emissive_texture)) out["emissiveTexture"] = texture_info(writer, m.emissive_texture);
  // The factor itself stays within [0, 1].
  const float strength = std::max({m.emissive.r, m.emissive.g, m.emissive.b, 1.0f});
  if (m.emissive != glm::vec3(0.0f))
    out["emissiveFactor"] = {m.emissive.r / strength, m.emissive.g / strength,
                             m.emissive.b / strength};
  if (strength > 1.0f) {
    writer.use_extension("KHR_materials_emissive_strength");
    out["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
  }
  if (m.alpha_mode == AlphaMode::mask)
    out["alphaMode"] = "MASK", out["alphaCutoff"] = m.alpha_cutoff;
  if (m.alpha_mode == AlphaMode::blend) out["alphaMode"] = "BLEND";
  if (m.double_sided) out["doubleSided"] = true;
  if (m.unlit) {
    writer.use_extension("KHR_materials_unlit");
    out["extensions"]["KHR_materials_unlit"] = GlbJson::object();
  }
  return out;
}

}  // namespace

void add_glb_materials(GlbWriter& writer, const Scene& scene) {
  for (std::size_t i = 0; i < scene.images.size(); ++i) add_image(writer, scene, i);
  for (const Texture& texture : scene.textures) add_texture(writer, texture);
  for (const Material& material : scene.materials)
    writer.add("materials", material_of(writer, material));
}

}  // namespace rilievo
