// Speeds: let a point be at most r from a node's origin, and at most s fast in the node's space.
// In the parent's, it is T + R S p:
//
//   r' <= |T| + |S| r,    s' <= |dT| + w |S| r + |dS| r + |S| s
//
// with w the node's angular speed. Between two keys of all curves, each of these has a greatest
// value that is known: constant speeds for linear curves, and for cubic splines the greatest
// coefficient of the derivative as a Bezier curve. A skinned point is a weighted mean of such
// points, and no faster than the fastest.
#include "rilievo/scene/bend.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "rilievo/core/expects.h"
#include "rilievo/core/linear_maps.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

float weight_at(const Deformation::Target& target, double time) {
  return target.weights.times.empty() ? target.weight : sample(target.weights, time).x;
}

template <int N>
void add(std::vector<glm::vec<N, float>>& to, const std::vector<glm::vec3>& by, float weight) {
  for (std::size_t i = 0; i < std::min(to.size(), by.size()); ++i)
    for (int c = 0; c < 3; ++c) to[i][c] += weight * by[i][c];
}

std::vector<glm::dmat4> joint_matrices(const Rig& rig, const Deformation& deformation,
                                       double time) {
  std::vector<glm::dmat4> scene_from_node(rig.nodes.size());
  pose_nodes(rig.nodes, rig.channels, time, scene_from_node);
  std::vector<glm::dmat4> matrices;
  for (const Deformation::Joint& joint : deformation.joints)
    matrices.push_back(scene_from_node[std::size_t(joint.node)] *
                       glm::dmat4(joint.joint_from_mesh));
  return matrices;
}

// The vertices at a time within the period.
void bend_mesh(const Rig& rig, const Deformation& from, double time, Mesh& mesh) {
  mesh.positions = from.positions, mesh.normals = from.normals, mesh.tangents = from.tangents;
  for (const Deformation::Target& target : from.targets) {
    const float weight = weight_at(target, time);
    if (weight == 0) continue;
    add(mesh.positions, target.positions, weight);
    add(mesh.normals, target.normals, weight);
    add(mesh.tangents, target.tangents, weight);
  }
  if (!from.joints.empty()) {
    const std::vector<glm::dmat4> joints = joint_matrices(rig, from, time);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      glm::dmat4 m(0.0);
      for (std::uint32_t k = from.first_influence[i]; k < from.first_influence[i + 1]; ++k)
        m += double(from.influences[k].weight) * joints[from.influences[k].joint];
      const glm::dmat3 linear(m);
      mesh.positions[i] = glm::vec3(m * glm::dvec4(mesh.positions[i], 1.0));
      if (!mesh.normals.empty())
        mesh.normals[i] = unit_or_none(normal_map(linear) * glm::dvec3(mesh.normals[i]));
      if (!mesh.tangents.empty())
        mesh.tangents[i] =
            glm::vec4(unit_or_up(linear * glm::dvec3(mesh.tangents[i])), mesh.tangents[i].w);
    }
  }
  if (from.corners.empty()) {
    if (!mesh.normals.empty()) repair_normals(mesh);
  } else {
    // The other attributes have a value for each corner already.
    Mesh flat;
    flat.positions = std::move(mesh.positions);
    flat.indices = from.corners;
    make_flat(flat);
    mesh.positions = std::move(flat.positions), mesh.normals = std::move(flat.normals);
  }
  update_bounds(mesh);
}

void update_models(Scene& scene) {
  for (Model& model : scene.models) {
    model.bounds = {};
    for (const Part& part : model.parts) {
      const Box& box = scene.meshes[std::size_t(part.mesh)].bounds;
      model.bounds.add(
          part.model_from_mesh == glm::mat4(1.0f) ? box : transformed(part.model_from_mesh, box));
    }
  }
}

// --- Bounds.

// A curve between two times without a key between them: its greatest value and its greatest speed.
struct CurveBounds {
  double most = 0, speed = 0;
};

bool is_rotation(const Channel& c) { return c.path == Channel::Path::rotation; }

// The greatest speed between keys k and k + 1; rotations: radians a second.
double speed_between(const Channel& c, std::size_t k) {
  const bool cubic = c.interpolation == Channel::Interpolation::cubic_spline;
  const auto value = [&](std::size_t key) {
    return glm::dvec4(c.values[cubic ? 3 * key + 1 : key]);
  };
  const double step = double(c.times[k + 1]) - double(c.times[k]);
  const glm::dvec4 a = value(k), b = value(k + 1);
  if (c.interpolation == Channel::Interpolation::step) return a == b ? 0 : kSteppedSpeed;
  if (!cubic) {
    if (!is_rotation(c)) return glm::length(b - a) / step;
    const double la = glm::length(a), lb = glm::length(b);
    if (!(la > 0 && lb > 0)) return kSteppedSpeed;
    // 1e-3: slerp in floats is not quite even, and mixes quaternions that are nearly the same.
    const double cosine = std::min(1.0, std::abs(glm::dot(a, b)) / (la * lb));
    return (2 * std::acos(cosine) + (a == b ? 0 : 1e-3)) / step;
  }
  // The derivative's Bezier coefficients: d out, 3 (b - a) - d out - d in, and in, over d.
  const glm::dvec4 out(c.values[3 * k + 2]), in(c.values[3 * (k + 1)]);
  const glm::dvec4 middle = (3.0 * (b - a) - step * (out + in)) / step;
  const double speed = std::max({glm::length(out), glm::length(middle), glm::length(in)});
  if (!is_rotation(c)) return speed;
  // Made unit afterwards: twice the speed over the length, which must not come near 0.
  const double least = std::min(glm::length(a), glm::length(b)) - 0.5 * speed * step;
  return least > 0.1 ? 2 * speed / least : kSteppedSpeed;
}

CurveBounds bounds_between(const Channel& c, double from, double to) {
  CurveBounds bounds;
  bounds.most =
      std::max(glm::length(glm::dvec4(sample(c, from))), glm::length(glm::dvec4(sample(c, to))));
  for (std::size_t k = 0; k + 1 < c.times.size(); ++k)
    if (double(c.times[k]) < to && double(c.times[k + 1]) > from)
      bounds.speed = std::max(bounds.speed, speed_between(c, k));
  bounds.most += 0.5 * bounds.speed * (to - from);
  return bounds;
}

// A node between two times.
struct NodeBounds {
  CurveBounds translation, scale;
  double turn = 0;  // radians a second
};

double longest(const glm::vec3& v) {
  return std::max({std::abs(double(v.x)), std::abs(double(v.y)), std::abs(double(v.z))});
}

std::vector<NodeBounds> bounds_of_nodes(const Rig& rig, double from, double to) {
  std::vector<NodeBounds> all(rig.nodes.size());
  for (std::size_t i = 0; i < rig.nodes.size(); ++i) {
    all[i].translation.most = glm::length(glm::dvec3(rig.nodes[i].translation));
    all[i].scale.most = longest(rig.nodes[i].scale);
  }
  for (const Channel& channel : rig.channels) {
    NodeBounds& node = all[std::size_t(channel.node)];
    const CurveBounds bounds = bounds_between(channel, from, to);
    if (channel.path == Channel::Path::translation)
      node.translation = bounds;
    else if (channel.path == Channel::Path::scale)
      node.scale = bounds;
    else
      node.turn = bounds.speed;
  }
  return all;
}

// How far a deformation's vertices are moved, at any time: by each target of weight 1, at most; and
// from the origin of each joint at most, before they are morphed, -1: it moves none.
struct DeformationReach {
  std::vector<double> targets, joints;
};

DeformationReach reach_of(const Deformation& deformation) {
  DeformationReach reach;
  for (const Deformation::Target& target : deformation.targets) {
    double& longest_way = reach.targets.emplace_back(0.0);
    for (const glm::vec3& way : target.positions)
      longest_way = std::max(longest_way, glm::length(glm::dvec3(way)));
  }
  reach.joints.assign(deformation.joints.size(), -1);
  if (deformation.joints.empty()) return reach;
  for (std::size_t i = 0; i < deformation.positions.size(); ++i)
    for (std::uint32_t k = deformation.first_influence[i]; k < deformation.first_influence[i + 1];
         ++k) {
      const std::uint32_t joint = deformation.influences[k].joint;
      const glm::dvec3 at(glm::dmat4(deformation.joints[joint].joint_from_mesh) *
                          glm::dvec4(deformation.positions[i], 1));
      reach.joints[joint] = std::max(reach.joints[joint], glm::length(at));
    }
  return reach;
}

// How far a deformation's vertices can be displaced by its targets, and how fast, at most.
CurveBounds bounds_of_targets(const Deformation& deformation, const DeformationReach& reach,
                              double from, double to) {
  CurveBounds sum;
  for (std::size_t i = 0; i < deformation.targets.size(); ++i) {
    const Deformation::Target& target = deformation.targets[i];
    CurveBounds weight{std::abs(double(target.weight)), 0};
    if (!target.weights.times.empty()) weight = bounds_between(target.weights, from, to);
    sum.most += weight.most * reach.targets[i], sum.speed += weight.speed * reach.targets[i];
  }
  return sum;
}

double speed_of(const Rig& rig, const Deformation& deformation, const DeformationReach& reach,
                double from, double to) {
  const CurveBounds targets = bounds_of_targets(deformation, reach, from, to);
  if (deformation.joints.empty()) return targets.speed;
  const std::vector<NodeBounds> nodes = bounds_of_nodes(rig, from, to);
  double fastest = 0;
  for (std::size_t j = 0; j < reach.joints.size(); ++j) {
    if (reach.joints[j] < 0) continue;
    const double into = stretch_at_most(deformation.joints[j].joint_from_mesh);
    double r = reach.joints[j] + into * targets.most, s = into * targets.speed;
    for (int n = deformation.joints[j].node; n >= 0; n = rig.nodes[std::size_t(n)].parent) {
      const NodeBounds& node = nodes[std::size_t(n)];
      s = node.translation.speed + (node.turn * node.scale.most + node.scale.speed) * r +
          node.scale.most * s;
      r = node.translation.most + node.scale.most * r;
    }
    fastest = std::max(fastest, s);
  }
  return std::min(fastest, kSteppedSpeed);
}

// Of the time between two keys; at most so many are looked at, several at once if there are more.
constexpr double kLongestStep = 1 / 30.0;
constexpr std::size_t kMostSteps = 256;

std::vector<double> times_of(const Rig& rig, const Deformation& deformation) {
  std::set<double> keys{0.0, double(rig.duration)};
  const auto add_keys = [&](const Channel& channel) {
    for (const float time : channel.times)
      if (time > 0 && time < rig.duration) keys.insert(double(time));
  };
  for (const Channel& channel : rig.channels) add_keys(channel);
  for (const Deformation::Target& target : deformation.targets) add_keys(target.weights);
  std::vector<double> times;
  double last = 0;
  for (const double key : keys) {
    // A file's keys can be years apart.
    const double pieces =
        std::clamp(std::ceil((key - last) / kLongestStep), 1.0, double(kMostSteps));
    for (int k = 1; k <= pieces && key > 0; ++k) times.push_back(last + (key - last) * k / pieces);
    last = key;
  }
  const std::size_t each = (times.size() + kMostSteps - 1) / kMostSteps;
  std::vector<double> thinned{0.0};
  for (std::size_t i = 0; i < times.size(); ++i)
    if ((i + 1) % std::max<std::size_t>(each, 1) == 0 || i + 1 == times.size())
      thinned.push_back(times[i]);
  return thinned;
}

void add_bounds(const Scene& scene, const Rig& rig, const Deformation& deformation,
                const glm::mat4& model_from_mesh, DeformationBounds& all) {
  const double scale = stretch_at_most(model_from_mesh);
  const std::vector<double> times = times_of(rig, deformation);
  const DeformationReach reach = reach_of(deformation);
  Mesh mesh = scene.meshes[std::size_t(deformation.mesh)];
  std::vector<glm::vec3> first;
  double half_way = 0;  // since the last time
  for (std::size_t i = 0; i < times.size(); ++i) {
    bend_mesh(rig, deformation, times[i], mesh);
    if (i == 0) first = mesh.positions;
    // From one time to the next, half of the way from either.
    Box box = transformed(model_from_mesh, mesh.bounds);
    const auto around = [&](double by) {
      Box grown = box;
      grown.min -= glm::vec3(float(by)), grown.max += glm::vec3(float(by));
      all.bounds.add(grown);
    };
    around(half_way);
    if (i + 1 == times.size()) break;
    const double speed = scale * speed_of(rig, deformation, reach, times[i], times[i + 1]);
    all.speed = std::max(all.speed, speed);
    half_way = 0.5 * std::min(speed, 1e6) * (times[i + 1] - times[i]);
    around(half_way);
  }
  for (std::size_t i = 0; i < first.size(); ++i)
    all.jump = std::max(all.jump,
                        scale * glm::length(glm::dvec3(mesh.positions[i]) - glm::dvec3(first[i])));
}

}  // namespace

void bend(const Deformations& deformations, double time, Scene& scene) {
  if (deformations.meshes.empty()) return;
  const double within = repeated(time, double(deformations.rig.duration));
  for (const Deformation& deformation : deformations.meshes)
    bend_mesh(deformations.rig, deformation, within, scene.meshes[std::size_t(deformation.mesh)]);
  update_models(scene);
}

Scene pose_at(const Scene& scene, const Deformations& deformations, double time) {
  Scene bent = scene;
  bend(deformations, time, bent);
  return bent;
}

std::vector<DeformationBounds> deformation_bounds(const Scene& scene,
                                                  const Deformations& deformations) {
  std::vector<DeformationBounds> all;
  for (const Model& model : scene.models) {
    DeformationBounds& one = all.emplace_back();
    one.bounds = model.bounds;
    for (const Part& part : model.parts)
      for (const Deformation& deformation : deformations.meshes)
        if (deformation.mesh == part.mesh)
          add_bounds(scene, deformations.rig, deformation, part.model_from_mesh, one);
    if (one.speed > 0) one.period = double(deformations.rig.duration);
  }
  return all;
}

// The square root of the greatest eigenvalue of A^T A, which is not above the greatest sum of a
// row.
double stretch_at_most(const glm::mat4& m) {
  const glm::dmat3 linear(m), square = glm::transpose(linear) * linear;
  double most = 0;
  for (int k = 0; k < 3; ++k)
    most = std::max(most, std::abs(square[k].x) + std::abs(square[k].y) + std::abs(square[k].z));
  return std::sqrt(most);
}

}  // namespace rilievo
