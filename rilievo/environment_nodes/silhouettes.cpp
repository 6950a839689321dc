// From a vertex of the polyline, a line of sight may pass through the next gates of its chain: each
// gate, between the centres of the texels that it parts, narrows the cone of directions that pass
// through all. The farthest middle of a gate that is seen so is the next vertex. As consecutive
// gates are sides of one square between four centres, a line through all of them stays in the
// chain's own squares.
//
// Where two texels of one surface meet at a corner alone, a chain goes around each of the others:
//
//     cable | wall      The chain from above turns right, around the upper wall, and its polyline
//     ------+------     runs from the middle of one gate to that of the next. So does that of the
//     wall  | cable     lower wall, and a neck of the cable is left between them.
#include "rilievo/environment_nodes/silhouettes.h"

#include <cstdint>

namespace rilievo {
namespace {

// Gates in units of 1/16 texel.
constexpr int kScale = 8, kMargin = 1;

std::int64_t cross_product(const glm::ivec2& a, const glm::ivec2& b) {
  return std::int64_t(a.x) * b.y - std::int64_t(a.y) * b.x;
}

// Which of the four unit steps from a corner lie along cut gates: right, down, left, up.
struct CornerGates {
  const CubeGrid& grid;
  int face;

  // The step from `corner` in direction k.
  [[nodiscard]] bool cut(const glm::ivec2& corner, int k) const {
    const int n = grid.size(), x = corner.x, y = corner.y;
    switch (k) {
      case 0:
        return x < n && y > 0 && y < n && grid.cut_below(face, x, y - 1);
      case 1:
        return y < n && x > 0 && x < n && grid.cut_right(face, x - 1, y);
      case 2:
        return x > 0 && y > 0 && y < n && grid.cut_below(face, x - 1, y - 1);
      default:
        return y > 0 && x > 0 && x < n && grid.cut_right(face, x - 1, y - 1);
    }
  }
  [[nodiscard]] int degree(const glm::ivec2& corner) const {
    return int(cut(corner, 0)) + int(cut(corner, 1)) + int(cut(corner, 2)) + int(cut(corner, 3));
  }
  [[nodiscard]] bool ends(const glm::ivec2& corner) const {
    const int n = grid.size();
    return corner.x == 0 || corner.y == 0 || corner.x == n || corner.y == n ||
           (degree(corner) != 2 && !is_neck(corner));
  }
  [[nodiscard]] bool is_neck(const glm::ivec2& corner) const {
    return grid.joined_diagonal(face, corner) != CubeGrid::Diagonal::none;
  }
  // The step with which a chain goes on that came with step k to a corner at which none ends.
  [[nodiscard]] int onwards(const glm::ivec2& corner, int k) const {
    const int back = (k + 2) % 4;
    switch (grid.joined_diagonal(face, corner)) {
      case CubeGrid::Diagonal::down_right:
        return 3 - back;  // up and right, down and left
      case CubeGrid::Diagonal::down_left:
        return back ^ 1;  // up and left, down and right
      case CubeGrid::Diagonal::none:
        break;
    }
    for (int turn = 3; turn > 0; --turn)
      if (turn != back && cut(corner, turn)) return turn;
    return 0;
  }
};

constexpr glm::ivec2 kSteps[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};

}  // namespace

std::vector<glm::ivec2> straightened(std::span<const glm::ivec2> corners) {
  const int gates = int(corners.size()) - 1;
  std::vector<glm::ivec2> line{2 * corners.front()};
  const auto middle = [&](int gate) {  // 1 ... gates
    return corners[std::size_t(gate) - 1] + corners[std::size_t(gate)];
  };
  for (int at = 0; at <= gates;) {
    const glm::ivec2 from = kScale * line.back();
    glm::ivec2 low{0}, high{0};
    bool open = false;
    int farthest = at + 1;  // gates + 1: the last corner
    for (int gate = at + 1; gate <= gates + 1; ++gate) {
      const bool last = gate == gates + 1;
      const glm::ivec2 to = kScale * (last ? 2 * corners.back() : middle(gate)) - from;
      const bool seen = !open || (cross_product(low, to) >= 0 && cross_product(to, high) >= 0);
      if (last) {
        if (seen) farthest = gate;
        break;
      }
      const glm::ivec2 step = corners[std::size_t(gate)] - corners[std::size_t(gate) - 1];
      const glm::ivec2 aside = (kScale - kMargin) * glm::ivec2(-step.y, step.x);
      const glm::ivec2 left = to + aside, right = to - aside;
      if (cross_product(right, left) <= 0) break;  // the chain turns back
      if (seen) farthest = gate;
      if (!open) {
        low = right, high = left, open = true;
      } else {
        if (cross_product(low, right) > 0) low = right;
        if (cross_product(left, high) > 0) high = left;
        if (cross_product(low, high) < 0) break;
      }
    }
    line.push_back(farthest == gates + 1 ? 2 * corners.back() : middle(farthest));
    at = farthest;
  }
  return line;
}

std::vector<Silhouette> trace_silhouettes(const CubeGrid& grid, int face) {
  const int n = grid.size();
  const CornerGates gates{grid, face};
  // By corner: steps to the right and down that have been walked.
  Image<std::uint8_t> walked(n + 1, n + 1);
  const auto mark = [&](const glm::ivec2& corner, int k) -> bool {
    const glm::ivec2 start = k < 2 ? corner : corner + kSteps[k];
    const std::uint8_t bit = (k & 1) ? 2 : 1;
    std::uint8_t& seen = walked(start.x, start.y);
    if (seen & bit) return false;
    seen = std::uint8_t(seen | bit);
    return true;
  };
  std::vector<Silhouette> found;
  const auto walk = [&](const glm::ivec2& start, int first) {
    Silhouette chain;
    chain.corners.push_back(start);
    glm::ivec2 corner = start;
    int k = first;
    for (;;) {
      // The texels on both sides of the step.
      const glm::ivec2 next = corner + kSteps[k], low = glm::min(corner, next);
      const glm::ivec2 other = (k & 1) ? low - glm::ivec2(1, 0) : low - glm::ivec2(0, 1);
      const float a = grid.at(face, low), b = grid.at(face, other);
      if (a < 0 || b < 0) chain.to_nothing = true;
      chain.worth += double(a - b) * double(a - b);
      chain.corners.push_back(next);
      corner = next;
      if (gates.ends(corner)) break;
      k = gates.onwards(corner, k);
      if (corner == start && k == first) break;
      mark(corner, k);
    }
    chain.line = straightened(chain.corners);
    found.push_back(std::move(chain));
  };
  // First what has ends, then what is closed: from a neck last, because a polyline has its ends at
  // the very corner.
  enum class Start { end, corner, neck };
  for (const Start from : {Start::end, Start::corner, Start::neck})
    for (int y = 0; y <= n; ++y)
      for (int x = 0; x <= n; ++x)
        for (int k = 0; k < 4; ++k)
          if (gates.cut({x, y}, k) && (from != Start::end || gates.ends({x, y})) &&
              (from != Start::corner || !gates.is_neck({x, y})) && mark({x, y}, k))
            walk({x, y}, k);
  return found;
}

}  // namespace rilievo
