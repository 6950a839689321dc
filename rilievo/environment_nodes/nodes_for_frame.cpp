// A place is free if a node sees beyond it. Along a line of sight, the place that no node sees any
// more is on a surface if nodes have one about there; else what no node knows begins, and the
// search goes on behind it.
#include "rilievo/environment_nodes/nodes_for_frame.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {
namespace {
// Disparities of a node and of a place agree to this share.
constexpr double kAgrees = 0.05;
// Neighbouring disparities of one surface differ by at most this factor.
constexpr double kOneSlope = 1.5;
// A step turns a node's line of sight by at most so many radians, and ends at the latest where the
// node sees no more in the old direction; but it is at least this share of the distance.
constexpr double kTurn = 0.03, kLeastStep = 0.01;
constexpr int kMostSteps = 300, kHalvings = 6;
// Places so much nearer than a node's surfaces around are free: distances are those of texels.
constexpr double kClearShare = 0.95;
// After steps longer than this share of the way another such step is tried first.
constexpr double kClearStep = 0.03;
// Of neighbouring places on one surface the farthest is at most so many times as far as the
// nearest.
constexpr double kSmooth = 1.3;
// Nodes that are asked: the best.
constexpr std::size_t kMostAsked = 16;

// A line of sight in the space of a node.
struct NodeRay {
  const NodeSketch* node = nullptr;
  glm::dvec3 from{0.0}, along{0.0};
  double beside = 0;   // distance of the node from the line
  double nearest = 0;  // where the line is nearest to the node

  [[nodiscard]] glm::dvec3 at(double t) const { return from + t * along; }
};

// A node that is asked for all lines of sight of a frame.
struct AskedNode {
  const NodeSketch* node;
  glm::dmat3 node_from_world;
  glm::dvec3 from;  // the frame's eye
};
// One line in the spaces of those that were asked for it.
class LineOfSight {
 public:
  explicit LineOfSight(std::span<const AskedNode> asked) : asked_(asked), rays_(asked.size()) {}

  void begin(const glm::dvec3& along) {
    along_ = along;
    for (NodeRay& ray : rays_) ray.node = nullptr;
  }
  [[nodiscard]] std::size_t size() const { return rays_.size(); }
  [[nodiscard]] const NodeRay& operator[](std::size_t k) {
    NodeRay& ray = rays_[k];
    if (ray.node) return ray;
    const AskedNode& of = asked_[k];
    ray.node = of.node;
    ray.from = of.from;
    ray.along = of.node_from_world * along_;
    ray.beside = glm::length(glm::cross(ray.from, ray.along));
    ray.nearest = -glm::dot(ray.from, ray.along);
    return ray;
  }

 private:
  std::span<const AskedNode> asked_;
  std::vector<NodeRay> rays_;
  glm::dvec3 along_{0.0};
};

// A node's four disparities around a direction.
struct Around {
  double ahead = 0;  // eye_z of the place in this direction
  std::uint16_t all[4] = {};

  // As none is negative, their order is that of the upper halves of floats.
  [[nodiscard]] double most() const { return value(std::max({all[0], all[1], all[2], all[3]})); }
  [[nodiscard]] double least() const { return value(std::min({all[0], all[1], all[2], all[3]})); }
  static double value(std::uint16_t half) {
    return double(std::bit_cast<float>(std::uint32_t(half) << 16));
  }
};

// Where a direction has a face's coordinates: to the right, and downwards.
struct FaceColumns {
  int x_axis = 0, y_axis = 0;
  double x_sign = 0, y_sign = 0;
};
std::array<FaceColumns, 6> make_face_columns() {
  std::array<FaceColumns, 6> columns;
  for (std::size_t f = 0; f < 6; ++f) {
    const FaceAxes& axes = face_axes()[f];
    for (int axis = 0; axis < 3; ++axis) {
      if (axes.right[axis] != 0) columns[f].x_axis = axis, columns[f].x_sign = axes.right[axis];
      if (axes.up[axis] != 0) columns[f].y_axis = axis, columns[f].y_sign = -axes.up[axis];
    }
  }
  return columns;
}
const std::array<FaceColumns, 6> kFaceColumns = make_face_columns();

// The face that a direction meets, and the direction by it.
struct OnFace {
  std::size_t face;
  double ahead, right, down;

  explicit OnFace(const glm::dvec3& to) {
    const glm::dvec3 size = glm::abs(to);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    face = std::size_t(2 * axis + (to[axis] < 0 ? 1 : 0)), ahead = size[axis];
    const FaceColumns& columns = kFaceColumns[face];
    right = columns.x_sign * to[columns.x_axis], down = columns.y_sign * to[columns.y_axis];
  }
};

inline Around around(const NodeSketch& node, const glm::dvec3& to) {
  const OnFace at(to);
  const Image<std::uint16_t>& of = node.disparity[at.face];
  const int last = of.width() - 1;
  const double half = 0.5 * of.width(), scale = half / std::max(at.ahead, 1e-300);
  const auto texel = [&](double to_it) {
    return std::clamp(int(half - 0.5 + scale * to_it), 0, last);
  };
  const int x = texel(at.right), y = texel(at.down);
  const int x1 = std::min(x + 1, last), y1 = std::min(y + 1, last);
  return {at.ahead, {of(x, y), of(x1, y), of(x, y1), of(x1, y1)}};
}

// Up to where is a line of sight free for certain, from t on? It may turn by kClearAngle around the
// node, as long as it is nearer than what is seen so far beside it. t if it is not known to be.
double clear_until(const NodeRay& ray, double t) {
  static const double turn = std::tan(NodeSketch::kClearAngle);
  const OnFace at(ray.at(t));
  const double half = 0.5 * NodeSketch::kClearSize, scale = half / std::max(at.ahead, 1e-300);
  const auto cell = [&](double to_it) {
    return std::clamp(int(half + scale * to_it), 0, NodeSketch::kClearSize - 1);
  };
  const double clear =
      kClearShare * double(ray.node->clear[at.face](cell(at.right), cell(at.down)));
  const double s = t - ray.nearest, b = ray.beside;
  if (!(b * b + s * s < clear * clear)) return t;
  // s = b tan(angle): b tan(angle + kClearAngle) = b (s + b turn) / (b - s turn)
  const double to_turn = b - s * turn > 0 ? b * (s + b * turn) / (b - s * turn) : INFINITY;
  return ray.nearest + std::min(to_turn, std::sqrt(clear * clear - b * b));
}

// How far a node sees beyond a place, along its line of sight; -1 if it does not see it.
double seen_beyond(const NodeSketch& node, const glm::dvec3& to) {
  const Around q = around(node, to);
  if (q.ahead == 0) return 0;  // its own place
  const double most = q.most();
  if (most == 0) return INFINITY;
  const double more = 1 / most - q.ahead;
  return more < 0 ? -1 : more * glm::length(to) / q.ahead;
}

// Has a node a surface about there? `plainly`: and no other beside it.
bool holds(const NodeSketch& node, const glm::dvec3& to, bool plainly) {
  const Around q = around(node, to);
  const double most = q.most() * q.ahead, least = q.least() * q.ahead;
  if (most <= kOneSlope * least) return most >= 1 - kAgrees && least <= 1 + kAgrees;
  return !plainly && std::any_of(std::begin(q.all), std::end(q.all), [&](std::uint16_t one) {
    return std::abs(Around::value(one) * q.ahead - 1) <= kAgrees;
  });
}

SeenPlace look(LineOfSight& rays, std::size_t drawn, double nearest) {
  std::size_t by = 0;  // the node that sees the place: most often the same as before
  double beyond = 0;
  // `except`: this node does not see it.
  const auto is_free = [&](double t, std::size_t except) {
    for (std::size_t k = 0; k < rays.size(); ++k) {
      if (k == except) continue;
      beyond = seen_beyond(*rays[k].node, rays[k].at(t));
      if (beyond >= 0) return by = k, true;
    }
    return false;
  };
  double t = nearest, before = 0;
  bool free_before = false;
  for (int step = 0; step < kMostSteps; ++step) {
    if (const double clear = clear_until(rays[by], t); clear > t) {
      if (std::isinf(clear)) break;
      free_before = true, before = t;
      // A long way has been gone, and likely another one follows.
      const bool far = clear - t > kClearStep * clear;
      t = clear;
      if (far) continue;
    }
    beyond = seen_beyond(*rays[by].node, rays[by].at(t));
    bool free = beyond >= 0;
    if (!free) {
      if (free_before && by < drawn && holds(*rays[by].node, rays[by].at(t), true))
        return {t, 1u << by};
      free = is_free(t, by);
    }
    if (!free && free_before) {
      double low = before, high = t;
      for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (is_free(middle, rays.size()) ? low : high) = middle;
      }
      std::uint32_t held = 0;
      for (std::size_t k = 0; k < rays.size(); ++k)
        if (holds(*rays[k].node, rays[k].at(low), false)) held |= 1u << k;
      if (held != 0) return {low, held};
    }
    const double r = glm::length(rays[by].at(t));
    // From here on its line of sight stays where it shows the sky.
    if (free && std::isinf(beyond) && rays[by].beside < kTurn * r) break;
    free_before = free, before = t;
    // It turns by beside / r^2 radians a metre.
    const double turns = kTurn * r * r / std::max(rays[by].beside, 1e-300);
    t += std::max(kLeastStep * std::max(r, t), free ? std::min(beyond, turns) : 0.0);
  }
  return {};
}

// Looks along lines of sight of a frame, for places_in_view().
class FrameLook {
 public:
  FrameLook(const EnvironmentNodes& nodes, const Camera& frame, std::span<const std::size_t> asked,
            std::size_t drawn)
      : frame_(frame), drawn_(drawn) {
    RILIEVO_EXPECTS(asked.size() <= 32);
    for (const std::size_t k : asked) {
      const NodeSketch& node = nodes.nodes[k];
      const glm::dmat3 node_from_world = glm::transpose(glm::dmat3(node.world_from_node));
      asked_.push_back({&node, node_from_world, node_from_world * (frame.position() - node.eye())});
    }
  }
  // What lines show, given by their numbers, into all places.
  void look_along(std::span<const int> lines, std::span<SeenPlace> places) const {
    constexpr int kPiece = kViewColumns;
    const int count = int(lines.size());
    parallel_for(0, (count + kPiece - 1) / kPiece, [&](int piece) {
      LineOfSight line(asked_);
      for (int i = piece * kPiece; i < std::min(count, (piece + 1) * kPiece); ++i) {
        const int number = lines[std::size_t(i)];
        line.begin(direction(number % kViewColumns, number / kViewColumns));
        places[std::size_t(number)] = look(line, drawn_, frame_.z_near);
      }
    });
  }

 private:
  [[nodiscard]] glm::dvec3 direction(int column, int row) const {
    const ImageWindow& w = frame_.window;
    const double u = (column + 0.5) / kViewColumns, v = (row + 0.5) / kViewRows;
    return glm::normalize(
        glm::dmat3(frame_.world_from_eye) *
        glm::dvec3(glm::mix(w.left, w.right, u), glm::mix(w.bottom, w.top, v), -1));
  }

  const Camera& frame_;
  std::size_t drawn_;
  std::vector<AskedNode> asked_;
};

// Of the places in view that none of the drawn nodes holds: first those alone that every fourth
// line of sight shows, then, as on a chessboard, those between lines that do not show one smooth
// surface, and what is connected with what lacks.
class LackingPlaces {
 public:
  LackingPlaces(const FrameLook& look, std::uint32_t drawn_ones)
      : look_(look),
        drawn_ones_(drawn_ones),
        places_(std::size_t(kViewColumns * kViewRows)),
        asked_(places_.size()) {
    std::vector<int> lines, next;
    for (int row = 0; row < kViewRows; row += 2)
      for (int column = 0; column < kViewColumns; column += 2)
        take(row * kViewColumns + column, lines);
    look_.look_along(lines, places_);
    for (const int line : lines) take_around(line, next);
    for (int row = 1; row < kViewRows; row += 2)
      for (int column = 1; column < kViewColumns; column += 2)
        if (!is_smooth(column, row)) take(row * kViewColumns + column, next);
    while (!next.empty()) {
      lines.swap(next);
      next.clear();
      look_.look_along(lines, places_);
      for (const int line : lines) take_around(line, next);
    }
  }
  // Asks all other lines.
  void ask_all() {
    std::vector<int> rest;
    for (int line = 0; line < int(places_.size()); ++line) take(line, rest);
    look_.look_along(rest, places_);
  }
  [[nodiscard]] bool lacks(std::size_t line) const {
    return places_[line].held != 0 && (places_[line].held & drawn_ones_) == 0;
  }
  // Is a place lacking that the k-th node holds?
  [[nodiscard]] bool is_filled(std::size_t line, std::size_t k) const {
    return lacks(line) && (places_[line].held >> k & 1) != 0;
  }
  [[nodiscard]] std::size_t size() const { return places_.size(); }

 private:
  void take(int line, std::vector<int>& next) {
    if (asked_[std::size_t(line)]) return;
    asked_[std::size_t(line)] = true;
    next.push_back(line);
  }
  // Do the lines diagonally beside one show about equally far places, or all of them none?
  [[nodiscard]] bool is_smooth(int column, int row) const {
    double least = INFINITY, most = 0;
    for (const int y : {row - 1, row + 1})
      for (const int x : {column - 1, column + 1}) {
        if (x >= kViewColumns || y >= kViewRows) continue;
        const double distance = places_[std::size_t(y * kViewColumns + x)].distance;
        least = std::min(least, distance), most = std::max(most, distance);
      }
    return most <= kSmooth * least;
  }
  void take_around(int line, std::vector<int>& next) {
    if (!lacks(std::size_t(line))) return;
    const int x = line % kViewColumns, y = line / kViewColumns;
    for (int row = std::max(y - 1, 0); row <= std::min(y + 1, kViewRows - 1); ++row)
      for (int column = std::max(x - 1, 0); column <= std::min(x + 1, kViewColumns - 1); ++column)
        take(row * kViewColumns + column, next);
  }

  const FrameLook& look_;
  std::uint32_t drawn_ones_;
  std::vector<SeenPlace> places_;  // nothing where no line was asked
  std::vector<bool> asked_;
};

}  // namespace

std::vector<SeenPlace> places_in_view(const EnvironmentNodes& nodes, const Camera& frame,
                                      std::span<const std::size_t> asked, std::size_t drawn) {
  std::vector<SeenPlace> places(std::size_t(kViewColumns * kViewRows));
  std::vector<int> lines(places.size());
  std::iota(lines.begin(), lines.end(), 0);
  FrameLook(nodes, frame, asked, drawn).look_along(lines, places);
  return places;
}

FrameNodes nodes_for_frame(const EnvironmentNodes& nodes, const Camera& frame, std::size_t merged,
                           bool fills) {
  FrameNodes chosen{nodes_for_eye(nodes, frame.position()), 0, {}};
  std::vector<std::size_t>& order = chosen.order;
  chosen.drawn = std::min(merged, order.size());
  const std::size_t asked = std::min(order.size(), kMostAsked);
  if (!fills || chosen.drawn >= asked || frame.projection != Projection::perspective) return chosen;
  const FrameLook look(nodes, frame, std::span(order).first(asked), chosen.drawn);
  LackingPlaces places(look, (1u << chosen.drawn) - 1);
  // A farther node has larger texels, and fewer highlights in common with the others: what it adds
  // counts less, by the square root of its distance.
  const auto distance = [&](std::size_t k) {
    return glm::distance(nodes.nodes[order[k]].eye(), frame.position());
  };
  const double usual = distance(chosen.drawn - 1), least = kLeastFilled * double(places.size());
  std::size_t best = 0;
  double most = 0;
  const auto find_best = [&] {
    most = 0;
    for (std::size_t k = chosen.drawn; k < asked && sees(nodes.nodes[order[k]], frame.position());
         ++k) {
      int adds = 0;
      for (std::size_t i = 0; i < places.size(); ++i) adds += places.is_filled(i, k);
      const double score = double(adds) * std::sqrt(usual / std::max(distance(k), 1e-300));
      if (score > most) most = score, best = k;
    }
  };
  find_best();
  // Specks of one line of sight are met one time in four: there may be more than was found.
  if (most < least && 2 * most >= least) {
    places.ask_all();
    find_best();
  }
  if (most == 0) return chosen;
  // It is loaded before it is needed.
  const auto at = order.begin() + std::ptrdiff_t(chosen.drawn),
             from = order.begin() + std::ptrdiff_t(best);
  std::rotate(at, from, from + 1);
  if (most < least) return chosen;
  ++chosen.drawn;
  for (std::size_t i = 0; i < places.size(); ++i)
    chosen.filled.marked[i] = places.is_filled(i, best);
  return chosen;
}

}  // namespace rilievo
