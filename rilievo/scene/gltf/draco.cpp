#include "rilievo/scene/gltf/draco.h"

#include <draco/compression/decode.h>

#include <algorithm>
#include <limits>

namespace rilievo::gltf {
namespace {

// Reads the first numbers of a Draco stream, so that what it announces can be held against the
// budget before the decoder allocates it. A stream that ends early yields zeros: the decoder will
// say what is wrong with it.
class StreamHead {
 public:
  explicit StreamHead(Bytes bytes) : left_(bytes) {}

  std::uint64_t fixed(std::size_t bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes && i < left_.size(); ++i)
      value |= std::uint64_t(left_[i]) << 8 * i;
    skip(bytes);
    return value;
  }
  // Seven bits a byte, lowest first; the eighth says that more follow.
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 63; shift += 7) {
      const std::uint64_t byte = fixed(1);
      value |= (byte & 0x7F) << shift;
      if (!(byte & 0x80)) break;
    }
    return value;
  }
  void skip(std::uint64_t bytes) {
    left_ = left_.subspan(std::min<std::uint64_t>(bytes, left_.size()));
  }
  [[nodiscard]] bool ended() const { return left_.empty(); }

 private:
  Bytes left_;
};

// One element of metadata: entries, each a name and a value; then others within it, each a name and
// an element.
void skip_metadata(StreamHead& head) {
  std::uint64_t elements = 1;
  for (bool first = true; elements > 0 && !head.ended(); --elements, first = false) {
    if (!first) head.skip(head.fixed(1));
    for (std::uint64_t entries = head.varint(); entries > 0 && !head.ended(); --entries) {
      head.skip(head.fixed(1));
      head.skip(head.varint());
    }
    elements += std::min<std::uint64_t>(head.varint(), 1u << 30);
  }
}

// Draco's bitstream specification, sections 3 to 5: header, metadata, connectivity.
void check_announced_size(Bytes packed, MemoryBudget& budget) {
  StreamHead head(packed);
  head.skip(5);  // "DRACO"
  const std::uint64_t major = head.fixed(1), version = major << 8 | head.fixed(1);
  head.skip(1);  // the kind of geometry
  const bool edge_breaker = head.fixed(1) == 1;
  const bool metadata = head.fixed(2) & 0x8000;
  if (metadata) {
    for (std::uint64_t n = head.varint(); n > 0 && !head.ended(); --n) {
      (void)head.varint();  // an attribute, then what is said of it
      skip_metadata(head);
    }
    skip_metadata(head);
  }
  const auto number = [&] { return version < 0x200 ? head.fixed(4) : head.varint(); };
  if (edge_breaker) {
    head.skip(1);  // the way of traversal
    if (version < 0x202) (void)number();
  }
  const std::uint64_t a = number(), b = number();
  const std::uint64_t faces = edge_breaker ? b : a, vertices = edge_breaker ? a : b;
  const std::uint64_t seams =
      edge_breaker ? head.fixed(1) : 0;  // attributes with seams of their own
  // Three indices a face, and at least a position a vertex.
  constexpr std::uint64_t kMaxCount = std::uint64_t(1) << 40;
  budget.earn_decompressed(packed.size(),
                           12 * std::min(faces, kMaxCount) + 12 * std::min(vertices, kMaxCount));
  // The decoder keeps a table of corners and neighbours, another for each kind of seams, and the
  // attributes in several forms. Measured: 58 bytes a face and kind of seams.
  budget.borrow(faces, 100 + 64 * seams);
  budget.borrow(vertices, 100);
}

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
  check_announced_size(packed, document.context->budget);
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
