#include "rilievo/cache/plan/hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "rilievo/cache/plan/plan_test_helpers.h"

namespace rilievo {
namespace {

PlanObjects random_objects(std::mt19937& rng, int n) {
  std::uniform_real_distribution<float> u(0, 1);
  PlanObjects o;
  for (int i = 0; i < n; ++i) {
    Box b;
    const glm::vec3 at(100 * u(rng), 5 * u(rng), 100 * u(rng));
    b.add(at), b.add(at + 4.0f * glm::vec3(u(rng), u(rng), u(rng)));
    o.add(b, rng() % 1000);
  }
  return o;
}

int depth_of(const Hierarchy& tree, std::uint32_t node) {
  if (tree.nodes[node].leaf()) return 1;
  return 1 + std::max(depth_of(tree, node + 1), depth_of(tree, tree.nodes[node].second_child));
}

void check(const Hierarchy& tree, const PlanObjects& o) {
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const HierarchyNode& node = tree.nodes[i];
    Box box;
    std::uint64_t triangles = 0;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      box.add(o.boxes[tree.order[k]]);
      triangles += o.triangles[tree.order[k]];
    }
    ASSERT_EQ(box.min, node.box.min);
    ASSERT_EQ(box.max, node.box.max);
    ASSERT_EQ(triangles, node.triangles);
    ASSERT_EQ(node.leaf(), node.count == 1);
    if (node.leaf()) continue;
    const HierarchyNode &a = tree.nodes[i + 1], &b = tree.nodes[node.second_child];
    ASSERT_EQ(a.first, node.first);
    ASSERT_EQ(a.first + a.count, b.first);
    ASSERT_EQ(a.count + b.count, node.count);
  }
}

TEST(Hierarchy, those_apart_hang_under_a_node_of_their_own) {
  std::mt19937 rng(5);
  for (int round = 0; round < 60; ++round) {
    const int n = 1 + int(rng() % 40);
    const PlanObjects o = random_objects(rng, n);
    std::vector<std::uint8_t> apart(std::size_t(n), 0);
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < std::uint32_t(n); ++i)
      if (round % 4 == 0 || rng() % 3 == 0) apart[i] = 1, expected.push_back(i);
    if (round % 7 == 0) std::fill(apart.begin(), apart.end(), std::uint8_t(0)), expected.clear();
    const Hierarchy tree = build_hierarchy(o.boxes, o.triangles, apart);
    check(tree, o);
    ASSERT_EQ(tree.apart.has_value(), !expected.empty());
    if (expected.empty()) continue;
    const HierarchyNode& node = tree.nodes[*tree.apart];
    std::vector<std::uint32_t> found(tree.order.begin() + node.first,
                                     tree.order.begin() + node.first + node.count);
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found, expected);
  }
}

TEST(Hierarchy, every_node_holds_what_its_children_hold) {
  std::mt19937 rng(1);
  for (int n : {1, 2, 3, 17, 500}) {
    PlanObjects o = random_objects(rng, n);
    if (n > 2) o.boxes[1] = Box{};  // nothing to draw
    const Hierarchy tree = build_hierarchy(o.boxes, o.triangles);
    const std::size_t kept = std::size_t(n > 2 ? n - 1 : n);
    ASSERT_EQ(tree.order.size(), kept);
    ASSERT_EQ(tree.nodes.size(), 2 * kept - 1);
    std::vector<std::uint32_t> sorted = tree.order;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(std::unique(sorted.begin(), sorted.end()), sorted.end());
    check(tree, o);
  }
  EXPECT_TRUE(build_hierarchy({}, {}).nodes.empty());
}

TEST(Hierarchy, degenerate_input_stays_shallow) {
  PlanObjects same;  // all in one place
  Box unit;
  unit.add({0, 0, 0}), unit.add({1, 1, 1});
  same.boxes.assign(4096, unit);
  same.triangles.assign(4096, 1);
  const Hierarchy flat = build_hierarchy(same.boxes, same.triangles);
  check(flat, same);
  EXPECT_EQ(depth_of(flat, 0), 13);
  PlanObjects skewed;  // each twice as far as the last: one object a cut
  for (int i = 0; i < 120; ++i) {
    const float at = std::ldexp(1.0f, i);
    Box b;
    b.add({at, 0, 0}), b.add({at * 1.01f, 1, 1});
    skewed.boxes.push_back(b), skewed.triangles.push_back(1);
  }
  const Hierarchy tree = build_hierarchy(skewed.boxes, skewed.triangles);
  check(tree, skewed);
  EXPECT_LE(depth_of(tree, 0), 40 + 8);
}

TEST(Hierarchy, nodes_are_compact) {
  // Against a tree that halves the objects as they come: random order, so that its nodes are wide.
  std::mt19937 rng(2);
  const PlanObjects o = random_objects(rng, 2000);
  const Hierarchy tree = build_hierarchy(o.boxes, o.triangles);
  double compact = 0;
  int nodes = 0;
  for (const HierarchyNode& node : tree.nodes)
    if (node.count >= 8 && node.count <= 32) compact += node.box.radius(), ++nodes;
  // 16 objects of 2000 in a square of 100 m: a square of 9 m each, 12 m across with the objects.
  EXPECT_LT(compact / nodes, 12);
}

}  // namespace
}  // namespace rilievo
