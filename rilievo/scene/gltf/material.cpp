#include "rilievo/scene/gltf/material.h"

#include <algorithm>
#include <cmath>

#include "rilievo/io/picture_decode.h"

namespace rilievo::gltf {
namespace {

Wrap wrap_mode(const JsonValue& mode) {
  switch (mode.whole(10497)) {
    case 33071:
      return Wrap::clamp_to_edge;
    case 33648:
      return Wrap::mirrored_repeat;
    case 10497:
      return Wrap::repeat;
    default:
      mode.fail("is not a wrapping mode of glTF 2.0");
  }
}

// KHR_texture_transform: offset * rotation * scale, the rotation counter-clockwise in a space whose
// v grows downwards.
glm::mat3 texture_transform(const JsonValue& t) {
  double offset[2] = {0, 0}, scale[2] = {1, 1};
  t["offset"].numbers(offset);
  t["scale"].numbers(scale);
  const double angle = t["rotation"].number(0.0), c = std::cos(angle), s = std::sin(angle);
  return {glm::vec3(c * scale[0], -s * scale[0], 0), glm::vec3(s * scale[1], c * scale[1], 0),
          glm::vec3(offset[0], offset[1], 1)};
}

// Which picture of a texture: WebP is preferred, as the extension asks; -1: none that can be read.
int picture_of(const JsonValue& texture, std::size_t images) {
  if (const JsonValue webp = texture["extensions"]["EXT_texture_webp"]["source"])
    return webp.required_index(images);
  return texture["source"].index(images);
}

}  // namespace

int Materials::load_texture(const JsonValue& texture) {
  const JsonValue root = document_.root();
  const int image = picture_of(texture, document_.count("images"));
  if (image < 0) {
    document_.context->warn(texture.path() + " has no picture that can be read and is left out");
    return -1;
  }
  Texture out;
  const int sampler = texture["sampler"].index(document_.count("samplers"));
  if (sampler >= 0) {
    const JsonValue s = root["samplers"][std::size_t(sampler)];
    out.wrap_u = wrap_mode(s["wrapS"]);
    out.wrap_v = wrap_mode(s["wrapT"]);
    out.nearest = s["magFilter"].whole(9729) == 9728;
  }
  const auto key = std::tuple(image, out.wrap_u, out.wrap_v, out.nearest);
  if (const auto known = pictures_.find(key); known != pictures_.end()) return known->second;

  const JsonValue source = root["images"][std::size_t(image)];
  out.name = source["name"].text("");
  int& index = pictures_[key];
  index = -1;
  // A picture that is missing or damaged takes nothing from the shape: go on without it.
  try {
    std::string file;
    Bytes encoded;
    if (const JsonValue view = source["bufferView"]) {
      encoded = read_view(document_, view.required_index(document_.count("bufferViews")));
    } else {
      file = read_uri(source["uri"].text(), *document_.context);
      encoded = bytes_of(file);
    }
    out.texels = decode_picture(encoded, document_.context->budget);
  } catch (const LoadFault& fault) {
    document_.context->warn(source.path() + " is left out: " + fault.reason);
    return -1;
  }
  index = int(scene_.textures.size());
  scene_.textures.push_back(std::move(out));
  return index;
}

int Materials::texture(int i) {
  const auto [at, fresh] = textures_.try_emplace(i, -1);
  if (fresh) at->second = load_texture(document_.root()["textures"][std::size_t(i)]);
  return at->second;
}

TextureUse Materials::texture_use(const JsonValue& info) {
  TextureUse use;
  if (!info) return use;
  const int i = info["index"].required_index(document_.count("textures"));
  std::uint64_t uv_set = info["texCoord"].whole(0);
  if (const JsonValue transform = info["extensions"]["KHR_texture_transform"]) {
    use.texture_from_uv = texture_transform(transform);
    uv_set = transform["texCoord"].whole(uv_set);
  }
  if (uv_set > 1) {
    document_.context->warn(info.path() +
                            " uses a third set of texture coordinates; the first is used instead");
    uv_set = 0;
  }
  use.uv_set = int(uv_set);
  use.texture = texture(i);
  return use;
}

// KHR_materials_pbrSpecularGlossiness, as a dielectric of the diffuse colour: metals come out dull.
void Materials::read_specular_glossiness(const JsonValue& from, Material& material) {
  document_.context->warn(from.path() + " is approximated by metallic-roughness");
  material.base_color = glm::vec4(from["diffuseFactor"].vec4(glm::dvec4(1)));
  material.base_color_texture = texture_use(from["diffuseTexture"]);
  material.metallic = 0;
  material.roughness = 1.0f - float(from["glossinessFactor"].number(1.0));
  material.metallic_roughness_texture = {};
}

Material Materials::read(const JsonValue& from) {
  Material m;
  m.name = from["name"].text("");
  const JsonValue extensions = from["extensions"];
  const JsonValue pbr = from["pbrMetallicRoughness"];
  m.base_color = glm::vec4(pbr["baseColorFactor"].vec4(glm::dvec4(1)));
  m.metallic = float(pbr["metallicFactor"].number(1.0));
  m.roughness = float(pbr["roughnessFactor"].number(1.0));
  m.base_color_texture = texture_use(pbr["baseColorTexture"]);
  m.metallic_roughness_texture = texture_use(pbr["metallicRoughnessTexture"]);
  if (const JsonValue glossy = extensions["KHR_materials_pbrSpecularGlossiness"]; glossy && !pbr)
    read_specular_glossiness(glossy, m);

  m.normal_texture = texture_use(from["normalTexture"]);
  m.normal_scale = float(from["normalTexture"]["scale"].number(1.0));
  m.occlusion_texture = texture_use(from["occlusionTexture"]);
  m.occlusion_strength = float(from["occlusionTexture"]["strength"].number(1.0));
  m.emissive_texture = texture_use(from["emissiveTexture"]);
  m.emissive = glm::vec3(from["emissiveFactor"].vec3(glm::dvec3(0)));
  m.emissive *=
      float(extensions["KHR_materials_emissive_strength"]["emissiveStrength"].number(1.0));

  const std::string mode = from["alphaMode"].text("OPAQUE");
  if (mode == "MASK")
    m.alpha_mode = AlphaMode::mask;
  else if (mode == "BLEND")
    m.alpha_mode = AlphaMode::blend;
  else if (mode != "OPAQUE")
    from["alphaMode"].fail("is '" + mode + "', which is unknown");
  m.alpha_cutoff = float(from["alphaCutoff"].number(0.5));
  m.double_sided = from["doubleSided"].boolean(false);
  m.unlit = bool(extensions["KHR_materials_unlit"]);

  // Light goes through: let what is behind shine through as far. A texture of transmission usually
  // says "only here", which one factor cannot.
  if (const JsonValue glass = extensions["KHR_materials_transmission"]) {
    const float transmission = float(std::clamp(glass["transmissionFactor"].number(0.0), 0.0, 1.0));
    if (glass["transmissionTexture"]) {
      document_.context->warn(glass.path() + " has a texture and is left out");
    } else if (transmission > 0) {
      document_.context->warn(glass.path() + " is approximated by blended alpha");
      m.alpha_mode = AlphaMode::blend;
      // A tenth stays: glass that nothing shows of cannot be told from a hole.
      m.base_color.a *= 1.0f - 0.9f * transmission;
    }
  }

  // Factors outside their ranges are faults of the file that have an obvious remedy.
  m.base_color = glm::clamp(m.base_color, 0.0f, 1.0f);
  m.metallic = std::clamp(m.metallic, 0.0f, 1.0f);
  m.roughness = std::clamp(m.roughness, 0.0f, 1.0f);
  m.occlusion_strength = std::clamp(m.occlusion_strength, 0.0f, 1.0f);
  m.emissive = glm::clamp(m.emissive, 0.0f, 1e6f);
  return m;
}

int Materials::use(int i) {
  const auto [at, fresh] = materials_.try_emplace(i, 0);
  if (fresh) {
    Material material;
    if (i < 0)
      material.name = "default", material.metallic = 1.0f, material.roughness = 1.0f;
    else
      material = read(document_.root()["materials"][std::size_t(i)]);
    at->second = int(scene_.materials.size());
    scene_.materials.push_back(std::move(material));
  }
  return at->second;
}

}  // namespace rilievo::gltf
