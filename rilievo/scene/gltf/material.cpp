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

// Decodes what `source` holds, unless it has been before.
int Materials::load_image(const JsonValue& source) {
  LoadContext& context = *document_.context;
  const auto decode = [&](int& known, Bytes encoded) {
    scene_.images.push_back(decode_picture(encoded, context.budget));
    return known = int(scene_.images.size()) - 1;
  };
  if (const JsonValue view = source["bufferView"]) {
    const Bytes encoded = read_view(document_, view.required_index(document_.count("bufferViews")));
    const auto [known, fresh] = views_.try_emplace({encoded.data(), encoded.size()}, -1);
    return fresh ? decode(known->second, encoded) : known->second;
  }
  const std::string uri = source["uri"].text();
  const auto [known, fresh] = uris_.try_emplace(identity_of(uri, context), -1);
  if (!fresh) return known->second;
  const std::string file = read_uri(uri, context);
  return decode(known->second, bytes_of(file));
}

// Index into Scene::images of images[i]; -1 if it cannot be had. A picture that is missing or
// damaged takes nothing from the shape: go on without it.
int Materials::image(int i) {
  const auto [at, fresh] = images_.try_emplace(i, -1);
  if (!fresh) return at->second;
  const JsonValue source = document_.root()["images"][std::size_t(i)];
  try {
    at->second = load_image(source);
  } catch (const LoadError& fault) {
    document_.context->warn(source.path() + " is left out: " + fault.reason);
  }
  return at->second;
}

int Materials::load_texture(const JsonValue& texture) {
  const JsonValue root = document_.root();
  const int source = picture_of(texture, document_.count("images"));
  if (source < 0) {
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
  out.name = root["images"][std::size_t(source)]["name"].text("");
  out.image = image(source);
  if (out.image < 0) return -1;
  const auto [known, fresh] = sampled_.try_emplace(
      std::tuple(out.image, out.wrap_u, out.wrap_v, out.nearest), int(scene_.textures.size()));
  if (fresh) scene_.textures.push_back(std::move(out));
  return known->second;
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
      // A ray tracer takes it as it is.
      m.transmission = transmission;
      m.ior = float(std::clamp(extensions["KHR_materials_ior"]["ior"].number(1.5), 1.0, 10.0));
      m.refracts = extensions["KHR_materials_volume"]["thicknessFactor"].number(0.0) > 0;
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
