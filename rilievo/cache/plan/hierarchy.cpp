// Top-down, by the surface area heuristic over bins [Wald 2007, On fast construction of SAH-based
// bounding volume hierarchies]. Small surfaces mean compact nodes, which is what a picture wants: a
// node's parallax grows with its depth.
#include "rilievo/cache/plan/hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

constexpr int kMaxBins = 16;
// Beyond this depth a node is cut into halves by number: bounds the depth for any input.
constexpr int kHeuristicDepth = 40;

double half_area(const Box& b) {
  if (b.empty()) return 0;
  const glm::dvec3 e(b.extent());
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

struct Builder {
  std::span<const Box> boxes;
  std::span<const std::uint64_t> triangles;
  Hierarchy& tree;

  // What the cut compares: twice the centre.
  [[nodiscard]] glm::vec3 place(std::uint32_t object) const {
    return boxes[object].min + boxes[object].max;
  }

  // Where to cut the objects first ... last - 1 so that count times surface is least; 0: nowhere.
  std::uint32_t cut(std::uint32_t first, std::uint32_t last) {
    Box places;
    for (std::uint32_t i = first; i < last; ++i) places.add(place(tree.order[i]));
    // A bin for each of few objects: most nodes of a tree are small.
    const int bins = std::clamp(int(last - first), 2, kMaxBins);
    const glm::vec3 extent = places.extent(), scale = float(bins) / extent;

    double least = std::numeric_limits<double>::infinity();
    int best_axis = -1, best_bin = 0;
    const auto bin_of = [&](std::uint32_t object, int axis) {
      return std::min(int((place(object)[axis] - places.min[axis]) * scale[axis]), bins - 1);
    };
    for (int axis = 0; axis < 3; ++axis) {
      if (!(extent[axis] > 0) || !std::isfinite(scale[axis])) continue;
      std::array<Box, kMaxBins> box;
      std::array<std::uint32_t, kMaxBins> count{};
      for (std::uint32_t i = first; i < last; ++i) {
        const auto bin = std::size_t(bin_of(tree.order[i], axis));
        box[bin].add(boxes[tree.order[i]]);
        ++count[bin];
      }
      // Cost of everything from bin i on, then of everything before it.
      std::array<double, kMaxBins> right{};
      Box grown;
      std::uint32_t objects = 0;
      for (int i = bins - 1; i > 0; --i) {
        grown.add(box[std::size_t(i)]), objects += count[std::size_t(i)];
        right[std::size_t(i)] = half_area(grown) * objects;
      }
      grown = {}, objects = 0;
      for (int i = 1; i < bins; ++i) {
        grown.add(box[std::size_t(i - 1)]), objects += count[std::size_t(i - 1)];
        if (objects == 0 || objects == last - first) continue;
        const double cost = half_area(grown) * objects + right[std::size_t(i)];
        if (cost < least) least = cost, best_axis = axis, best_bin = i;
      }
    }
    if (best_axis < 0) return 0;
    // Stable: which order the objects came in must not depend on the library's partition.
    const auto begin = tree.order.begin();
    const auto middle = std::stable_partition(
        begin + first, begin + last,
        [&](std::uint32_t object) { return bin_of(object, best_axis) < best_bin; });
    return std::uint32_t(middle - begin);
  }

  void build(std::uint32_t first, std::uint32_t last, int depth) {
    const std::size_t index = tree.nodes.size();
    tree.nodes.emplace_back();
    tree.nodes[index].first = first;
    tree.nodes[index].count = last - first;
    if (last - first == 1) {
      tree.nodes[index].box = boxes[tree.order[first]];
      tree.nodes[index].triangles = triangles[tree.order[first]];
      return;
    }
    std::uint32_t middle = depth < kHeuristicDepth ? cut(first, last) : 0;
    if (middle == 0) middle = first + (last - first) / 2;
    build_children(index, first, middle, last, depth);
  }

  void build_children(std::size_t index, std::uint32_t first, std::uint32_t middle,
                      std::uint32_t last, int depth) {
    build(first, middle, depth + 1);
    const std::size_t second = tree.nodes.size();
    build(middle, last, depth + 1);

    HierarchyNode& node = tree.nodes[index];
    node.second_child = std::uint32_t(second);
    node.box = tree.nodes[index + 1].box;
    node.box.add(tree.nodes[second].box);
    node.triangles = tree.nodes[index + 1].triangles + tree.nodes[second].triangles;
  }
};

}  // namespace

Hierarchy build_hierarchy(std::span<const Box> boxes, std::span<const std::uint64_t> triangles,
                          std::span<const std::uint8_t> apart) {
  RILIEVO_EXPECTS_EQ(boxes.size(), triangles.size());
  RILIEVO_EXPECTS(apart.empty() || apart.size() == boxes.size());
  Hierarchy tree;
  tree.order.reserve(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (!boxes[i].empty()) tree.order.push_back(std::uint32_t(i));
  if (tree.order.empty()) return tree;
  tree.nodes.reserve(2 * tree.order.size() - 1);
  Builder builder{boxes, triangles, tree};
  const auto count = std::uint32_t(tree.order.size());
  const auto begin = tree.order.begin();
  const auto together =
      apart.empty() ? count
                    : std::uint32_t(std::stable_partition(
                                        begin, tree.order.end(),
                                        [&](std::uint32_t object) { return apart[object] == 0; }) -
                                    begin);
  if (together == 0 || together == count) {
    builder.build(0, count, 0);
    if (together == 0) tree.apart = 0;
    return tree;
  }
  tree.nodes.emplace_back();
  tree.nodes[0].count = count;
  builder.build_children(0, 0, together, count, 0);
  tree.apart = tree.nodes[0].second_child;
  return tree;
}

}  // namespace rilievo
