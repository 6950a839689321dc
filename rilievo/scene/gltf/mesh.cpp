#include "rilievo/scene/gltf/mesh.h"

#include <array>
#include <cmath>

#include "rilievo/scene/gltf/attributes.h"
#include "rilievo/scene/gltf/skin.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo::gltf {
namespace {

template <int N>
std::vector<glm::vec<N, float>> vectors(const Attribute& from) {
  std::vector<glm::vec<N, float>> out(from.numbers ? from.values.size() / from.numbers : 0);
  for (std::size_t i = 0; i < out.size(); ++i)
    for (int c = 0; c < N && c < from.numbers; ++c) out[i][c] = from.values[i * from.numbers + c];
  return out;
}

// Colours of 3 or 4 numbers. Integers stand for [0, 1] even where the file forgets to say so.
std::vector<glm::vec4> read_colors(const AttributeSource& source) {
  Attribute from = read_attribute(source, "COLOR_0", std::array{3, 4});
  if (from.component != Component::float32 && !from.normalized)
    for (float& v : from.values) v = normalized_from(from.component, v);
  std::vector<glm::vec4> colors = vectors<4>(from);
  if (from.numbers == 3)
    for (glm::vec4& c : colors) c.a = 1.0f;
  return colors;
}

// Every attribute of the vertices in use, as the file has them.
Mesh read_attributes(const AttributeSource& source, std::vector<std::uint32_t> indices) {
  constexpr std::array kTwo{2}, kThree{3}, kFour{4};
  Mesh mesh;
  mesh.indices = std::move(indices);
  mesh.positions = vectors<3>(read_attribute(source, "POSITION", kThree));
  mesh.normals = vectors<3>(read_attribute(source, "NORMAL", kThree));
  if (!mesh.normals.empty()) mesh.tangents = vectors<4>(read_attribute(source, "TANGENT", kFour));
  mesh.uv[0] = vectors<2>(read_attribute(source, "TEXCOORD_0", kTwo));
  mesh.uv[1] = vectors<2>(read_attribute(source, "TEXCOORD_1", kTwo));
  mesh.colors = read_colors(source);
  return mesh;
}

}  // namespace

std::optional<Mesh> read_primitive(Document& document, const JsonValue& primitive, const Pose& pose,
                                   Deformation* kept) {
  LoadContext& context = *document.context;
  AttributeSource source{document, primitive["attributes"], {}, 0, {}};
  const JsonValue position = source.attributes["POSITION"];
  if (!position) {
    context.warn(primitive.path() + " has no positions and is left out");
    return {};
  }
  if (const JsonValue draco = primitive["extensions"]["KHR_draco_mesh_compression"]) {
    source.packed = decode_draco(document, primitive, draco);
    source.vertices = source.packed->vertices;
  } else {
    source.vertices =
        describe_accessor(document, position.required_index(document.count("accessors"))).count;
  }

  Primitive kind = Primitive::triangles;
  std::vector<std::uint32_t> indices = read_corners(source, primitive, kind);
  if (indices.empty()) return {};
  use_only(source, indices);
  Mesh mesh = read_attributes(source, std::move(indices));
  mesh.primitive = kind;
  mesh.material = primitive["material"].index(document.count("materials"));
  if (kept) keep_deformation(source, primitive["targets"], pose, mesh, *kept);
  morph(source, primitive["targets"], pose.weights, mesh);
  if (!pose.model_from_joint.empty()) skin(source, pose.model_from_joint, mesh);

  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(mesh.positions[i][c]))
        primitive.fail("has a vertex whose position is not finite");
  if (repair_attributes(mesh) > 0)
    context.warn(primitive.path() + " has attributes that are not finite; they are replaced");

  // Section 3.7.2.1: without normals, flat ones are to be used (and tangents ignored).
  if (mesh.normals.empty() && kind == Primitive::triangles) {
    const std::uint64_t each = sizeof(glm::vec3) * 2 + (mesh.uv[0].empty() ? 0 : 8) +
                               (mesh.uv[1].empty() ? 0 : 8) + (mesh.colors.empty() ? 0 : 16);
    context.budget.take(mesh.indices.size(), each);
    if (kept) {
      context.budget.take(mesh.indices.size(), sizeof(std::uint32_t));
      kept->corners = mesh.indices;
    }
    make_flat(mesh);
  } else if (!mesh.normals.empty()) {
    repair_normals(mesh);
  }
  return mesh;
}

}  // namespace rilievo::gltf
