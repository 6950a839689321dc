#include "rilievo/environment_nodes/cube_edges.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace rilievo {
namespace {

// Texels in a ring around a corner, and the gates from each to the next.
struct Ring {
  int count = 0;
  float value[4];
  bool cut[4];
  std::uint8_t copy[4];
};

// One value for texels that are linked. A single cut gate parts nothing: it ends here.
void share_values(Ring& ring) {
  const int cuts = int(std::count(ring.cut, ring.cut + ring.count, true));
  int start = 0;
  if (cuts > 1)
    while (!ring.cut[(start + ring.count - 1) % ring.count]) ++start;
  std::uint8_t copy = 0;
  for (int k = 0; k < ring.count;) {
    float sum = 0;
    int members = 0;
    do {
      sum += ring.value[(start + k + members) % ring.count];
      ++members;
    } while (k + members < ring.count &&
             (cuts <= 1 || !ring.cut[(start + k + members - 1) % ring.count]));
    for (int m = 0; m < members; ++m) {
      ring.value[(start + k + m) % ring.count] = sum / float(members);
      ring.copy[(start + k + m) % ring.count] = copy;
    }
    ++copy;
    k += members;
  }
}

}  // namespace

CubeEdges::CubeEdges(const CubeGrid& grid) : grid_(grid) {
  for (int f = 0; f < 6; ++f)
    for (int side = 0; side < 4; ++side) {
      const SideTexel first = grid.across({f, side, 0}), second = grid.across({f, side, 1});
      if (first.face < f) continue;
      CubeEdge edge;
      edge.side[0] = {f, side, 0};
      edge.side[1] = first;
      edge.reversed = second.along < first.along;
      measure(edge);
      edges_.push_back(std::move(edge));
    }
  mend_corners();
  const int n = grid.size();
  for (CubeEdge& edge : edges_)
    for (int k = 0; k <= n; ++k) {
      const auto cut = [&](int along) {
        return grid.cut_border({edge.side[0].face, edge.side[0].side, along});
      };
      const Place& p = edge.places[std::size_t(k)];
      const bool ends = k == 0 || k == n || cut(k - 1) != cut(k) ||
                        p.copy_before[0] != p.copy_after[0] || p.copy_before[1] != p.copy_after[1];
      if (ends) edge.chosen.push_back(k);
    }
  // A gate that is cut within a face ends a chain at the edge even if it parts nothing there.
  for (CubeEdge& edge : edges_) {
    std::vector<int> all = edge.chosen;
    for (int which = 0; which < 2; ++which)
      for (int k = 1; k < n; ++k) {
        const SideTexel& s = edge.side[which];
        const int there = which == 1 && edge.reversed ? n - k : k;
        const glm::ivec2 a = grid.side_texel(s.side, there - 1);
        const bool cut =
            (s.side & 1) ? grid.cut_below(s.face, a.x, a.y) : grid.cut_right(s.face, a.x, a.y);
        if (cut) all.push_back(k);
      }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    edge.chosen = std::move(all);
  }
}

// Places between the corners of the cube; those come after, with mend_corners().
void CubeEdges::measure(CubeEdge& edge) {
  const int n = grid_.size();
  edge.places.resize(std::size_t(n) + 1);
  for (int k = 1; k < n; ++k) {
    // before[0], after[0], after[1], before[1].
    Ring ring;
    ring.count = 4;
    bool inner_cut[2];
    for (int which = 0; which < 2; ++which) {
      const SideTexel& s = edge.side[which];
      const bool reversed = which == 1 && edge.reversed;
      const int there = reversed ? n - k : k;
      const glm::ivec2 corner = grid_.side_corner(s.side, there);
      const glm::ivec2 low = grid_.side_texel(s.side, there - 1),
                       high = grid_.side_texel(s.side, there);
      inner_cut[which] = (s.side & 1) ? grid_.cut_below(s.face, low.x, low.y)
                                      : grid_.cut_right(s.face, low.x, low.y);
      const float of_low = grid_.continued(s.face, low, corner);
      const float of_high = grid_.continued(s.face, high, corner);
      ring.value[which == 0 ? 0 : 3] = reversed ? of_high : of_low;
      ring.value[which == 0 ? 1 : 2] = reversed ? of_low : of_high;
    }
    const auto border = [&](int along) {
      return grid_.cut_border({edge.side[0].face, edge.side[0].side, along});
    };
    ring.cut[0] = inner_cut[0], ring.cut[1] = border(k);
    ring.cut[2] = inner_cut[1], ring.cut[3] = border(k - 1);
    share_values(ring);
    Place& p = edge.places[std::size_t(k)];
    p.before[0] = ring.value[0], p.after[0] = ring.value[1];
    p.after[1] = ring.value[2], p.before[1] = ring.value[3];
    p.copy_before[0] = ring.copy[0], p.copy_after[0] = ring.copy[1];
    p.copy_after[1] = ring.copy[2], p.copy_before[1] = ring.copy[3];
  }
}

// At a corner of the cube three texels meet, of three faces.
void CubeEdges::mend_corners() {
  const int n = grid_.size();
  struct End {
    CubeEdge* edge;
    int place;
  };
  std::map<std::tuple<int, int, int>, std::vector<End>> corners;
  for (CubeEdge& edge : edges_)
    for (const int place : {0, n}) {
      const SideTexel& s = edge.side[0];
      const glm::ivec3 key = grid_.key(s.face, grid_.side_corner(s.side, place));
      corners[{key.x, key.y, key.z}].push_back({&edge, place});
    }
  for (auto& [key, ends] : corners) {
    const glm::ivec3 point(std::get<0>(key), std::get<1>(key), std::get<2>(key));
    // Faces in a ring: the first edge's two, then the third one.
    int faces[3] = {ends[0].edge->side[0].face, ends[0].edge->side[1].face, 0};
    for (const End& end : ends)
      for (const SideTexel& s : end.edge->side)
        if (s.face != faces[0] && s.face != faces[1]) faces[2] = s.face;
    Ring ring;
    ring.count = 3;
    for (int k = 0; k < 3; ++k) {
      const glm::ivec2 at = grid_.half(faces[k], point);
      const glm::ivec2 texel = glm::min(at / 2, glm::ivec2(n - 1));
      ring.value[k] = grid_.continued(faces[k], texel, at);
      const int next = faces[(k + 1) % 3];
      for (const End& end : ends) {
        const SideTexel& a = end.edge->side[0];
        const SideTexel& b = end.edge->side[1];
        if ((a.face == faces[k] && b.face == next) || (b.face == faces[k] && a.face == next))
          ring.cut[k] = grid_.cut_border({a.face, a.side, std::min(end.place, n - 1)});
      }
    }
    share_values(ring);
    for (const End& end : ends)
      for (int which = 0; which < 2; ++which)
        for (int k = 0; k < 3; ++k) {
          if (faces[k] != end.edge->side[which].face) continue;
          Place& p = end.edge->places[std::size_t(end.place)];
          p.before[which] = p.after[which] = ring.value[k];
          p.copy_before[which] = p.copy_after[which] = ring.copy[k];
        }
  }
}

BorderPoint CubeEdges::seen_by(const CubeEdge& edge, int which, int place) const {
  const int n = grid_.size();
  const SideTexel& s = edge.side[which];
  const bool reversed = which == 1 && edge.reversed;
  BorderPoint point;
  point.at = grid_.side_corner(s.side, reversed ? n - place : place);
  const Place& p = edge.places[std::size_t(place)];
  // Along the face's own counting: what lies on lower places, and on higher ones. Looking inwards
  // from the top or the right side ... the lines that end here point into the face: on its left
  // (counter-clockwise, y down) lie lower places of the top and higher ones of the left, and so
  // on.
  const float low = reversed ? p.after[which] : p.before[which];
  const float high = reversed ? p.before[which] : p.after[which];
  const std::uint8_t copy_low = reversed ? p.copy_after[which] : p.copy_before[which];
  const std::uint8_t copy_high = reversed ? p.copy_before[which] : p.copy_after[which];
  // A line downwards from the top, (0, 1): cross((0, 1), (-1, 0)) = 1, so lower x is its left. From
  // the right, (-1, 0): cross((-1, 0), (0, -1)) = 1, lower y. From the bottom (0, -1): higher x.
  // From the left (1, 0): higher y.
  const bool left_is_low = s.side == 0 || s.side == 1;
  point.left = left_is_low ? low : high;
  point.right = left_is_low ? high : low;
  point.left_copy = left_is_low ? copy_low : copy_high;
  point.right_copy = left_is_low ? copy_high : copy_low;
  return point;
}

std::vector<BorderPoint> CubeEdges::required(int face) const {
  std::vector<BorderPoint> points;
  for (const CubeEdge& edge : edges_)
    for (int which = 0; which < 2; ++which) {
      if (edge.side[which].face != face) continue;
      for (const int place : edge.chosen) points.push_back(seen_by(edge, which, place));
    }
  return points;
}

void CubeEdges::choose(const CubeEdge& edge, int from, int to, float error,
                       std::vector<int>& added) const {
  if (to - from < 2) return;
  float worst = error;
  int place = -1;
  for (int which = 0; which < 2; ++which) {
    const float a = edge.places[std::size_t(from)].after[which];
    const float b = edge.places[std::size_t(to)].before[which];
    if (a < 0 || b < 0) continue;
    const float step = (b - a) / float(to - from);
    for (int k = from + 1; k < to; ++k) {
      const float here = edge.places[std::size_t(k)].before[which];
      const float wrong = std::abs(here - (a + step * float(k - from)));
      if (here >= 0 && wrong > worst) worst = wrong, place = k;
    }
  }
  if (place < 0) return;
  choose(edge, from, place, error, added);
  added.push_back(place);
  choose(edge, place, to, error, added);
}

std::size_t CubeEdges::count(float error) const {
  std::size_t all = 0;
  for (const CubeEdge& edge : edges_) {
    std::vector<int> added;
    for (std::size_t i = 0; i + 1 < edge.chosen.size(); ++i)
      choose(edge, edge.chosen[i], edge.chosen[i + 1], error, added);
    all += added.size();
  }
  return all;
}

void CubeEdges::refine(float error, std::array<FaceMesh*, 6> faces) {
  for (CubeEdge& edge : edges_) {
    std::vector<int> added;
    for (std::size_t i = 0; i + 1 < edge.chosen.size(); ++i)
      choose(edge, edge.chosen[i], edge.chosen[i + 1], error, added);
    for (const int place : added)
      for (int which = 0; which < 2; ++which)
        faces[std::size_t(edge.side[which].face)]->add_border(seen_by(edge, which, place));
    edge.chosen.insert(edge.chosen.end(), added.begin(), added.end());
    std::sort(edge.chosen.begin(), edge.chosen.end());
  }
}

}  // namespace rilievo
