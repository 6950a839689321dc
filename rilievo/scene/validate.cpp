#include <cmath>
#include <string>

#include "rilievo/scene/scene.h"

namespace rilievo {
namespace {

template <int N>
bool finite(const glm::vec<N, float>& v) {
  for (int i = 0; i < N; ++i)
    if (!std::isfinite(v[i])) return false;
  return true;
}

bool finite(const glm::mat3& m) { return finite(m[0]) && finite(m[1]) && finite(m[2]); }
bool finite(const glm::mat4x3& m) {
  return finite(m[0]) && finite(m[1]) && finite(m[2]) && finite(m[3]);
}

// Finite, and the last row is 0 0 0 1.
bool affine(const glm::mat4& m) {
  for (int c = 0; c < 4; ++c)
    if (!finite(m[c]) || m[c][3] != (c == 3 ? 1.0f : 0.0f)) return false;
  return true;
}

template <class Vectors>
bool all_finite(const Vectors& vectors) {
  for (const auto& v : vectors)
    if (!finite(v)) return false;
  return true;
}

// An index that may be absent (-1).
bool optional_index(int i, std::size_t size) { return i >= -1 && (i < 0 || std::size_t(i) < size); }
bool index(int i, std::size_t size) { return i >= 0 && std::size_t(i) < size; }

Error fault(const char* kind, std::size_t i, const std::string& reason) {
  return {"scene", std::string(kind) + " " + std::to_string(i) + " " + reason};
}

Result<> check_textures(const Scene& scene) {
  for (std::size_t i = 0; i < scene.images.size(); ++i)
    if (scene.images[i].empty()) return fault("image", i, "has no texels");
  for (std::size_t i = 0; i < scene.textures.size(); ++i)
    if (!index(scene.textures[i].image, scene.images.size()))
      return fault("texture", i, "has an image that does not exist");
  return Done{};
}

Result<> check_materials(const Scene& scene) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    const TextureUse* const uses[] = {&m.base_color_texture, &m.metallic_roughness_texture,
                                      &m.normal_texture, &m.occlusion_texture, &m.emissive_texture};
    for (const TextureUse* use : uses) {
      if (!optional_index(use->texture, scene.textures.size()))
        return fault("material", i, "uses a texture that does not exist");
      if (use->uv_set < 0 || use->uv_set > 1)
        return fault("material", i, "uses a set of texture coordinates other than 0 and 1");
      if (!finite(use->texture_from_uv))
        return fault("material", i, "has a texture transform that is not finite");
    }
    for (float v : {m.metallic, m.roughness, m.normal_scale, m.occlusion_strength, m.alpha_cutoff,
                    m.transmission, m.ior})
      if (!std::isfinite(v)) return fault("material", i, "has a factor that is not finite");
    if (!finite(m.base_color) || !finite(m.emissive))
      return fault("material", i, "has a colour that is not finite");
    if (m.code_from_mesh && !finite(*m.code_from_mesh))
      return fault("material", i, "has a code of positions that is not finite");
  }
  return Done{};
}

Result<> check_meshes(const Scene& scene) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const Mesh& m = scene.meshes[i];
    const std::size_t n = m.positions.size();
    if (!optional_index(m.material, scene.materials.size()))
      return fault("mesh", i, "has a material that does not exist");
    for (std::size_t size :
         {m.normals.size(), m.tangents.size(), m.uv[0].size(), m.uv[1].size(), m.colors.size()})
      if (size != 0 && size != n) return fault("mesh", i, "has arrays of different lengths");
    if (m.indices.size() % corners_of(m.primitive) != 0)
      return fault("mesh", i,
                   "has a number of indices that " + std::to_string(corners_of(m.primitive)) +
                       " does not divide");
    if (!std::isfinite(m.width) || m.width < 0 || !std::isfinite(m.width_px) || m.width_px < 0 ||
        (m.width > 0 && m.primitive != Primitive::points))
      return fault("mesh", i, "has an impossible width");
    if (m.primitive != Primitive::triangles && m.material >= 0 &&
        scene.materials[std::size_t(m.material)].alpha_mode != AlphaMode::opaque)
      return fault("mesh", i, "has points or lines whose material is not opaque");
    for (std::uint32_t v : m.indices)
      if (v >= n) return fault("mesh", i, "has an index out of range: " + std::to_string(v));
    if (!all_finite(m.positions)) return fault("mesh", i, "has a position that is not finite");
    if (!all_finite(m.normals) || !all_finite(m.tangents) || !all_finite(m.uv[0]) ||
        !all_finite(m.uv[1]) || !all_finite(m.colors))
      return fault("mesh", i, "has a vertex attribute that is not finite");
  }
  return Done{};
}

Result<> check_models(const Scene& scene) {
  for (std::size_t i = 0; i < scene.models.size(); ++i)
    for (const Part& part : scene.models[i].parts) {
      if (!index(part.mesh, scene.meshes.size()))
        return fault("model", i, "has a mesh that does not exist");
      if (!affine(part.model_from_mesh))
        return fault("model", i, "has a matrix that is not finite and affine");
    }
  return Done{};
}

Result<> check_animation(const Scene& scene) {
  if (!std::isfinite(scene.duration) || scene.duration < 0)
    return Error{"scene", "its duration is not a number of seconds"};
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    if (node.parent < -1 || node.parent >= int(i))
      return fault("node", i, "does not come after its parent");
    const glm::quat& q = node.rotation;
    if (!finite(glm::vec3(node.translation)) || !finite(node.scale) ||
        !finite(glm::vec4(q.x, q.y, q.z, q.w)))
      return fault("node", i, "has a placement that is not finite");
  }
  for (std::size_t i = 0; i < scene.channels.size(); ++i) {
    const Channel& c = scene.channels[i];
    if (!index(c.node, scene.nodes.size()))
      return fault("channel", i, "moves a node that does not exist");
    if (c.times.empty()) return fault("channel", i, "has no keys");
    const std::size_t each = c.interpolation == Channel::Interpolation::cubic_spline ? 3 : 1;
    if (c.values.size() != each * c.times.size())
      return fault("channel", i, "has a wrong number of values for its keys");
    for (std::size_t k = 0; k < c.times.size(); ++k)
      if (!std::isfinite(c.times[k]) || (k > 0 && !(c.times[k - 1] < c.times[k])))
        return fault("channel", i, "has times that do not ascend");
    if (!all_finite(c.values)) return fault("channel", i, "has a value that is not finite");
  }
  return Done{};
}

Result<> check_objects(const Scene& scene) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    if (!index(object.model, scene.models.size()))
      return fault("object", i, "has a model that does not exist");
    if (!optional_index(object.node, scene.nodes.size()))
      return fault("object", i, "has a node that does not exist");
    if (!affine(object.placement))
      return fault("object", i, "has a placement that is not finite and affine");
  }
  return Done{};
}

Result<> check_lights_and_cameras(const Scene& scene) {
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if (!finite(light.position) || !finite(light.direction) || !finite(light.intensity) ||
        !std::isfinite(light.range) || !std::isfinite(light.inner_cone) ||
        !std::isfinite(light.outer_cone))
      return fault("light", i, "has a number that is not finite");
    // 1e-3: a direction read from a file with four digits.
    if (std::abs(glm::length(light.direction) - 1.0f) > 1e-3f)
      return fault("light", i, "has a direction that is not a unit vector");
  }
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    if (const Result<> camera = validate(scene.cameras[i]); !camera)
      return fault("camera", i, "is not valid: " + camera.error().reason);
  if (!finite(scene.sky.zenith) || !finite(scene.sky.horizon) || !finite(scene.sky.ground))
    return Error{"scene", "its sky is not finite"};
  return Done{};
}

}  // namespace

Result<> validate(const Scene& scene) {
  for (const auto check : {check_textures, check_materials, check_meshes, check_models,
                           check_animation, check_objects, check_lights_and_cameras})
    if (Result<> checked = check(scene); !checked) return checked;
  return Done{};
}

}  // namespace rilievo
