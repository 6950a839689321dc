#include "rilievo/scene/gltf_draco.h"

#include <draco/compression/decode.h>

#include <limits>

namespace rilievo::gltf {
namespace {

// Values of a vertex attribute as floats: what `accessor` calls integers may be normalised.
std::vector<float> values_of(const draco::PointAttribute& from, std::uint32_t vertices,
                             const Accessor& accessor, const JsonValue& where) {
  const bool floats =
      from.data_type() == draco::DT_FLOAT32 || from.data_type() == draco::DT_FLOAT64;
  const int numbers = from.num_components();
  std::vector<float> out(std::size_t(vertices) * numbers);
  std::vector<std::int64_t> integers(numbers);
  for (std::uint32_t p = 0; p < vertices; ++p) {
    const draco::AttributeValueIndex at = from.mapped_index(draco::PointIndex(p));
    if (at.value() >= from.size()) where.fail("is damaged: a vertex has no value");
    float* const to = &out[std::size_t(p) * numbers];
    if (floats) {
      if (!from.ConvertValue<float>(at, std::int8_t(numbers), to))
        where.fail("has an attribute of an unknown type");
      continue;
    }
    if (!from.ConvertValue<std::int64_t>(at, std::int8_t(numbers), integers.data()))
      where.fail("has an attribute of an unknown type");
    for (int c = 0; c < numbers; ++c)
      to[c] = accessor.normalized ? normalized_from(accessor.component, double(integers[c]))
                                  : float(integers[c]);
  }
  return out;
}

}  // namespace

DracoMesh decode_draco(Document& document, const JsonValue& primitive, const JsonValue& extension) {
  const Bytes packed =
      read_view(document, extension["bufferView"].required_index(document.count("bufferViews")));
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
  const auto kind = draco::Decoder::GetEncodedGeometryType(&buffer);
  if (!kind.ok() || kind.value() != draco::TRIANGULAR_MESH)
    extension.fail("does not hold a Draco mesh");
  buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok())
    extension.fail("cannot be decompressed: " + decoded.status().error_msg_string());
  const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();

  DracoMesh out;
  out.vertices = mesh->num_points();
  document.context->budget.take(mesh->num_faces(), 3 * sizeof(std::uint32_t));
  out.indices.reserve(std::size_t(mesh->num_faces()) * 3);
  for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f)
    for (const draco::PointIndex& p : mesh->face(f)) {
      if (p.value() >= out.vertices) extension.fail("is damaged: a face has no vertex");
      out.indices.push_back(p.value());
    }

  const JsonValue accessors = primitive["attributes"];
  extension["attributes"].each_member([&](const std::string& name, const JsonValue& id) {
    const std::uint64_t unique = id.whole();
    const draco::PointAttribute* const from =
        unique <= std::numeric_limits<std::uint32_t>::max()
            ? mesh->GetAttributeByUniqueId(std::uint32_t(unique))
            : nullptr;
    if (!from) id.fail("names an attribute that the stream does not have");
    if (from->num_components() < 1 || from->num_components() > 4)
      id.fail("names an attribute with more than 4 numbers a vertex");
    const JsonValue described = accessors[name.c_str()];
    if (!described) id.fail("names an attribute that the primitive does not have");
    const Accessor accessor =
        describe_accessor(document, described.required_index(document.count("accessors")));
    document.context->budget.take(out.vertices, from->num_components() * sizeof(float));
    out.attributes[name] = {from->num_components(), values_of(*from, out.vertices, accessor, id)};
  });
  return out;
}

}  // namespace rilievo::gltf
