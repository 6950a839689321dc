#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>

#include "rilievo/scene/gltf/glb_writer.h"
#include "rilievo/scene/gltf/nodes.h"
#include "rilievo/scene/scene.h"

namespace rilievo {
namespace {

// From so many places on, a model that stands still is written as instances of one node: 40 bytes
// a place instead of 250. Few programs know the extension, so that it must be worth it.
constexpr std::size_t kInstances = 256;

template <class Matrix>
GlbJson matrix_json(const Matrix& m) {
  GlbJson out = GlbJson::array();
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) out.push_back(m[c][r]);
  return out;
}

GlbJson node_json(const Node& n) {
  const glm::quat q = glm::normalize(n.rotation);
  return {{"translation", {n.translation.x, n.translation.y, n.translation.z}},
          {"rotation", {q.x, q.y, q.z, q.w}},
          {"scale", {n.scale.x, n.scale.y, n.scale.z}}};
}

// glTF has no sheared nodes: a shear is a stretch along turned axes, which takes two.
std::vector<Node> sheared_nodes(const glm::mat4& placement) {
  gltf::TreeNode tree;
  tree.has_matrix = true;
  tree.parent_from_node = glm::dmat4(placement);
  std::vector<Node> nodes;
  (void)gltf::append_node(tree, -1, nodes);
  return nodes;
}

struct Placement {
  glm::vec3 translation, scale;
  glm::quat rotation;
};

// Nothing if the matrix has a shear, or no volume.
std::optional<Placement> decompose(const glm::mat4& m) {
  Placement p;
  glm::mat3 axes(m);
  const float turn = glm::determinant(axes) < 0 ? -1.0f : 1.0f;
  for (int k = 0; k < 3; ++k) {
    p.scale[k] = (k == 0 ? turn : 1.0f) * glm::length(axes[k]);
    if (!(std::abs(p.scale[k]) > 0)) return {};
    axes[k] /= p.scale[k];
  }
  p.translation = glm::vec3(m[3]);
  p.rotation = glm::normalize(glm::quat_cast(axes));
  // 1e-5: some roundings of floats; a shear worth drawing is larger.
  const glm::mat3 again = glm::mat3_cast(p.rotation);
  for (int k = 0; k < 3; ++k)
    if (glm::length(again[k] - axes[k]) > 1e-5f) return {};
  return p;
}

GlbJson instances_json(GlbWriter& writer, const std::vector<Placement>& places) {
  std::vector<float> translations, rotations, scales;
  for (const Placement& p : places) {
    const glm::quat& q = p.rotation;
    translations.insert(translations.end(), {p.translation.x, p.translation.y, p.translation.z});
    rotations.insert(rotations.end(), {q.x, q.y, q.z, q.w});
    scales.insert(scales.end(), {p.scale.x, p.scale.y, p.scale.z});
  }
  return {{"TRANSLATION", writer.add_owned_floats(std::move(translations), 3, false)},
          {"ROTATION", writer.add_owned_floats(std::move(rotations), 4, false)},
          {"SCALE", writer.add_owned_floats(std::move(scales), 3, false)}};
}

// A node that looks along -z in `direction`.
GlbJson light_node(GlbWriter& writer, const Light& light) {
  constexpr const char* kKinds[] = {"directional", "point", "spot"};
  const float strength = std::max({light.intensity.r, light.intensity.g, light.intensity.b, 1e-9f});
  const glm::vec3 color = light.intensity / strength;
  GlbJson out{{"type", kKinds[int(light.kind)]},
              {"color", {color.r, color.g, color.b}},
              {"intensity", strength}};
  if (light.range > 0) out["range"] = light.range;
  if (light.kind == Light::Kind::spot)
    out["spot"] = {{"innerConeAngle", light.inner_cone}, {"outerConeAngle", light.outer_cone}};
  writer.use_extension("KHR_lights_punctual");
  GlbJson& lights = writer.json["extensions"]["KHR_lights_punctual"]["lights"];
  lights.push_back(std::move(out));
  const glm::dvec3 at(light.position);
  const Camera pose = look_at(at, at + glm::dvec3(light.direction), {0, 1, 0}, 1, 1, 1, 1, 2);
  return {{"matrix", matrix_json(pose.world_from_eye)},
          {"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}};
}

// Nothing for cameras that glTF cannot describe.
std::optional<GlbJson> camera_node(GlbWriter& writer, const Camera& camera) {
  const ImageWindow& w = camera.window;
  // 1e-9: rounding of doubles.
  const bool centred = std::abs(w.left + w.right) <= 1e-9 * (w.right - w.left) &&
                       std::abs(w.bottom + w.top) <= 1e-9 * (w.top - w.bottom);
  if (!centred || camera.projection == Projection::back_perspective) return {};
  const bool parallel = camera.projection == Projection::parallel;
  const char* kind = parallel ? "orthographic" : "perspective";
  GlbJson lens{{"znear", camera.z_near}, {"zfar", camera.z_far}};
  if (parallel)
    lens["xmag"] = w.right, lens["ymag"] = w.top;
  else
    lens["yfov"] = 2 * std::atan(w.top), lens["aspectRatio"] = w.right / w.top;
  const int index = writer.add("cameras", {{"type", kind}, {kind, lens}});
  return GlbJson{{"matrix", matrix_json(camera.world_from_eye)}, {"camera", index}};
}

}  // namespace

std::vector<int> add_glb_nodes(GlbWriter& writer, const Scene& scene,
                               std::span<const int> mesh_of_model) {
  std::vector<int> roots;
  const auto add = [&](GlbJson node, int parent) {
    const int i = writer.add("nodes", std::move(node));
    if (parent < 0)
      roots.push_back(i);
    else
      writer.json["nodes"][std::size_t(parent)]["children"].push_back(i);
    return i;
  };

  for (const Node& n : scene.nodes) add(node_json(n), n.parent);

  // Where each model stands still, if that is many places.
  std::map<int, std::vector<Placement>> standing;
  for (const Object& object : scene.objects) {
    if (object.node >= 0) continue;
    if (const std::optional<Placement> p = decompose(object.placement))
      standing[object.model].push_back(*p);
  }
  std::erase_if(standing, [](const auto& places) { return places.second.size() < kInstances; });

  for (const Object& object : scene.objects) {
    const int mesh = mesh_of_model[std::size_t(object.model)];
    if (mesh < 0) continue;
    GlbJson node;
    int parent = object.node;
    if (!object.name.empty()) node["name"] = object.name;
    node["mesh"] = mesh;
    const auto group = standing.find(object.model);
    const std::optional<Placement> place = decompose(object.placement);
    if (group != standing.end() && object.node < 0 && place) {
      // The first of them stands for all.
      if (group->second.empty()) continue;
      writer.use_extension("EXT_mesh_gpu_instancing", true);
      node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] =
          instances_json(writer, group->second);
      group->second.clear();
    } else if (place) {
      if (object.placement != glm::mat4(1.0f)) node["matrix"] = matrix_json(object.placement);
    } else {
      std::vector<Node> nodes = sheared_nodes(object.placement);
      if (nodes.size() > 1) parent = add(node_json(nodes[0]), parent);
      node.update(node_json(nodes.back()));
    }
    add(std::move(node), parent);
  }
  for (const Light& light : scene.lights) add(light_node(writer, light), -1);
  for (const Camera& camera : scene.cameras)
    if (std::optional<GlbJson> node = camera_node(writer, camera)) add(std::move(*node), -1);
  const glm::dvec3& origin = scene.world.origin;
  if (origin == glm::dvec3(0)) return roots;
  // Numbers in JSON are doubles, those in buffers are not.
  const int all = writer.add(
      "nodes",
      {{"name", "origin"}, {"translation", {origin.x, origin.y, origin.z}}, {"children", roots}});
  return {all};
}

void add_glb_animation(GlbWriter& writer, const Scene& scene) {
  constexpr const char* kPaths[] = {"translation", "rotation", "scale"};
  constexpr const char* kCurves[] = {"STEP", "LINEAR", "CUBICSPLINE"};
  float last = 0;
  for (const Channel& channel : scene.channels) last = std::max(last, channel.times.back());
  GlbJson channels = GlbJson::array(), samplers = GlbJson::array();
  for (const Channel& channel : scene.channels) {
    std::vector<float> times = channel.times;
    std::vector<glm::vec4> values = channel.values;
    const bool cubic = channel.interpolation == Channel::Interpolation::cubic_spline;
    // A file's animation ends with its last key: hold the first curve's until the scene's end.
    if (samplers.empty() && last < scene.duration) {
      const glm::vec4 held = values[values.size() - (cubic ? 2 : 1)];
      times.push_back(scene.duration);
      if (cubic) {
        values.back() = glm::vec4(0);
        values.insert(values.end(), {glm::vec4(0), held, glm::vec4(0)});
      } else {
        values.push_back(held);
      }
    }
    const int numbers = channel.path == Channel::Path::rotation ? 4 : 3;
    std::vector<float> packed;
    for (const glm::vec4& v : values) packed.insert(packed.end(), &v[0], &v[0] + numbers);
    samplers.push_back({{"input", writer.add_owned_floats(std::move(times), 1, true)},
                        {"output", writer.add_owned_floats(std::move(packed), numbers, false)},
                        {"interpolation", kCurves[int(channel.interpolation)]}});
    channels.push_back({{"sampler", samplers.size() - 1},
                        {"target", {{"node", channel.node}, {"path", kPaths[int(channel.path)]}}}});
  }
  if (!channels.empty())
    writer.add("animations",
               {{"channels", std::move(channels)}, {"samplers", std::move(samplers)}});
}

}  // namespace rilievo
