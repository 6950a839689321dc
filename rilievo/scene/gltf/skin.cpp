#include "rilievo/scene/gltf/skin.h"

#include <array>
#include <string>
#include <vector>

#include "rilievo/core/linear_maps.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo::gltf {
namespace {

template <int N>
void displace(const Attribute& by, float weight, std::vector<glm::vec<N, float>>& values) {
  if (by.values.empty()) return;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (int c = 0; c < 3; ++c) values[i][c] += weight * by.values[3 * i + c];
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

namespace {

// Calls use(vertex, joint, weight) for each weight above 0.
template <class Use>
void for_influences(const AttributeSource& source, std::size_t vertices, std::size_t skin_joints,
                    Use&& use) {
  constexpr std::array kFour{4};
  for (int set = 0;; ++set) {
    const std::string joints_name = "JOINTS_" + std::to_string(set);
    const std::string weights_name = "WEIGHTS_" + std::to_string(set);
    const Attribute joints = read_attribute(source, joints_name.c_str(), kFour);
    const Attribute weights = read_attribute(source, weights_name.c_str(), kFour);
    if (joints.values.empty() || weights.values.empty()) break;
    for (std::size_t i = 0; i < 4 * vertices; ++i) {
      const float joint = joints.values[i], weight = weights.values[i];
      if (!(weight > 0.0f)) continue;  // exporters leave anything in joints without weight
      if (!(joint >= 0.0f && joint < float(skin_joints)))
        source.attributes[joints_name.c_str()].fail("names a joint that the skin does not have");
      use(i / 4, std::uint32_t(joint), weight);
    }
  }
}

std::vector<glm::vec3> displacements(const Attribute& from) {
  std::vector<glm::vec3> out(from.values.size() / 3);
  for (std::size_t i = 0; i < 3 * out.size(); ++i) out[i / 3][int(i % 3)] = from.values[i];
  return out;
}

}  // namespace

void keep_deformation(const AttributeSource& source, const JsonValue& targets, const Pose& pose,
                      const Mesh& mesh, Deformation& to) {
  constexpr std::array kThree{3};
  MemoryBudget& budget = source.document.context->budget;
  const std::size_t n = mesh.positions.size();
  budget.take(n, 40 * (1 + targets.size()));
  to.positions = mesh.positions, to.normals = mesh.normals, to.tangents = mesh.tangents;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const AttributeSource from{source.document, targets[t], {}, source.vertices, source.used};
    Deformation::Target& target = to.targets.emplace_back();
    target.positions = displacements(read_attribute(from, "POSITION", kThree));
    target.normals = displacements(read_attribute(from, "NORMAL", kThree));
    target.tangents = displacements(read_attribute(from, "TANGENT", kThree));
    if (t < pose.weights.size()) target.weight = pose.weights[t];
  }
  if (pose.model_from_joint.empty()) return;

  std::vector<std::vector<Deformation::Influence>> of(n);
  budget.borrow(n, sizeof(of[0]) + 4 * sizeof(Deformation::Influence));
  const std::size_t joints = pose.model_from_joint.size();
  for_influences(source, n, joints, [&](std::size_t vertex, std::uint32_t joint, float weight) {
    of[vertex].push_back({joint, weight});
  });
  std::size_t count = 0;
  for (auto& influences : of) {
    // As skin() has it: weights are divided by their sum, and without any, the first joint's.
    if (influences.empty()) influences.push_back({0, 1});
    double sum = 0;
    for (const auto& influence : influences) sum += double(influence.weight);
    for (auto& influence : influences) influence.weight = float(double(influence.weight) / sum);
    count += influences.size();
  }
  budget.take(n + 1, sizeof(std::uint32_t));
  budget.take(count, sizeof(Deformation::Influence));
  to.influences.reserve(count);
  for (const auto& influences : of) {
    to.first_influence.push_back(std::uint32_t(to.influences.size()));
    to.influences.insert(to.influences.end(), influences.begin(), influences.end());
  }
  to.first_influence.push_back(std::uint32_t(count));
}

void skin(const AttributeSource& source, std::span<const glm::dmat4> model_from_joint, Mesh& mesh) {
  const std::size_t n = mesh.positions.size();
  std::vector<glm::dmat4> sum(n, glm::dmat4(0.0));
  std::vector<double> total(n, 0.0);
  source.document.context->budget.borrow(n, sizeof(glm::dmat4) + sizeof(double));
  for_influences(source, n, model_from_joint.size(),
                 [&](std::size_t vertex, std::uint32_t joint, float weight) {
                   sum[vertex] += double(weight) * model_from_joint[joint];
                   total[vertex] += double(weight);
                 });

  std::size_t mirrored = 0;
  for (std::size_t i = 0; i < n; ++i) {
    // Weights that do not add up to one are a fault that dividing remedies; a vertex without any
    // goes with the first joint.
    const glm::dmat4 m = total[i] > 0 ? sum[i] / total[i] : model_from_joint[0];
    const glm::dmat3 linear(m);
    mesh.positions[i] = glm::vec3(m * glm::dvec4(mesh.positions[i], 1.0));
    if (!mesh.normals.empty())
      mesh.normals[i] = unit_or_none(normal_map(linear) * glm::dvec3(mesh.normals[i]));
    if (!mesh.tangents.empty())
      mesh.tangents[i] =
          glm::vec4(unit_or_up(linear * glm::dvec3(mesh.tangents[i])), mesh.tangents[i].w);
    if (is_mirroring(linear)) ++mirrored;
  }
  // A skeleton that is mirrored as a whole turns the mesh inside out.
  if (2 * mirrored > n) flip_winding(mesh);
}

}  // namespace rilievo::gltf
