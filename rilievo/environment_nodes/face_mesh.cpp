// Greedy insertion, as [Garland, Heckbert 1995] have it for height fields: a queue of triangles by
// their worst texel; the worst of all becomes a point; triangles that changed are scanned once.
#include "rilievo/environment_nodes/face_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rilievo {
namespace {

std::int64_t cross(const glm::ivec2& a, const glm::ivec2& b) {
  return std::int64_t(a.x) * b.y - std::int64_t(a.y) * b.x;
}

// Does `d` point between `a` and, counter-clockwise from there, `b`?
bool between(const glm::ivec2& a, const glm::ivec2& b, const glm::ivec2& d) {
  const std::int64_t ab = cross(a, b);
  if (ab > 0) return cross(a, d) > 0 && cross(d, b) > 0;
  return !(cross(b, d) >= 0 && cross(d, a) >= 0);
}

// Order by angle, exactly.
bool turns_before(const glm::ivec2& a, const glm::ivec2& b) {
  const auto half = [](const glm::ivec2& v) { return v.y < 0 || (v.y == 0 && v.x < 0); };
  if (half(a) != half(b)) return half(a) < half(b);
  return cross(a, b) > 0;
}

int floor_div(std::int64_t a, std::int64_t b) {  // b > 0
  const std::int64_t q = a / b;
  return int(q - (a % b < 0));
}

// The largest |row[x] - (first + step (x - from))| over x in [from, to], as its bits: of numbers
// that are not negative these are in the same order, and whole numbers need no care about NaN.
std::int32_t largest_error(const float* row, int from, int to, float first, float step) {
  std::int32_t largest = 0;
  const int count = to - from + 1;
  for (int k = 0; k < count; ++k) {
    const float error = row[from + k] - (first + step * float(k));
    largest = std::max(largest, std::bit_cast<std::int32_t>(error) & 0x7FFFFFFF);
  }
  return largest;
}

}  // namespace

FaceMesh::FaceMesh(const CubeGrid& grid, int face, std::span<const Silhouette> silhouettes,
                   std::span<const BorderPoint> border)
    : grid_(grid), face_(face), mesh_(2 * grid.size()) {
  value_.resize(4);
  joint_of_.resize(4, -1);
  std::vector<std::uint32_t> border_points;
  for (const BorderPoint& point : border) border_points.push_back(add_joint(point.at));
  std::vector<std::uint32_t> inner;
  std::vector<std::array<std::uint32_t, 2>> lines;
  for (const Silhouette& s : silhouettes) {
    std::uint32_t last = add_joint(s.line.front());
    inner.push_back(last);
    for (std::size_t i = 1; i < s.line.size(); ++i) {
      const std::uint32_t next = add_joint(s.line[i]);
      inner.push_back(next);
      const glm::ivec2 step = s.line[i] - s.line[i - 1];
      Joint& a = joints_[std::size_t(joint_of_[last])];
      if (a.spokes < 4) a.spoke[a.spokes++] = step;
      Joint& b = joints_[std::size_t(joint_of_[next])];
      if (b.spokes < 4) b.spoke[b.spokes++] = -step;
      lines.push_back({last, next});
      last = next;
    }
  }
  for (const auto& [from, to] : lines) {
    [[maybe_unused]] const bool fits = mesh_.constrain(from, to);
    RILIEVO_EXPECTS(fits);
  }
  for (std::size_t i = 0; i < border.size(); ++i) finish_joint(border_points[i], &border[i]);
  std::sort(inner.begin(), inner.end());
  inner.erase(std::unique(inner.begin(), inner.end()), inner.end());
  for (const std::uint32_t point : inner)
    if (!joints_[std::size_t(joint_of_[point])].border) finish_joint(point, nullptr);
  // Every triangle is new.
  worst_.resize(mesh_.triangles().size());
  shown_.resize(mesh_.triangles().size());
  mesh_.clear_changed();
  for (std::uint32_t t = 0; t < mesh_.triangles().size(); ++t) scan(t);
}

std::uint32_t FaceMesh::add_joint(const glm::ivec2& at) {
  // Lines come one after the other: what was made last is near.
  const std::uint32_t hint = std::uint32_t(mesh_.triangles().size()) - 1;
  const std::uint32_t point = mesh_.insert(at, hint);
  if (point >= joint_of_.size()) {
    joint_of_.resize(point + 1, -1);
    value_.resize(point + 1);
  }
  if (joint_of_[point] < 0) {
    joint_of_[point] = std::int32_t(joints_.size());
    joints_.emplace_back();
    const int end = 2 * grid_.size();
    joints_.back().border = at.x == 0 || at.y == 0 || at.x == end || at.y == end;
  }
  return point;
}

int FaceMesh::sector_of(const Joint& joint, const glm::ivec2& towards) const {
  if (joint.border) return joint.spokes > 0 && cross(joint.spoke[0], towards) < 0 ? 1 : 0;
  for (int s = 0; s + 1 < joint.spokes; ++s)
    if (between(joint.spoke[s], joint.spoke[s + 1], towards)) return s;
  return std::max(0, joint.spokes - 1);
}

void FaceMesh::finish_joint(std::uint32_t point, const BorderPoint* border) {
  Joint& joint = joints_[std::size_t(joint_of_[point])];
  const glm::ivec2 at = mesh_.points()[point];
  std::sort(joint.spoke, joint.spoke + joint.spokes, turns_before);
  // A line that ends within a surface parts nothing there.
  if (!joint.border && joint.spokes == 1) joint.spokes = 0;
  const int sectors = joint.border ? (joint.spokes > 0 ? 2 : 1) : std::max(1, joint.spokes);
  // Each texel around tells what its sector shows.
  int told[4] = {};
  glm::vec2 anchors[4] = {};
  const int n = grid_.size();
  for (const int dy : {-1, 0, 1})
    for (const int dx : {-1, 0, 1}) {
      const glm::ivec2 centre = at + glm::ivec2(dx, dy);
      if (!(centre.x & 1) || !(centre.y & 1)) continue;
      const glm::ivec2 texel{(centre.x - 1) / 2, (centre.y - 1) / 2};
      if (centre.x < 0 || centre.y < 0 || texel.x >= n || texel.y >= n) continue;
      const int s = sector_of(joint, {dx, dy});
      joint.sector[s].disparity += grid_.continued(face_, texel, at);
      anchors[s] += glm::vec2(centre);
      ++told[s];
    }
  for (int s = 0; s < sectors; ++s) {
    Corner& sector = joint.sector[s];
    if (told[s]) {
      sector.disparity /= float(told[s]);
      // As far again: at the silhouette itself colours are mixed.
      const glm::vec2 inwards = anchors[s] / float(told[s]) - glm::vec2(at);
      sector.anchor = glm::vec2(at) + 2.0f * inwards;
    }
    sector.copy = s;
    if (border) {
      const bool left = joint.spokes == 0 || s == 0;
      sector.disparity = left ? border->left : border->right;
      sector.copy = left ? border->left_copy : border->right_copy;
    }
  }
  value_[point] = joint.sector[0].disparity;
}

FaceMesh::Corner FaceMesh::corner(std::uint32_t triangle, int i) const {
  const Delaunay::Triangle& t = mesh_.triangles()[triangle];
  const std::uint32_t point = t.v[i];
  const glm::ivec2 at = mesh_.points()[point];
  if (joint_of_[point] < 0) return {value_[point], 0, glm::vec2(at)};
  const Joint& joint = joints_[std::size_t(joint_of_[point])];
  if (joint.spokes == 0) return joint.sector[0];
  const glm::ivec2 towards =
      mesh_.points()[t.v[(i + 1) % 3]] + mesh_.points()[t.v[(i + 2) % 3]] - 2 * at;
  return joint.sector[sector_of(joint, towards)];
}

int FaceMesh::copies(std::uint32_t point) const {
  if (joint_of_[point] < 0) return 1;
  const Joint& joint = joints_[std::size_t(joint_of_[point])];
  return joint.border ? 4 : std::max(1, joint.spokes);
}

void FaceMesh::add_border(const BorderPoint& point) {
  const std::uint32_t index = add_joint(point.at);
  finish_joint(index, &point);
  scan_changed();
}

void FaceMesh::scan_changed() {
  worst_.resize(mesh_.triangles().size());
  shown_.resize(mesh_.triangles().size());
  for (const std::uint32_t t : mesh_.changed()) scan(t);
  mesh_.clear_changed();
}

void FaceMesh::scan(std::uint32_t triangle) {
  const Delaunay::Triangle& t = mesh_.triangles()[triangle];
  Worst& worst = worst_[triangle];
  worst = {0, 0, 0, worst.stamp + 1};
  glm::ivec2 p[3];
  float d[3];
  bool shown = true;
  for (int i = 0; i < 3; ++i) {
    p[i] = mesh_.points()[t.v[i]];
    d[i] = joint_of_[t.v[i]] < 0 ? value_[t.v[i]] : corner(triangle, i).disparity;
    shown = shown && d[i] >= 0;
  }
  shown_count_ += std::size_t(shown) - std::size_t(shown_[triangle]);
  shown_[triangle] = shown;
  if (!shown) return;

  // d = d0 + gx (X - X0) + gy (Y - Y0), half texels.
  const glm::ivec2 u = p[1] - p[0], v = p[2] - p[0];
  const double area = double(cross(u, v));
  const double du = double(d[1]) - d[0], dv = double(d[2]) - d[0];
  const double gx = (du * v.y - dv * u.y) / area, gy = (dv * u.x - du * v.x) / area;
  const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
  const Image<float>& disparity = grid_.disparity(face_);
  std::int32_t largest = 0;
  for (int y = low / 2; 2 * y + 1 <= high; ++y) {
    const int row_y = 2 * y + 1;
    if (row_y < low) continue;
    // Inside: cross(e, (X, Y) - a) >= 0 for each edge e from a, so -e.y X >= e.y ... bounds X.
    std::int64_t from = -1, to = 2 * std::int64_t(grid_.size());
    bool empty = false;
    for (int i = 0; i < 3; ++i) {
      const glm::ivec2 a = p[i], e = p[(i + 1) % 3] - a;
      const std::int64_t c = std::int64_t(e.x) * (row_y - a.y) + std::int64_t(e.y) * a.x;
      if (e.y < 0)  // -e.y X >= -c
        from = std::max<std::int64_t>(from, -std::int64_t(floor_div(c, -std::int64_t(e.y))));
      else if (e.y > 0)  // e.y X <= c
        to = std::min<std::int64_t>(to, floor_div(c, e.y));
      else if (c < 0)
        empty = true;
    }
    if (empty) continue;
    // Odd ones only.
    const int first = int((std::max<std::int64_t>(from, 0)) / 2), last = int((to - 1) >> 1);
    const int x0 = 2 * first + 1 >= from ? first : first + 1;
    const int x1 = std::min(last, grid_.size() - 1);
    if (x0 > x1) continue;
    const float start = float(d[0] + gx * (2 * x0 + 1 - p[0].x) + gy * (row_y - p[0].y));
    const float step = float(2 * gx);
    const float* row = disparity.row(y).data();
    const std::int32_t here = largest_error(row, x0, x1, start, step);
    if (here <= largest) continue;
    largest = here;
    worst.y = y;
    for (int x = x0; x <= x1; ++x)
      if (largest_error(row, x, x, start + step * float(x - x0), 0) == here) {
        worst.x = x;
        break;
      }
  }
  worst.error = std::bit_cast<float>(largest);
  // What floats cannot tell from right.
  if (worst.error <= 1e-6f * std::max({d[0], d[1], d[2]})) worst.error = 0;
  if (worst.error == 0) return;
  queue_.push_back({worst.error, triangle, worst.stamp});
  std::push_heap(queue_.begin(), queue_.end());
}

void FaceMesh::refine(float error, std::size_t most, std::vector<float>* errors) {
  for (std::size_t added = 0; added < most;) {
    while (!queue_.empty() && worst_[queue_.front().triangle].stamp != queue_.front().stamp) {
      std::pop_heap(queue_.begin(), queue_.end());
      queue_.pop_back();
    }
    if (queue_.empty() || queue_.front().error <= error) return;
    const Candidate top = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end());
    queue_.pop_back();
    const Worst at = worst_[top.triangle];
    const std::uint32_t before = std::uint32_t(mesh_.points().size());
    const std::uint32_t point = mesh_.insert({2 * at.x + 1, 2 * at.y + 1}, top.triangle);
    if (point < before) continue;  // it was there: nothing to be gained
    value_.push_back(grid_.at(face_, {at.x, at.y}));
    joint_of_.push_back(-1);
    if (errors) errors->push_back(top.error);
    ++added;
    scan_changed();
  }
}

float FaceMesh::worst_error() const {
  float worst = 0;
  for (const Worst& w : worst_) worst = std::max(worst, w.error);
  return worst;
}

std::size_t FaceMesh::count_triangles() const { return shown_count_; }

}  // namespace rilievo
