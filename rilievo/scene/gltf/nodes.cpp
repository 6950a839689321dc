#include "rilievo/scene/gltf/nodes.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/scene/move_points.h"

namespace rilievo::gltf {
namespace {

TreeNode read_node(const JsonValue& from) {
  TreeNode node;
  if (const JsonValue matrix = from["matrix"]) {
    double m[16];
    matrix.numbers(m);
    node.has_matrix = true;
    for (int i = 0; i < 16; ++i) node.parent_from_node[i / 4][i % 4] = m[i];
    // 1e-5: what exporters leave of zero and one.
    const bool affine = std::abs(m[3]) < 1e-5 && std::abs(m[7]) < 1e-5 && std::abs(m[11]) < 1e-5 &&
                        std::abs(m[15] - 1) < 1e-5;
    if (!affine) matrix.fail("is not affine");
    for (int c = 0; c < 4; ++c) node.parent_from_node[c][3] = c == 3 ? 1.0 : 0.0;
    return node;
  }
  node.translation = from["translation"].vec3(node.translation);
  node.scale = from["scale"].vec3(node.scale);
  const glm::dvec4 q = from["rotation"].vec4({0, 0, 0, 1});
  const double length = glm::length(q);
  if (length > 1e-12) node.rotation = glm::dquat(q.w, q.x, q.y, q.z) / length;
  node.parent_from_node = glm::translate(glm::dmat4(1.0), node.translation) *
                          glm::mat4_cast(node.rotation) * glm::scale(glm::dmat4(1.0), node.scale);
  return node;
}

void link(Document& document, Tree& tree) {
  const JsonValue nodes = document.root()["nodes"];
  std::vector<std::vector<int>> children(tree.nodes.size());
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const JsonValue list = nodes[i]["children"];
    for (std::size_t k = 0; k < list.size(); ++k) {
      const int child = list[k].required_index(tree.nodes.size());
      if (tree.nodes[child].parent >= 0)
        nodes[std::size_t(child)].fail("is the child of two nodes");
      tree.nodes[child].parent = int(i);
      children[i].push_back(child);
    }
  }
  for (std::size_t i = 0; i < tree.nodes.size(); ++i)
    if (tree.nodes[i].parent < 0) tree.order.push_back(int(i));
  for (std::size_t k = 0; k < tree.order.size(); ++k)
    for (int child : children[tree.order[k]]) tree.order.push_back(child);
  // What no root leads to hangs below itself.
  if (tree.order.size() != tree.nodes.size()) refuse("has nodes that are their own ancestors");
}

void choose_scene(Document& document, Tree& tree) {
  const JsonValue root = document.root(), scenes = root["scenes"];
  tree.drawn.assign(tree.nodes.size(), 0);
  std::uint64_t shown = root["scene"].whole(0);
  if (shown >= scenes.size() && root["scene"]) {
    document.context->warn("the default scene does not exist");
    shown = 0;
  }
  if (scenes.size() == 0) {
    tree.drawn.assign(tree.nodes.size(), 1);
    return;
  }
  if (scenes.size() > 1)
    document.context->warn("only one of " + std::to_string(scenes.size()) + " scenes is shown");
  const JsonValue roots = scenes[shown]["nodes"];
  for (std::size_t i = 0; i < roots.size(); ++i)
    tree.drawn[roots[i].required_index(tree.nodes.size())] = 1;
  for (int i : tree.order)
    if (tree.nodes[i].parent >= 0 && tree.drawn[tree.nodes[i].parent]) tree.drawn[i] = 1;
}

// Eigenvectors of a symmetric matrix as a rotation, by Jacobi's method: every sweep turns the three
// off-diagonal entries to zero in turn; 3 x 3 matrices converge in about five.
glm::dmat3 eigenvectors(glm::dmat3 a) {
  glm::dmat3 v(1.0);
  for (int sweep = 0; sweep < 16; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (std::abs(a[q][p]) <= 1e-300) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[q][p]);
        const double t = (theta >= 0 ? 1.0 : -1.0) / (std::abs(theta) + std::hypot(theta, 1.0));
        const double c = 1 / std::hypot(t, 1.0), s = t * c;
        glm::dmat3 turn(1.0);
        turn[p][p] = turn[q][q] = c;
        turn[q][p] = s;
        turn[p][q] = -s;
        a = glm::transpose(turn) * a * turn;
        v = v * turn;
      }
  return v;
}

// Some unit vector at right angles to the first `known` columns, and to each other.
glm::dvec3 complete(const glm::dmat3& u, int known) {
  if (known == 2) return glm::cross(u[0], u[1]);
  const glm::dvec3 axis = std::abs(u[0].x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return known == 0 ? glm::dvec3(1, 0, 0) : glm::normalize(glm::cross(u[0], axis));
}

// linear = rotation(turned) * scale(stretch) * transpose(rotation(axes)): the singular values, with
// the sign of the determinant on the last.
struct Stretch {
  glm::dmat3 turned, axes;
  glm::dvec3 stretch;
};

Stretch decompose(const glm::dmat3& linear) {
  Stretch out;
  out.axes = eigenvectors(glm::transpose(linear) * linear);
  // Longest first, so that those too short to have a direction come last.
  for (int i = 0; i < 2; ++i)
    for (int k = i + 1; k < 3; ++k)
      if (glm::length(linear * out.axes[k]) > glm::length(linear * out.axes[i]))
        std::swap(out.axes[i], out.axes[k]);
  if (glm::determinant(out.axes) < 0) out.axes[2] = -out.axes[2];
  const double longest = glm::length(linear * out.axes[0]);
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 image = linear * out.axes[i];
    out.stretch[i] = glm::length(image);
    const bool directed = out.stretch[i] > 1e-9 * longest;
    out.turned[i] = directed ? image / out.stretch[i] : complete(out.turned, i);
  }
  if (glm::determinant(out.turned) < 0) {
    out.turned[2] = -out.turned[2];
    out.stretch[2] = -out.stretch[2];
  }
  return out;
}

Node to_node(int parent, const glm::dvec3& translation, const glm::dquat& rotation,
             const glm::dvec3& scale) {
  return {parent, translation, glm::quat(rotation), glm::vec3(scale)};
}

}  // namespace

Tree read_tree(Document& document) {
  Tree tree;
  const JsonValue nodes = document.root()["nodes"];
  // Nodes, lists of children, poses; and what pose_tree() makes of them for an animation.
  const bool animated = document.count("animations") > 0;
  document.context->budget.take(nodes.size(),
                                sizeof(TreeNode) + 64 + sizeof(glm::dmat4) +
                                    (animated ? 4 * sizeof(Node) + sizeof(Object) + 128 : 0));
  tree.nodes.reserve(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) tree.nodes.push_back(read_node(nodes[i]));
  link(document, tree);
  choose_scene(document, tree);
  return tree;
}

int append_node(const TreeNode& node, int parent, std::vector<Node>& to) {
  if (!node.has_matrix) {
    to.push_back(to_node(parent, node.translation, node.rotation, node.scale));
    return int(to.size()) - 1;
  }
  const glm::dvec3 translation(node.parent_from_node[3]);
  const glm::dmat3 m(node.parent_from_node);
  const glm::dvec3 length(glm::length(m[0]), glm::length(m[1]), glm::length(m[2]));
  const double volume = length.x * length.y * length.z;
  // Columns at right angles need no decomposition. 1e-6: exporters write floats.
  const bool orthogonal = volume > 0 &&
                          std::abs(glm::dot(m[0], m[1])) <= 1e-6 * length.x * length.y &&
                          std::abs(glm::dot(m[1], m[2])) <= 1e-6 * length.y * length.z &&
                          std::abs(glm::dot(m[2], m[0])) <= 1e-6 * length.z * length.x;
  if (orthogonal) {
    const double sign = glm::determinant(m) < 0 ? -1.0 : 1.0;
    const glm::dmat3 rotation(m[0] / (sign * length.x), m[1] / length.y, m[2] / length.z);
    to.push_back(to_node(parent, translation, glm::normalize(glm::quat_cast(rotation)),
                         {sign * length.x, length.y, length.z}));
    return int(to.size()) - 1;
  }
  const Stretch s = decompose(m);
  to.push_back(to_node(parent, translation, glm::quat_cast(s.turned), s.stretch));
  to.push_back(to_node(int(to.size()) - 1, glm::dvec3(0), glm::quat_cast(glm::transpose(s.axes)),
                       glm::dvec3(1)));
  return int(to.size()) - 1;
}

// Every node of an animated document at `time`; marks what hangs below a node that moves.
void pose_rig(const Tree& tree, const Animation& animation, double time,
              std::vector<char>& animated, std::vector<glm::mat4>& posed) {
  const std::size_t n = tree.nodes.size();
  Scene rig;
  rig.duration = animation.duration;
  std::vector<int> rig_node(n, -1);
  for (int i : tree.order) {
    const int parent = tree.nodes[i].parent;
    if (parent >= 0 && animated[parent]) animated[i] = 1;
    rig_node[i] = append_node(tree.nodes[i], parent < 0 ? -1 : rig_node[parent], rig.nodes);
  }
  rig.channels = animation.channels;
  for (Channel& channel : rig.channels) channel.node = rig_node[channel.node];
  rig.objects.resize(n);
  for (std::size_t i = 0; i < n; ++i) rig.objects[i].node = rig_node[i];
  pose(rig, time, posed);
}

void set_origin(const glm::dvec3& origin, Tree& tree, Animation& animation) {
  for (TreeNode& node : tree.nodes) {
    if (node.parent >= 0) continue;
    node.translation -= origin;
    node.parent_from_node[3] -= glm::dvec4(origin, 0);
  }
  for (Channel& channel : animation.channels)
    if (channel.path == Channel::Path::translation && tree.nodes[channel.node].parent < 0)
      move_points(channel, -origin);
}

PosedTree pose_tree(const Tree& tree, const Animation& animation, double time) {
  const std::size_t n = tree.nodes.size();
  PosedTree out{std::vector<glm::dmat4>(n), std::vector<char>(n, 0)};
  for (const Channel& channel : animation.channels) out.animated[channel.node] = 1;

  // The animated part by pose(), as it will be at every later time; the rest in doubles.
  std::vector<glm::mat4> posed;
  if (!animation.channels.empty()) pose_rig(tree, animation, time, out.animated, posed);
  for (int i : tree.order) {
    const TreeNode& node = tree.nodes[i];
    if (out.animated[i])
      out.world_from_node[i] = glm::dmat4(posed[i]);
    else
      out.world_from_node[i] = node.parent < 0
                                   ? node.parent_from_node
                                   : out.world_from_node[node.parent] * node.parent_from_node;
  }
  return out;
}

}  // namespace rilievo::gltf
