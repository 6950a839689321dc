#include "rilievo/scene/assimp_material.h"

#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "rilievo/scene/picture_decode.h"

namespace rilievo {
namespace {

std::string picture_path(const aiMaterial& from, aiTextureType type) {
  aiString path;
  return from.GetTexture(type, 0, &path) == aiReturn_SUCCESS ? path.C_Str() : "";
}

bool has_alpha(const Rgba8Image& image) {
  return std::any_of(image.texels().begin(), image.texels().end(),
                     [](const glm::u8vec4& c) { return c.a < 250; });
}

// Cut-outs (leaves, fences) are nearly all in or out; glass is in between.
AlphaMode alpha_mode_of(const Rgba8Image& image) {
  if (!has_alpha(image)) return AlphaMode::opaque;
  const auto between = std::count_if(image.texels().begin(), image.texels().end(),
                                     [](const glm::u8vec4& c) { return c.a > 25 && c.a < 230; });
  // A quarter: the soft edges of leaves that are a few texels wide.
  return std::size_t(between) * 4 > image.texels().size() ? AlphaMode::blend : AlphaMode::mask;
}

// The opacity picture's alpha, or its brightness if it has none, as the alpha of `image`.
void set_alpha(const Rgba8Image& opacity, Rgba8Image& image) {
  const bool by_alpha = has_alpha(opacity);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const glm::u8vec4& o = opacity(int(std::int64_t(x) * opacity.width() / image.width()),
                                     int(std::int64_t(y) * opacity.height() / image.height()));
      image(x, y).a = by_alpha ? o.a : std::uint8_t((o.r + o.g + o.b) / 3);
    }
}

}  // namespace

int AssimpMaterials::texture(const std::string& path, const std::string& opacity) {
  const auto [known, fresh] = textures_.try_emplace({path, opacity}, -1);
  if (!fresh) return known->second;
  const auto decode = [&](const std::string& file) -> std::optional<Rgba8Image> {
    try {
      const std::string encoded = read_neighbor(context_, file);
      return decode_picture(bytes_of(encoded), context_.budget);
    } catch (const LoadFault& fault) {
      const bool named = fault.reason.find(file) != std::string::npos;
      context_.warn("a texture is left out: " + (named ? "" : "'" + file + "' ") + fault.reason);
      return {};
    }
  };
  Texture out;
  out.name = path.empty() ? opacity : path;
  if (!path.empty()) {
    if (std::optional<Rgba8Image> image = decode(path)) out.texels = std::move(*image);
  }
  if (!opacity.empty() && opacity != path) {
    if (const std::optional<Rgba8Image> image = decode(opacity)) {
      if (out.texels.empty())
        out.texels = Rgba8Image(image->width(), image->height(), glm::u8vec4(255));
      set_alpha(*image, out.texels);
    }
  }
  if (out.texels.empty()) return -1;
  known->second = int(scene_.textures.size());
  scene_.textures.push_back(std::move(out));
  return known->second;
}

void AssimpMaterials::read_opacity(const aiMaterial& from, Material& material) {
  float opacity = 1.0f;
  from.Get(AI_MATKEY_OPACITY, opacity);
  // Some exporters confuse d with Tr: nobody models what cannot be seen.
  if (opacity <= 0.0f) {
    context_.warn("material '" + material.name + "' is fully transparent; it is drawn opaque");
    opacity = 1.0f;
  }
  if (material.base_color_texture.texture >= 0)
    material.alpha_mode =
        alpha_mode_of(scene_.textures[material.base_color_texture.texture].texels);
  if (opacity < 1.0f) {
    material.alpha_mode = AlphaMode::blend;
    material.base_color.a = opacity;
  }
}

Material AssimpMaterials::read(const aiMaterial& from, bool colored) {
  Material m;
  aiString name;
  if (from.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) m.name = name.C_Str();
  aiColor3D diffuse(0.8f, 0.8f, 0.8f), emissive(0, 0, 0);
  from.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse);
  from.Get(AI_MATKEY_COLOR_EMISSIVE, emissive);
  float exponent = 0.0f;
  from.Get(AI_MATKEY_SHININESS, exponent);

  m.base_color_texture.texture = -1;
  const std::string color = picture_path(from, aiTextureType_DIFFUSE);
  const std::string opacity = picture_path(from, aiTextureType_OPACITY);
  if (!color.empty() || !opacity.empty()) m.base_color_texture.texture = texture(color, opacity);

  m.base_color = {diffuse.r, diffuse.g, diffuse.b, 1.0f};
  // A black factor would blacken the texture: exporters write it to say "no plain colour".
  const bool black = diffuse.r + diffuse.g + diffuse.b <= 0.0f;
  if (colored || (black && m.base_color_texture.texture >= 0)) m.base_color = glm::vec4(1.0f);
  m.emissive = {emissive.r, emissive.g, emissive.b};
  const std::string glow = picture_path(from, aiTextureType_EMISSIVE);
  if (!glow.empty()) m.emissive_texture.texture = texture(glow, "");

  // Blinn's exponent n as a width of the highlight: alpha^2 = 2 / (n + 2) and roughness^2 = alpha.
  m.metallic = 0.0f;
  if (exponent > 0.0f && std::isfinite(exponent))
    m.roughness = std::clamp(std::pow(2.0f / (exponent + 2.0f), 0.25f), 0.1f, 1.0f);
  // None of these formats says which side of a surface shows.
  m.double_sided = true;
  read_opacity(from, m);
  for (int c = 0; c < 4; ++c)
    m.base_color[c] = std::isfinite(m.base_color[c]) ? std::clamp(m.base_color[c], 0.0f, 1.0f) : 1;
  for (int c = 0; c < 3; ++c)
    m.emissive[c] = std::isfinite(m.emissive[c]) ? std::clamp(m.emissive[c], 0.0f, 1e6f) : 0;
  return m;
}

int AssimpMaterials::use(unsigned i, bool colored) {
  const auto [known, fresh] = materials_.try_emplace({i, colored}, -1);
  if (fresh && i < from_.mNumMaterials) {
    Material material = read(*from_.mMaterials[i], colored);
    known->second = int(scene_.materials.size());
    scene_.materials.push_back(std::move(material));
  }
  return known->second;
}

}  // namespace rilievo
