// Morph targets and skins, applied to vertices once. Internal; throws LoadError.
#pragma once

#include "rilievo/scene/gltf/attributes.h"
#include "rilievo/scene/scene.h"

namespace rilievo::gltf {

// Adds weight times displacement of every target to positions, normals and tangents. Missing
// weights are 0.
void morph(const AttributeSource& source, const JsonValue& targets, std::span<const float> weights,
           Mesh& mesh);

// Moves every vertex by the weighted mean of its joints' matrices, after which it is in the space
// they lead to.
void skin(const AttributeSource& source, std::span<const glm::dmat4> model_from_joint, Mesh& mesh);

}  // namespace rilievo::gltf
