#include "rilievo/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "rilievo/scene/move_points.h"

namespace rilievo {
namespace {

Box placed_bounds(const Mesh& mesh, const glm::mat4& to_from_mesh) {
  if (mesh.width > 0) return transformed(to_from_mesh, mesh.bounds);  // discs have no corners
  Box box;
  for (std::uint32_t i : mesh.indices)
    if (i < mesh.positions.size()) box.add(to_from_mesh * glm::vec4(mesh.positions[i], 1.0f));
  return box;
}

bool valid_index(int i, std::size_t size) { return i >= 0 && std::size_t(i) < size; }

// Does the curve ever leave its first value?
bool moves(const Channel& channel) {
  if (channel.times.size() < 2 || channel.values.empty()) return false;
  const bool cubic = channel.interpolation == Channel::Interpolation::cubic_spline;
  for (std::size_t i = 0; i < channel.values.size(); ++i) {
    const bool tangent = cubic && i % 3 != 1;
    const glm::vec4& rest = tangent ? glm::vec4(0.0f) : channel.values[cubic ? 1 : 0];
    if (channel.values[i] != rest) return true;
  }
  return false;
}

}  // namespace

glm::mat4 relative_to(const glm::dvec3& origin, const glm::mat4& world_from_model) {
  glm::mat4 m = world_from_model;
  m[3] = glm::vec4(glm::vec3(glm::dvec3(world_from_model[3]) - origin), 1.0f);
  return m;
}

void set_origin(Scene& scene, const glm::dvec3& origin) {
  const glm::dvec3 by = scene.world.origin - origin;
  const auto move = [&by](auto& point) {
    using Point = std::remove_reference_t<decltype(point)>;
    point = Point(glm::dvec3(point) + by);
  };
  scene.world.origin = origin;
  for (Object& object : scene.objects)
    if (object.node < 0)
      object.placement[3] = glm::vec4(glm::dvec4(object.placement[3]) + glm::dvec4(by, 0));
  for (Node& node : scene.nodes)
    if (node.parent < 0) move(node.translation);
  for (Channel& channel : scene.channels)
    if (channel.path == Channel::Path::translation &&
        scene.nodes[std::size_t(channel.node)].parent < 0)
      move_points(channel, by);
  for (Light& light : scene.lights)
    if (light.kind != Light::Kind::directional) move(light.position);
  for (Camera& camera : scene.cameras) camera.world_from_eye[3] += glm::dvec4(by, 0);
}

std::uint64_t count_triangles(const Scene& scene) {
  std::uint64_t triangles = 0;
  for (const Object& object : scene.objects) triangles += scene.models[object.model].triangles;
  return triangles;
}

Box world_bounds(const Scene& scene, double time) {
  std::vector<glm::mat4> world_from_model;
  pose(scene, time, world_from_model);
  Box box;
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    box.add(transformed(world_from_model[i], scene.models[scene.objects[i].model].bounds));
  return box;
}

void update_bounds(Mesh& mesh) {
  mesh.bounds = {};
  mesh.run_bounds.clear();
  const std::size_t step = std::size_t(corners_of(mesh.primitive)) * Mesh::kRun;
  for (std::size_t first = 0; first < mesh.indices.size(); first += step) {
    Box& run = mesh.run_bounds.emplace_back();
    const std::size_t end = std::min<std::size_t>(mesh.indices.size(), first + step);
    for (std::size_t k = first; k < end; ++k)
      if (mesh.indices[k] < mesh.positions.size())  // validate() is who complains
        run.add(mesh.positions[mesh.indices[k]]);
    if (mesh.primitive == Primitive::points && !run.empty())
      run.min -= 0.5f * mesh.width, run.max += 0.5f * mesh.width;
    mesh.bounds.add(run);
  }
}

void finish(Scene& scene) {
  for (Mesh& mesh : scene.meshes) update_bounds(mesh);

  for (Model& model : scene.models) {
    model.bounds = {};
    model.triangles = 0;
    for (const Part& part : model.parts) {
      if (!valid_index(part.mesh, scene.meshes.size())) continue;
      const Mesh& mesh = scene.meshes[part.mesh];
      model.triangles += mesh.primitives();
      model.bounds.add(part.model_from_mesh == glm::mat4(1.0f)
                           ? mesh.bounds
                           : placed_bounds(mesh, part.model_from_mesh));
    }
  }

  // A node moves if a channel of its own or of an ancestor does; parents come first.
  std::vector<char> node_moves(scene.nodes.size(), 0);
  for (const Channel& channel : scene.channels)
    if (valid_index(channel.node, scene.nodes.size()) && moves(channel))
      node_moves[channel.node] = 1;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i)
    if (valid_index(scene.nodes[i].parent, i) && node_moves[scene.nodes[i].parent])
      node_moves[i] = 1;
  for (Object& object : scene.objects)
    object.moving = valid_index(object.node, scene.nodes.size()) && node_moves[object.node];
}

double smallest_stretch(const glm::mat4& m) {
  const glm::dmat3 linear(m);
  const glm::dmat3 inverse = glm::inverse(linear);
  // The inverse stretches most where this stretches least: the norm is bounded by its rows' sums.
  const glm::dmat3 gram = glm::transpose(inverse) * inverse;
  double most = 0;
  for (int c = 0; c < 3; ++c)
    most = std::max(most, std::abs(gram[c].x) + std::abs(gram[c].y) + std::abs(gram[c].z));
  return std::isfinite(most) && most > 0 ? 1 / std::sqrt(most) : 0;
}

Light default_sun() {
  Light sun;
  sun.direction = glm::normalize(glm::vec3(-0.45f, -0.8f, -0.4f));
  sun.intensity = glm::vec3(3.0f, 2.85f, 2.6f);
  return sun;
}

}  // namespace rilievo
