#include <map>

#include "rilievo/scene/gltf/glb_writer.h"
#include "rilievo/scene/scene.h"

namespace rilievo {
namespace {

// The mesh of a part, in the model's space. A mirrored part's triangles turn the other way round.
Mesh moved(const Mesh& mesh, const glm::mat4& to_from_mesh) {
  Mesh out = mesh;
  const glm::mat3 linear(to_from_mesh);
  // The cofactors carry normals through any linear map; cf. the shaders of direct drawing.
  const float sign = glm::determinant(linear) < 0 ? -1.0f : 1.0f;
  const glm::mat3 normals =
      sign * glm::mat3(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                       glm::cross(linear[0], linear[1]));
  const auto unit = [](const glm::vec3& v, const glm::vec3& fallback) {
    const float length = glm::length(v);
    return length > 0 ? v / length : fallback;
  };
  for (glm::vec3& p : out.positions) p = glm::vec3(to_from_mesh * glm::vec4(p, 1));
  for (glm::vec3& n : out.normals) n = unit(normals * n, n);
  for (glm::vec4& t : out.tangents)
    t = glm::vec4(unit(linear * glm::vec3(t), glm::vec3(t)), sign * t.w);
  if (sign < 0 && out.primitive == Primitive::triangles)
    for (std::size_t i = 0; i + 2 < out.indices.size(); i += 3)
      std::swap(out.indices[i + 1], out.indices[i + 2]);
  return out;
}

template <int N>
std::vector<float> floats_of(const std::vector<glm::vec<N, float>>& vectors) {
  const float* first = &vectors[0][0];
  return {first, first + vectors.size() * N};
}

// `kept`: does the mesh live as long as the writer?
GlbJson primitive_of(GlbWriter& writer, const Mesh& mesh, bool kept, int default_material) {
  GlbJson attributes;
  const auto add = [&]<int N>(const char* name, const std::vector<glm::vec<N, float>>& vectors) {
    if (vectors.empty()) return;
    const bool bounds = attributes.is_null();  // positions come first, and need them
    attributes[name] =
        kept ? writer.add_floats({&vectors[0][0], vectors.size() * N}, N, kGlbVertices, bounds)
             : writer.add_owned_floats(floats_of(vectors), N, bounds);
  };
  add("POSITION", mesh.positions);
  add("NORMAL", mesh.normals);
  add("TANGENT", mesh.tangents);
  // Sets of texture coordinates have no gaps: a second alone stands for the first, too.
  add("TEXCOORD_0", mesh.uv[0].empty() ? mesh.uv[1] : mesh.uv[0]);
  add("TEXCOORD_1", mesh.uv[1]);
  add("COLOR_0", mesh.colors);
  GlbJson out = {{"attributes", attributes},
                 {"indices", writer.add_indices(mesh.indices, mesh.positions.size())},
                 {"material", mesh.material < 0 ? default_material : mesh.material}};
  if (mesh.primitive != Primitive::triangles)
    out["mode"] = mesh.primitive == Primitive::points ? 0 : 1;
  return out;
}

}  // namespace

std::vector<int> add_glb_meshes(GlbWriter& writer, const Scene& scene, int default_material) {
  std::map<int, GlbJson> primitives;  // of parts that stand where their meshes do
  std::vector<int> mesh_of_model;
  for (const Model& model : scene.models) {
    GlbJson list = GlbJson::array();
    for (const Part& part : model.parts) {
      const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
      if (mesh.indices.empty()) continue;
      if (part.model_from_mesh != glm::mat4(1.0f)) {
        list.push_back(
            primitive_of(writer, moved(mesh, part.model_from_mesh), false, default_material));
        continue;
      }
      const auto [known, fresh] = primitives.try_emplace(part.mesh);
      if (fresh) known->second = primitive_of(writer, mesh, true, default_material);
      list.push_back(known->second);
    }
    if (list.empty()) {
      mesh_of_model.push_back(-1);
      continue;
    }
    GlbJson mesh;
    if (!model.name.empty()) mesh["name"] = model.name;
    mesh["primitives"] = std::move(list);
    mesh_of_model.push_back(writer.add("meshes", std::move(mesh)));
  }
  return mesh_of_model;
}

}  // namespace rilievo
