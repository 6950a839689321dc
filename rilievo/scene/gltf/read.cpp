#include "rilievo/scene/gltf/read.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "rilievo/scene/far_origin.h"
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
    take_origin_off();
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
  void take_origin_off();
  std::vector<glm::dvec3> places();
  [[nodiscard]] glm::dvec3 origin_for(std::vector<glm::dvec3> points) const;
  glm::dvec3 center_positions(const Model& model);
  void add_objects(int node);
  void add_bare_meshes();
  void add_object(const std::string& name, int model, int node, const glm::dmat4& placement);
  void keep_animation();
  int model_of(int node, int mesh, int skin, const Pose& pose);
  Pose pose_of(int node, int mesh, int skin);
  struct SkinJoint {
    int node = 0;  // of the document
    glm::dmat4 joint_from_mesh{1.0};
  };
  std::vector<SkinJoint> joints_of(int skin);
  [[nodiscard]] const WeightTrack* track_of(int node) const;
  [[nodiscard]] bool bends_by_time(int node, int skin);
  void bend_by_time(const WeightTrack* track, int skin, Deformation& deformation);
  int rig_node_of(int node);
  std::vector<glm::dmat4> instances_of(const JsonValue& instancing);

  LoadContext& context_;
  Document document_;
  Scene scene_;
  Materials materials_;
  Tree tree_;
  Animation animation_;
  PosedTree posed_;
  // Which model a mesh has become, bent by a skin and weights, and by the curve of a node if these
  // are kept; -1: none, it has no triangles.
  std::map<std::tuple<int, int, std::vector<float>, int>, int> models_;
  std::map<int, bool> moved_skins_;  // does the animation move a joint? Of those asked for
  std::vector<glm::dvec3> offsets_;  // of each model: was subtracted from its positions
  std::vector<int> rig_nodes_;       // by the document's, or -1
  std::vector<std::vector<std::size_t>> rig_channels_;  // by the document's node
};

// Points that tell where the drawn objects are, by what the file says of its meshes.
std::vector<glm::dvec3> Reader::places() {
  constexpr std::size_t kSamples = 4096;  // of instances
  std::vector<glm::dvec3> points;
  const JsonValue root = document_.root(), accessors = root["accessors"];
  const auto add_box = [&](const glm::dmat4& scene_from_mesh, const glm::dvec3(&ends)[2]) {
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec4 p(ends[corner & 1].x, ends[corner >> 1 & 1].y, ends[corner >> 2].z, 1);
      const glm::dvec3 placed(scene_from_mesh * p);
      if (std::isfinite(glm::dot(placed, placed))) points.push_back(placed);
    }
  };
  // Where nothing tells how large a mesh is; metres.
  constexpr glm::dvec3 kSomeBox[2]{glm::dvec3(-1), glm::dvec3(1)};
  for (int i : tree_.order) {
    const JsonValue node = root["nodes"][std::size_t(i)];
    const int mesh = node["mesh"].index(document_.count("meshes"));
    if (mesh < 0 || !tree_.drawn[i]) continue;
    context_.budget.borrow(points.size() + 8, 2 * sizeof(glm::dvec3));
    const int skin = node["skin"].index(document_.count("skins"));
    if (skin >= 0) {
      for (const SkinJoint& joint : joints_of(skin))
        add_box(posed_.world_from_node[joint.node], kSomeBox);
      continue;
    }
    std::vector<glm::dmat4> places{posed_.world_from_node[i]};
    if (const JsonValue instancing = node["extensions"]["EXT_mesh_gpu_instancing"]) {
      places = instances_of(instancing);
      for (glm::dmat4& place : places) place = posed_.world_from_node[i] * place;
    }
    const JsonValue primitives = root["meshes"][std::size_t(mesh)]["primitives"];
    for (std::size_t k = 0; k < primitives.size(); ++k) {
      const JsonValue position = primitives[k]["attributes"]["POSITION"];
      const int index = position.index(accessors.size());
      const JsonValue low = index < 0 ? position : accessors[std::size_t(index)]["min"];
      const JsonValue high = index < 0 ? position : accessors[std::size_t(index)]["max"];
      glm::dvec3 ends[2]{kSomeBox[0], kSomeBox[1]};
      for (std::size_t c = 0; c < 3 && index >= 0 && low.size() == 3 && high.size() == 3; ++c)
        ends[0][int(c)] = low[c].number(), ends[1][int(c)] = high[c].number();
      const std::size_t step = 1 + places.size() / kSamples;
      for (std::size_t at = 0; at < places.size(); at += step) add_box(places[at], ends);
    }
  }
  return points;
}

// The place of a root, if it serves: then what hangs below keeps its own numbers.
glm::dvec3 Reader::origin_for(std::vector<glm::dvec3> points) const {
  const glm::dvec3 found = far_origin(points);
  if (found == glm::dvec3(0)) return found;
  constexpr int kTried = 16;  // a scene of many roots has none that is all the others'
  int tried = 0;
  for (int i : tree_.order) {
    if (tree_.nodes[i].parent >= 0 || !tree_.drawn[i] || ++tried > kTried) continue;
    const glm::dvec3 place(tree_.nodes[i].parent_from_node[3]);
    std::vector<glm::dvec3> around = points;
    for (glm::dvec3& p : around) p -= place;
    if (far_origin(std::move(around)) == glm::dvec3(0)) return place;
  }
  return found;
}

void Reader::take_origin_off() {
  const glm::dvec3 origin = origin_for(places());
  if (origin != glm::dvec3(0)) {
    set_origin(origin, tree_, animation_);
    posed_ = pose_tree(tree_, animation_, context_.time);
  }
  scene_.world.origin = origin;
  const JsonValue center = document_.root()["extensions"]["CESIUM_RTC"]["center"];
  for (std::size_t c = 0; c < 3 && center.size() == 3; ++c)
    scene_.world.origin[int(c)] += center[c].number();
}

// Meshes whose positions are far from 0 lose digits when they are placed near it: what placements
// then add instead. Floats subtract without a loss where they are alike.
glm::dvec3 Reader::center_positions(const Model& model) {
  std::vector<glm::dvec3> corners;
  for (const Part& part : model.parts) {
    Box box;
    for (const glm::vec3& p : scene_.meshes[std::size_t(part.mesh)].positions) box.add(p);
    if (!box.empty()) corners.insert(corners.end(), {box.min, box.max});
  }
  const glm::dvec3 offset = far_origin(std::move(corners));
  if (offset == glm::dvec3(0)) return offset;
  for (const Part& part : model.parts)
    for (glm::vec3& p : scene_.meshes[std::size_t(part.mesh)].positions)
      p = glm::vec3(glm::dvec3(p) - offset);
  return offset;
}

std::vector<Reader::SkinJoint> Reader::joints_of(int skin) {
  constexpr std::array kSixteen{16};
  const JsonValue from = document_.root()["skins"][std::size_t(skin)];
  const JsonValue joints = from["joints"];
  if (joints.size() == 0) from.fail("has no joints");
  context_.budget.take(joints.size(), sizeof(SkinJoint));
  std::vector<SkinJoint> out;
  for (std::size_t i = 0; i < joints.size(); ++i)
    out.push_back({int(joints[i].required_index(tree_.nodes.size())), glm::dmat4(1.0)});
  const JsonValue inverse_bind = from["inverseBindMatrices"];
  if (!inverse_bind) return out;

  const Accessor accessor =
      describe_accessor(document_, inverse_bind.required_index(document_.count("accessors")));
  expect_numbers(document_, accessor, kSixteen);
  if (accessor.component != Component::float32) inverse_bind.fail("does not refer to floats");
  if (accessor.count < out.size()) inverse_bind.fail("has fewer matrices than there are joints");
  const std::vector<float> numbers = read_floats(document_, accessor);
  for (std::size_t i = 0; i < out.size(); ++i)
    for (int k = 0; k < 16; ++k)
      out[i].joint_from_mesh[k / 4][k % 4] = double(numbers[16 * i + std::size_t(k)]);
  return out;
}

const WeightTrack* Reader::track_of(int node) const {
  const WeightTrack* last = nullptr;
  for (const WeightTrack& track : animation_.weights)
    if (track.node == node) last = &track;
  return last;
}

// The rig's node that stands for a node of the document; with all above it, and their curves.
int Reader::rig_node_of(int node) {
  Rig& rig = context_.deformations->rig;
  if (rig_nodes_.empty()) {
    rig_nodes_.assign(tree_.nodes.size(), -1);
    rig_channels_.resize(tree_.nodes.size());
    for (std::size_t i = 0; i < animation_.channels.size(); ++i)
      rig_channels_[std::size_t(animation_.channels[i].node)].push_back(i);
  }
  std::vector<int> missing;
  for (int i = node; i >= 0 && rig_nodes_[std::size_t(i)] < 0;
       i = tree_.nodes[std::size_t(i)].parent)
    missing.push_back(i);
  for (auto at = missing.rbegin(); at != missing.rend(); ++at) {
    const TreeNode& from = tree_.nodes[std::size_t(*at)];
    context_.budget.take(2 * sizeof(Node));
    const int made =
        append_node(from, from.parent < 0 ? -1 : rig_nodes_[std::size_t(from.parent)], rig.nodes);
    rig_nodes_[std::size_t(*at)] = made;
    for (const std::size_t i : rig_channels_[std::size_t(*at)]) {
      const Channel& channel = animation_.channels[i];
      context_.budget.take(channel.values.size(), sizeof(glm::vec4) + sizeof(float));
      rig.channels.push_back(channel);
      rig.channels.back().node = made;
    }
  }
  return rig_nodes_[std::size_t(node)];
}

// Does the animation move the mesh's weights, or a joint of the skin? Where it does not, the mesh
// is a still object in its pose, which every method draws.
bool Reader::bends_by_time(int node, int skin) {
  if (!(animation_.duration > 0)) return false;
  if (track_of(node)) return true;
  if (skin < 0) return false;
  const auto [known, fresh] = moved_skins_.try_emplace(skin, false);
  const JsonValue joints = document_.root()["skins"][std::size_t(skin)]["joints"];
  for (std::size_t i = 0; fresh && i < joints.size(); ++i)
    if (posed_.animated[std::size_t(joints[i].required_index(tree_.nodes.size()))])
      known->second = true;
  return known->second;
}

// The parts of a deformation that a primitive does not have.
void Reader::bend_by_time(const WeightTrack* track, int skin, Deformation& deformation) {
  context_.deformations->rig.duration = std::max(animation_.duration, 0.0f);
  if (track)
    for (std::size_t t = 0; t < std::min(track->targets.size(), deformation.targets.size()); ++t) {
      const Channel& curve = track->targets[t];
      context_.budget.take(curve.values.size(), sizeof(glm::vec4) + sizeof(float));
      deformation.targets[t].weights = curve;
    }
  if (skin < 0) return;
  for (const SkinJoint& joint : joints_of(skin))
    deformation.joints.push_back({rig_node_of(joint.node), glm::mat4(joint.joint_from_mesh)});
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
  if (const WeightTrack* track = track_of(node)) {
    pose.weights.clear();
    for (const Channel& target : track->targets) pose.weights.push_back(sample(target, time).x);
  }
  if (skin >= 0)
    for (const SkinJoint& joint : joints_of(skin))
      pose.model_from_joint.push_back(posed_.world_from_node[joint.node] * joint.joint_from_mesh);
  return pose;
}

// Bounds of motion between keys that are farther apart mean nothing.
constexpr float kLongestBending = 86'400;  // seconds

int Reader::model_of(int node, int mesh, int skin, const Pose& pose) {
  bool bends = context_.deformations && bends_by_time(node, skin);
  const WeightTrack* track = bends ? track_of(node) : nullptr;
  if (bends && animation_.duration > kLongestBending) {
    context_.warn("has an animation of more than a day, whose meshes do not bend by time");
    bends = false;
  }
  const auto [known, fresh] =
      models_.try_emplace({mesh, skin, pose.weights, track ? node : -1}, -1);
  if (!fresh) return known->second;
  const JsonValue from = document_.root()["meshes"][std::size_t(mesh)];
  Model model;
  model.name = from["name"].text("mesh " + std::to_string(mesh));
  const JsonValue primitives = from["primitives"];
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    Deformation deformation;
    std::optional<Mesh> read =
        read_primitive(document_, primitives[i], pose, bends ? &deformation : nullptr);
    if (!read) continue;
    if (bends) {
      bend_by_time(track, skin, deformation);
      deformation.mesh = int(scene_.meshes.size());
      context_.deformations->meshes.push_back(std::move(deformation));
    }
    read->name = model.name;
    read->material = materials_.use(read->material);
    model.parts.push_back({int(scene_.meshes.size()), glm::mat4(1.0f)});
    scene_.meshes.push_back(std::move(*read));
  }
  if (model.parts.empty()) return -1;
  known->second = int(scene_.models.size());
  offsets_.push_back(bends || skin >= 0 ? glm::dvec3(0) : center_positions(model));
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
  object.placement[3] = glm::vec4(placement * glm::dvec4(offsets_[std::size_t(model)], 1));
  scene_.objects.push_back(std::move(object));
}

// Object::node is the document's index until keep_animation().
void Reader::add_objects(int node) {
  const JsonValue from = document_.root()["nodes"][std::size_t(node)];
  const int mesh = from["mesh"].index(document_.count("meshes"));
  if (mesh < 0) return;
  const int skin = from["skin"].index(document_.count("skins"));
  const int model = model_of(node, mesh, skin, pose_of(node, mesh, skin));
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
    if (const int model = model_of(-1, int(i), -1, pose_of(-1, int(i), -1)); model >= 0)
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
