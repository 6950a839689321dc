#include "rilievo/capture/store/content_hash.h"

#include <cstring>
#include <type_traits>
#include <vector>

#include "rilievo/scene/scene.h"

namespace rilievo {
namespace {

// Of numbers without gaps between them.
template <class T>
void add_numbers(ContentHash& hash, const std::vector<T>& numbers) {
  static_assert(std::is_trivially_copyable_v<T>);
  hash.add(std::as_bytes(std::span(numbers)));
}

template <class... T>
void add_values(ContentHash& hash, const T&... values) {
  const auto add = [&](const auto& value) {
    static_assert(std::is_trivially_copyable_v<std::decay_t<decltype(value)>>);
    hash.add(std::as_bytes(std::span(&value, 1)));
  };
  (add(values), ...);
}

void add_use(ContentHash& hash, const TextureUse& use) {
  add_values(hash, use.texture, use.uv_set, use.texture_from_uv);
}

void add_material(ContentHash& hash, const Material& m) {
  add_values(hash, m.base_color, m.metallic, m.roughness, m.emissive, m.normal_scale,
             m.occlusion_strength, m.alpha_mode, m.alpha_cutoff, m.double_sided, m.unlit,
             m.transmission, m.ior, m.refracts);
  for (const TextureUse* use : {&m.base_color_texture, &m.metallic_roughness_texture,
                                &m.normal_texture, &m.occlusion_texture, &m.emissive_texture})
    add_use(hash, *use);
}

void add_mesh(ContentHash& hash, const Mesh& mesh) {
  add_values(hash, mesh.material);
  add_numbers(hash, mesh.positions);
  add_numbers(hash, mesh.normals);
  add_numbers(hash, mesh.tangents);
  for (const auto& uv : mesh.uv) add_numbers(hash, uv);
  add_numbers(hash, mesh.colors);
  add_numbers(hash, mesh.indices);
  if (mesh.primitive != Primitive::triangles)
    add_values(hash, mesh.primitive, mesh.width, mesh.width_px);
}

}  // namespace

void ContentHash::add(std::span<const std::byte> bytes) {
  add(std::uint64_t(bytes.size()));
  std::uint64_t word;
  std::size_t i = 0;
  for (; i + sizeof word <= bytes.size(); i += sizeof word) {
    std::memcpy(&word, bytes.data() + i, sizeof word);
    add(word);
  }
  if (i == bytes.size()) return;
  word = 0;
  std::memcpy(&word, bytes.data() + i, bytes.size() - i);
  add(word);
}

std::string ContentHash::text() const {
  std::string out;
  for (const std::uint64_t word : {a_, scramble(b_ ^ a_)})
    for (int shift = 60; shift >= 0; shift -= 4) out += "0123456789abcdef"[word >> shift & 15];
  return out;
}

std::string content_hash(const Scene& scene, double time) {
  ContentHash hash;
  for (const Rgba8Image& image : scene.images) {
    add_values(hash, image.width(), image.height());
    hash.add(std::as_bytes(image.texels()));
  }
  for (const Texture& t : scene.textures) add_values(hash, t.image, t.wrap_u, t.wrap_v, t.nearest);
  for (const Material& material : scene.materials) add_material(hash, material);
  for (const Mesh& mesh : scene.meshes) add_mesh(hash, mesh);
  for (const Model& model : scene.models) {
    hash.add(std::uint64_t(model.parts.size()));
    for (const Part& part : model.parts) add_values(hash, part.mesh, part.model_from_mesh);
  }
  std::vector<glm::mat4> poses;
  pose(scene, time, poses);
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    add_values(hash, scene.objects[i].model, poses[i]);
  for (const Light& l : scene.lights)
    add_values(hash, l.kind, l.position, l.direction, l.intensity, l.range, l.inner_cone,
               l.outer_cone);
  add_values(hash, scene.sky.zenith, scene.sky.horizon, scene.sky.ground);
  return hash.text();
}

}  // namespace rilievo
