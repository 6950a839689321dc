// Triangles, lines or points of one glTF primitive, morphed and skinned. Internal; throws
// LoadError.
#pragma once

#include <optional>
#include <vector>

#include "rilievo/scene/bend.h"
#include "rilievo/scene/gltf/document.h"
#include "rilievo/scene/scene.h"

namespace rilievo::gltf {

// How a mesh is bent before it is placed.
struct Pose {
  std::vector<float> weights;                // of the morph targets
  std::vector<glm::dmat4> model_from_joint;  // skinned: inverse bind matrix included; else empty
};

// The primitive as a mesh, posed, with normals if it has triangles; its material is still glTF's
// index. Nothing if it shows nothing. `kept`: null, or to where the
// vertices, morph targets and influences that bend it go.
[[nodiscard]] std::optional<Mesh> read_primitive(Document& document, const JsonValue& primitive,
                                                 const Pose& pose, Deformation* kept = nullptr);

}  // namespace rilievo::gltf
