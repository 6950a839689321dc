#include "rilievo/scene/gltf/skin.h"

#include <array>
#include <string>

#include "rilievo/scene/mesh_tools.h"

namespace rilievo::gltf {
namespace {

template <int N>
void displace(const Attribute& by, float weight, std::vector<glm::vec<N, float>>& values) {
  if (by.values.empty()) return;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (int c = 0; c < 3; ++c) values[i][c] += weight * by.values[3 * i + c];
}

// Normals keep at right angles to their surface under the inverse transpose, which is the cofactor
// matrix divided by the determinant: only its sign matters, for the result is made unit later.
glm::dmat3 normal_matrix(const glm::dmat3& m) {
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]),
                             glm::cross(m[0], m[1]));
  return glm::dot(m[0], cofactors[0]) < 0 ? -cofactors : cofactors;
}

}  // namespace

void morph(const AttributeSource& source, const JsonValue& targets, std::span<const float> weights,
           Mesh& mesh) {
  constexpr std::array kThree{3};
  for (std::size_t t = 0; t < std::min(targets.size(), weights.size()); ++t) {
    if (weights[t] == 0.0f) continue;
    const AttributeSource target{source.document, targets[t], {}, source.vertices, source.used};
    displace(read_attribute(target, "POSITION", kThree), weights[t], mesh.positions);
    displace(read_attribute(target, "NORMAL", kThree), weights[t], mesh.normals);
    displace(read_attribute(target, "TANGENT", kThree), weights[t], mesh.tangents);
  }
}

void skin(const AttributeSource& source, std::span<const glm::dmat4> model_from_joint, Mesh& mesh) {
  constexpr std::array kFour{4};
  const std::size_t n = mesh.positions.size();
  std::vector<glm::dmat4> sum(n, glm::dmat4(0.0));
  std::vector<double> total(n, 0.0);
  source.document.context->budget.borrow(n, sizeof(glm::dmat4) + sizeof(double));
  for (int set = 0;; ++set) {
    const std::string joints_name = "JOINTS_" + std::to_string(set);
    const std::string weights_name = "WEIGHTS_" + std::to_string(set);
    const Attribute joints = read_attribute(source, joints_name.c_str(), kFour);
    const Attribute weights = read_attribute(source, weights_name.c_str(), kFour);
    if (joints.values.empty() || weights.values.empty()) break;
    for (std::size_t i = 0; i < 4 * n; ++i) {
      const float joint = joints.values[i], weight = weights.values[i];
      if (!(weight > 0.0f)) continue;  // exporters leave anything in joints without weight
      if (!(joint >= 0.0f && joint < float(model_from_joint.size())))
        source.attributes[joints_name.c_str()].fail("names a joint that the skin does not have");
      sum[i / 4] += double(weight) * model_from_joint[std::size_t(joint)];
      total[i / 4] += double(weight);
    }
  }

  std::size_t mirrored = 0;
  for (std::size_t i = 0; i < n; ++i) {
    // Weights that do not add up to one are a fault that dividing remedies; a vertex without any
    // goes with the first joint.
    const glm::dmat4 m = total[i] > 0 ? sum[i] / total[i] : model_from_joint[0];
    const glm::dmat3 linear(m);
    mesh.positions[i] = glm::vec3(m * glm::dvec4(mesh.positions[i], 1.0));
    if (!mesh.normals.empty())
      mesh.normals[i] =
          glm::vec3(glm::normalize(normal_matrix(linear) * glm::dvec3(mesh.normals[i])));
    if (!mesh.tangents.empty())
      mesh.tangents[i] =
          glm::vec4(glm::normalize(linear * glm::dvec3(mesh.tangents[i])), mesh.tangents[i].w);
    if (glm::determinant(linear) < 0) ++mirrored;
  }
  // A skeleton that is mirrored as a whole turns the mesh inside out.
  if (2 * mirrored > n) flip_winding(mesh);
}

}  // namespace rilievo::gltf
