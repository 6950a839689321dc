// KHR_draco_mesh_compression: a primitive's triangles and attributes. Internal; throws LoadError.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "rilievo/scene/gltf/accessor.h"

namespace rilievo::gltf {

struct DracoAttribute {
  int numbers = 0;            // a vertex
  std::vector<float> values;  // integers normalised if the attribute's accessor says so
};

struct DracoMesh {
  std::uint32_t vertices = 0;
  std::vector<std::uint32_t> indices;  // a list of triangles, all less than `vertices`
  std::map<std::string, DracoAttribute> attributes;
};

// `extension` is the primitive's, `primitive` the primitive itself.
[[nodiscard]] DracoMesh decode_draco(Document& document, const JsonValue& primitive,
                                     const JsonValue& extension);

}  // namespace rilievo::gltf
