// A primitive's vertex attributes, for the vertices that it uses. Internal.
//
// Exporters let many primitives share one large accessor: only what is used is read, so that the
// cost follows the triangles and not the accessors.
#pragma once

#include <optional>
#include <vector>

#include "rilievo/scene/gltf/draco.h"
#include "rilievo/scene/scene.h"

namespace rilievo::gltf {

struct AttributeSource {
  Document& document;
  JsonValue attributes;             // the primitive's: name -> accessor
  std::optional<DracoMesh> packed;  // attributes found here come from the compressed stream
  std::uint64_t vertices = 0;       // that every attribute must have
  std::vector<std::uint32_t> used;  // those to read, ascending; empty: all

  [[nodiscard]] std::uint64_t count() const { return used.empty() ? vertices : used.size(); }
};

struct Attribute {
  int numbers = 0;  // a vertex
  Component component = Component::float32;
  bool normalized = false;
  std::vector<float> values;  // empty: the primitive does not have it
};

// `allowed`: the numbers a vertex may have.
[[nodiscard]] Attribute read_attribute(const AttributeSource& source, const char* name,
                                       std::span<const int> allowed);

// The corners of whole triangles, lines or points, and which of these they are.
[[nodiscard]] std::vector<std::uint32_t> read_corners(AttributeSource& source,
                                                      const JsonValue& primitive, Primitive& kind);

// Sets source.used to what `indices` refer to, and lets them refer to its elements.
void use_only(AttributeSource& source, std::vector<std::uint32_t>& indices);

}  // namespace rilievo::gltf
