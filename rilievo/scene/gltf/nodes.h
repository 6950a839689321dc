// The node hierarchy of a glTF document and what its first animation does to it. Internal; throws
// LoadError.
#pragma once

#include <vector>

#include "rilievo/scene/gltf/document.h"
#include "rilievo/scene/scene.h"

namespace rilievo::gltf {

struct TreeNode {
  int parent = -1;
  glm::dmat4 parent_from_node{1.0};
  bool has_matrix = false;  // then the next three mean nothing
  glm::dvec3 translation{0.0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 scale{1.0};
};

struct Tree {
  std::vector<TreeNode> nodes;  // as in the document
  std::vector<int> order;       // all of them, parents before children
  std::vector<char> drawn;      // is it in the scene that is shown?
};

// Refuses cycles and nodes with two parents. Shows the default scene, else the first, else all.
[[nodiscard]] Tree read_tree(Document& document);

// A curve of one morph target's weight, in the x of the channel's values.
struct WeightTrack {
  int node = 0;
  std::vector<Channel> targets;
};

struct Animation {
  std::vector<Channel> channels;  // Channel::node is the document's index
  std::vector<WeightTrack> weights;
  float duration = 0.0f;
};

[[nodiscard]] Animation read_animation(Document& document);

// Appends `node` below `parent` (an index into `to`) and returns the index of what its children
// hang on: two nodes if its matrix has a shear, which one translation, rotation and scale cannot.
int append_node(const TreeNode& node, int parent, std::vector<Node>& to);

// world_from_node of every node at `time`; `animated` says for each whether a channel of its own or
// of an ancestor places it.
struct PosedTree {
  std::vector<glm::dmat4> world_from_node;
  std::vector<char> animated;
};
[[nodiscard]] PosedTree pose_tree(const Tree& tree, const Animation& animation, double time);

// Makes `origin` the origin of the tree and of the curves that move its roots.
void set_origin(const glm::dvec3& origin, Tree& tree, Animation& animation);

}  // namespace rilievo::gltf
