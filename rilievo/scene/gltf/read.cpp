#include "rilievo/scene/gltf/read.h"

#include <array>
#include <map>
#include <tuple>

#include "rilievo/scene/gltf/accessor.h"
#include "rilievo/scene/gltf/lights.h"
#include "rilievo/scene/gltf/material.h"
#include "rilievo/scene/gltf/mesh.h"
#include "rilievo/scene/gltf/nodes.h"

namespace rilievo {
namespace gltf {
namespace {

class Reader {
 public:
  Reader(Bytes file, LoadContext& context)
      : context_(context),
        document_(open_document(file, context)),
        materials_(document_, scene_),
        tree_(read_tree(document_)),
        animation_(read_animation(document_)),
        posed_(pose_tree(tree_, animation_, context.time)) {}

  Scene read() {
    scene_.name = context_.name;
    for (int node : tree_.order)
      if (tree_.drawn[node]) add_objects(node);
    if (tree_.nodes.empty()) add_bare_meshes();
    keep_animation();
    read_lights(document_, tree_, posed_, scene_);
    read_cameras(document_, tree_, posed_, scene_);
    finish(scene_);
    if (!scene_.lights.empty()) balance_lights(world_bounds(scene_), scene_.lights);
    return std::move(scene_);
  }

 private:
  void add_objects(int node);
  void add_bare_meshes();
  void add_object(const std::string& name, int model, int node, const glm::dmat4& placement);
  void keep_animation();
  int model_of(int mesh, int skin, const Pose& pose);
  Pose pose_of(int node, int mesh, int skin);
  std::vector<glm::dmat4> joints_of(int skin);
  std::vector<glm::dmat4> instances_of(const JsonValue& instancing);

  LoadContext& context_;
  Document document_;
  Scene scene_;
  Materials materials_;
  Tree tree_;
  Animation animation_;
  PosedTree posed_;
  // Which model a mesh has become, bent by a skin and weights; -1: none, it has no triangles.
  std::map<std::tuple<int, int, std::vector<float>>, int> models_;
};

// world_from_joint * joint_from_mesh of every joint.
std::vector<glm::dmat4> Reader::joints_of(int skin) {
  constexpr std::array kSixteen{16};
  const JsonValue from = document_.root()["skins"][std::size_t(skin)];
  const JsonValue joints = from["joints"];
  if (joints.size() == 0) from.fail("has no joints");
  context_.budget.take(joints.size(), sizeof(glm::dmat4));
  std::vector<glm::dmat4> out;
  for (std::size_t i = 0; i < joints.size(); ++i)
    out.push_back(posed_.world_from_node[joints[i].required_index(tree_.nodes.size())]);
  const JsonValue inverse_bind = from["inverseBindMatrices"];
  if (!inverse_bind) return out;

  const Accessor accessor =
      describe_accessor(document_, inverse_bind.required_index(document_.count("accessors")));
  expect_numbers(document_, accessor, kSixteen);
  if (accessor.component != Component::float32) inverse_bind.fail("does not refer to floats");
  if (accessor.count < out.size()) inverse_bind.fail("has fewer matrices than there are joints");
  const std::vector<float> numbers = read_floats(document_, accessor);
  for (std::size_t i = 0; i < out.size(); ++i) {
    glm::dmat4 joint_from_mesh(1.0);
    for (int k = 0; k < 16; ++k) joint_from_mesh[k / 4][k % 4] = double(numbers[16 * i + k]);
    out[i] = out[i] * joint_from_mesh;
  }
  return out;
}

Pose Reader::pose_of(int node, int mesh, int skin) {
  Pose pose;
  const JsonValue root = document_.root();
  const JsonValue of_mesh = root["meshes"][std::size_t(mesh)]["weights"];
  const JsonValue of_node = node < 0 ? of_mesh : root["nodes"][std::size_t(node)]["weights"];
  const JsonValue& weights = of_node ? of_node : of_mesh;
  for (std::size_t i = 0; i < weights.size(); ++i)
    pose.weights.push_back(float(weights[i].number()));
  const double time = repeated(context_.time, double(animation_.duration));
  for (const WeightTrack& track : animation_.weights) {
    if (track.node != node) continue;
    pose.weights.clear();
    for (const Channel& target : track.targets) pose.weights.push_back(sample(target, time).x);
  }
  if (skin >= 0) pose.model_from_joint = joints_of(skin);
  return pose;
}

int Reader::model_of(int mesh, int skin, const Pose& pose) {
  const auto [known, fresh] = models_.try_emplace({mesh, skin, pose.weights}, -1);
  if (!fresh) return known->second;
  const JsonValue from = document_.root()["meshes"][std::size_t(mesh)];
  Model model;
  model.name = from["name"].text("mesh " + std::to_string(mesh));
  const JsonValue primitives = from["primitives"];
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    std::optional<Mesh> read = read_primitive(document_, primitives[i], pose);
    if (!read) continue;
    read->name = model.name;
    read->material = materials_.use(read->material);
    model.parts.push_back({int(scene_.meshes.size()), glm::mat4(1.0f)});
    scene_.meshes.push_back(std::move(*read));
  }
  if (model.parts.empty()) return -1;
  known->second = int(scene_.models.size());
  scene_.models.push_back(std::move(model));
  return known->second;
}

// EXT_mesh_gpu_instancing: node_from_instance of every instance.
std::vector<glm::dmat4> Reader::instances_of(const JsonValue& instancing) {
  const JsonValue attributes = instancing["attributes"];
  std::optional<std::uint64_t> count;
  const auto read = [&](const char* name, int numbers) -> std::vector<float> {
    const JsonValue at = attributes[name];
    if (!at) return {};
    const Accessor a =
        describe_accessor(document_, at.required_index(document_.count("accessors")));
    expect_numbers(document_, a, std::array{numbers});
    if (count && *count != a.count)
      at.fail("has a different number of instances than the other attributes");
    count = a.count;
    return read_floats(document_, a);
  };
  const std::vector<float> t = read("TRANSLATION", 3), r = read("ROTATION", 4),
                           s = read("SCALE", 3);
  context_.budget.take(count.value_or(0), sizeof(glm::dmat4));
  std::vector<glm::dmat4> out;
  out.reserve(count.value_or(0));
  for (std::size_t i = 0; i < count.value_or(0); ++i) {
    TreeNode node;
    if (!t.empty()) node.translation = {t[3 * i], t[3 * i + 1], t[3 * i + 2]};
    if (!s.empty()) node.scale = {s[3 * i], s[3 * i + 1], s[3 * i + 2]};
    if (!r.empty()) node.rotation = glm::dquat(r[4 * i + 3], r[4 * i], r[4 * i + 1], r[4 * i + 2]);
    if (const double length = glm::length(node.rotation); length > 0)
      node.rotation = node.rotation / length;
    glm::dmat4 m = glm::mat4_cast(node.rotation);
    for (int c = 0; c < 3; ++c) m[c] *= node.scale[c];
    m[3] = glm::dvec4(node.translation, 1);
    out.push_back(m);
  }
  return out;
}

void Reader::add_object(const std::string& name, int model, int node, const glm::dmat4& placement) {
  // Twice: the vector doubles as it grows. A matrix for the pose.
  context_.budget.take(2 * sizeof(Object) + sizeof(glm::mat4) + name.size());
  Object object;
  object.name = name;
  object.model = model;
  object.node = node;
  object.placement = glm::mat4(placement);
  scene_.objects.push_back(std::move(object));
}

// Object::node is the document's index until keep_animation().
void Reader::add_objects(int node) {
  const JsonValue from = document_.root()["nodes"][std::size_t(node)];
  const int mesh = from["mesh"].index(document_.count("meshes"));
  if (mesh < 0) return;
  const int skin = from["skin"].index(document_.count("skins"));
  const int model = model_of(mesh, skin, pose_of(node, mesh, skin));
  if (model < 0) return;
  std::string name = from["name"].text("");
  if (name.empty()) name = scene_.models[model].name;

  // A skinned mesh is where its joints are, wherever its node is.
  if (skin >= 0) return add_object(name, model, -1, glm::dmat4(1.0));
  const bool animated = posed_.animated[node];
  const glm::dmat4 placed = animated ? glm::dmat4(1.0) : posed_.world_from_node[node];
  const int by = animated ? node : -1;
  const JsonValue instancing = from["extensions"]["EXT_mesh_gpu_instancing"];
  if (!instancing) return add_object(name, model, by, placed);
  int i = 0;
  for (const glm::dmat4& node_from_instance : instances_of(instancing))
    add_object(name + " #" + std::to_string(i++), model, by, placed * node_from_instance);
}

// A file without nodes is a library of meshes: show each where it is.
void Reader::add_bare_meshes() {
  const std::size_t meshes = document_.count("meshes");
  if (meshes > 0) context_.warn("has meshes, but no nodes that place them");
  for (std::size_t i = 0; i < meshes; ++i)
    if (const int model = model_of(int(i), -1, pose_of(-1, int(i), -1)); model >= 0)
      add_object(scene_.models[model].name, model, -1, glm::dmat4(1.0));
}

// Only the nodes above objects, and the channels that move those.
void Reader::keep_animation() {
  std::vector<char> needed(tree_.nodes.size(), 0);
  for (const Object& object : scene_.objects)
    for (int i = object.node; i >= 0 && !needed[i]; i = tree_.nodes[i].parent) needed[i] = 1;
  std::vector<int> kept(tree_.nodes.size(), -1);
  for (int i : tree_.order) {
    if (!needed[i]) continue;
    const int parent = tree_.nodes[i].parent;
    kept[i] = append_node(tree_.nodes[i], parent < 0 ? -1 : kept[parent], scene_.nodes);
  }
  for (Object& object : scene_.objects)
    if (object.node >= 0) object.node = kept[object.node];
  for (Channel& channel : animation_.channels) {
    if (kept[channel.node] < 0) continue;
    channel.node = kept[channel.node];
    scene_.channels.push_back(std::move(channel));
  }
  if (!scene_.channels.empty()) scene_.duration = std::max(animation_.duration, 0.0f);
}

}  // namespace
}  // namespace gltf

Scene read_gltf(Bytes file, LoadContext& context) { return gltf::Reader(file, context).read(); }

}  // namespace rilievo
