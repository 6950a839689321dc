// Morph targets and skins, applied to vertices once, and kept to be applied at other times.
// Internal; throws LoadError.
#pragma once

#include "rilievo/scene/bend.h"
#include "rilievo/scene/gltf/attributes.h"
#include "rilievo/scene/gltf/mesh.h"
#include "rilievo/scene/scene.h"

namespace rilievo::gltf {

// Adds weight times displacement of every target to positions, normals and tangents. Missing
// weights are 0.
void morph(const AttributeSource& source, const JsonValue& targets, std::span<const float> weights,
           Mesh& mesh);

// Moves every vertex by the weighted mean of its joints' matrices, after which it is in the space
// they lead to.
void skin(const AttributeSource& source, std::span<const glm::dmat4> model_from_joint, Mesh& mesh);

// What the two above would bend `mesh` by, and its vertices before. Curves and the skin's matrices
// are not the primitive's: they are left out.
void keep_deformation(const AttributeSource& source, const JsonValue& targets, const Pose& pose,
                      const Mesh& mesh, Deformation& to);

}  // namespace rilievo::gltf
