#include "rilievo/layered_relief/prewarp_runs.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

struct Interval {
  double low, high;
};

// Where positions [from, to] at displacements d0 ... d1 land along one axis. (u + k d) / (1 + k3 d)
// is monotone in u and, for a fixed u, in d.
Interval moved(double from, double to, double k, double k3, double d0, double d1) {
  const double w0 = 1 / (1 + k3 * d0), w1 = 1 / (1 + k3 * d1);
  return {std::min((from + k * d0) * w0, (from + k * d1) * w1),
          std::max((to + k * d0) * w0, (to + k * d1) * w1)};
}

class Search {
 public:
  Search(const LayeredRelief& relief, const ReliefWarp& warp, const RunQuery& query,
         std::vector<PrewarpRun>& runs)
      : relief_(relief),
        warp_(warp),
        query_(query),
        runs_(runs),
        most_half_(query.half_splat * splat_stretch(query.most_slope)) {}

  void descend(const Sheet& sheet, std::size_t node, int level, int x, int y);

 private:
  void add_tile(const Sheet& sheet, const ReliefNode& node, int x, int y);
  [[nodiscard]] SplatReach reach(const ReliefNode& node, const glm::dvec2& half) const;
  [[nodiscard]] glm::dvec2 half_splat(double u, double v, double d) const;
  // Of what is drawn of it.
  [[nodiscard]] double nearest_d(const ReliefNode& node) const {
    return relief_.d(std::max<std::uint32_t>(node.nearest, query_.least_code));
  }

  const LayeredRelief& relief_;
  const ReliefWarp& warp_;
  const RunQuery& query_;
  std::vector<PrewarpRun>& runs_;
  double most_half_;  // of a splat, source texels
};

// Node at column x and row y of the nodes of its level; the last level is relief_.levels - 1.
void Search::descend(const Sheet& sheet, std::size_t node, int level, int x, int y) {
  const ReliefNode& stretch = relief_.tree[node];
  if (stretch.empty() || stretch.farthest < query_.least_code) return;
  const int size = relief_.tile_size << (relief_.levels - 1 - level);
  const int u0 = std::max(x * size, sheet.u_from), u1 = std::min((x + 1) * size, sheet.u_to);
  const int v0 = std::max(y * size, sheet.v_from), v1 = std::min((y + 1) * size, sheet.v_to);
  if (u0 >= u1 || v0 >= v1) return;
  const double beyond = most_half_ - 0.5;
  const double d0 = nearest_d(stretch), d1 = relief_.d(stretch.farthest);
  const Interval u = moved(u0 - beyond, u1 + beyond, warp_.k1, warp_.k3, d0, d1);
  const Interval v = moved(v0 - beyond, v1 + beyond, warp_.k2, warp_.k3, d0, d1);
  if (u.high <= query_.min.x || u.low >= query_.max.x || v.high <= query_.min.y ||
      v.low >= query_.max.y)
    return;
  if (level == relief_.levels - 1) {
    add_tile(sheet, stretch, x, y);
    return;
  }
  for (unsigned i = 0; i < 4; ++i) {
    const unsigned child = i ^ sheet.order;
    descend(sheet, 4 * node + 1 + child, level + 1, 2 * x + int(child & 1),
            2 * y + int(child >> 1));
  }
}

// Half of the splats of samples at a place of the source. The slope is that where it is seen; of a
// place beyond the samples, as tiles at the picture's border have, no more than theirs.
glm::dvec2 Search::half_splat(double u, double v, double d) const {
  if (query_.most_slope == 0) return glm::dvec2(query_.half_splat);
  glm::dvec2 slope = (warp_.moved(u, v, d) - warp_.epipole()) * query_.slope_per_texel;
  slope *= std::min(1.0, query_.most_slope / std::max(glm::length(slope), 1e-30));
  return query_.half_splat * glm::dvec2(splat_stretch(slope.x), splat_stretch(slope.y));
}

SplatReach Search::reach(const ReliefNode& node, const glm::dvec2& half) const {
  if (query_.nearest) return SplatReach::nearest;
  const double largest =
      2 * std::max(half.x, half.y) * query_.resolution *
      std::max(warp_.magnification(nearest_d(node)), warp_.magnification(relief_.d(node.farthest)));
  // An interval shorter than one holds at most one centre; a little is left for rounding.
  if (largest < 0.999) return SplatReach::one;
  return largest < 3.999 ? SplatReach::few : SplatReach::many;
}

void Search::add_tile(const Sheet& sheet, const ReliefNode& node, int x, int y) {
  const int size = relief_.tile_size, u0 = x * size, v0 = y * size;
  const std::size_t tile = std::size_t(y) * std::size_t(relief_.tiles_x) + std::size_t(x);
  const std::uint32_t* rows = &relief_.rows[tile * std::size_t(size + 1)];
  int row = std::max(sheet.v_from - v0, 0), last = std::min(sheet.v_to - v0, size);
  // Rows that do not reach the rectangle are left out.
  const double beyond = most_half_ - 0.5;
  const double d0 = nearest_d(node), d1 = relief_.d(node.farthest);
  const auto misses = [&](int v) {
    const Interval at = moved(v0 + v - beyond, v0 + v + 1 + beyond, warp_.k2, warp_.k3, d0, d1);
    return at.high <= query_.min.y || at.low >= query_.max.y;
  };
  while (row < last && misses(row)) ++row;
  while (row < last && misses(last - 1)) --last;
  const std::uint32_t count = relief_.first[tile + 1] - relief_.first[tile];
  const bool up = sheet.order & kDescendingV;
  const std::uint32_t from = up ? count - rows[last] : rows[row];
  const std::uint32_t to = up ? count - rows[row] : rows[last];
  if (from >= to) return;
  PrewarpRun run;
  run.samples = relief_.streams[sheet.order].data() + relief_.first[tile] + from;
  run.count = to - from;
  run.u = float(u0), run.v = float(v0);
  run.u_from = std::uint32_t(std::max(sheet.u_from - u0, 0));
  run.u_to = std::uint32_t(std::min(sheet.u_to - u0, size));
  run.all_columns =
      run.u_from == 0 && (run.u_to == std::uint32_t(size) || sheet.u_to == relief_.camera.width);
  const glm::dvec2 half = half_splat(u0 + 0.5 * size, v0 + 0.5 * size, 0.5 * (d0 + d1));
  run.half_x = float(half.x), run.half_y = float(half.y);
  run.reach = reach(node, half);
  runs_.push_back(run);
}

}  // namespace

std::vector<Sheet> sheets_of(const LayeredRelief& relief, const ReliefWarp& warp) {
  const int w = relief.camera.width, h = relief.camera.height;
  // The first texel whose centre lies at or beyond the epipole.
  const auto split = [](double epipole, int size) {
    return int(std::clamp(std::ceil(epipole - 0.5), 0.0, double(size)));
  };
  const int u = split(warp.epipole().x, w), v = split(warp.epipole().y, h);
  std::vector<Sheet> sheets;
  for (unsigned order = 0; order < 4; ++order) {
    Sheet sheet{0, u, 0, v, order};
    if (order & kDescendingU) sheet.u_from = u, sheet.u_to = w;
    if (order & kDescendingV) sheet.v_from = v, sheet.v_to = h;
    if (warp.k3 < 0) sheet.order ^= kDescendingU | kDescendingV;
    if (sheet.u_from < sheet.u_to && sheet.v_from < sheet.v_to) sheets.push_back(sheet);
  }
  return sheets;
}

void find_runs(const LayeredRelief& relief, const ReliefWarp& warp,
               const std::vector<Sheet>& sheets, const RunQuery& query,
               std::vector<PrewarpRun>& runs) {
  Search search(relief, warp, query, runs);
  for (const Sheet& sheet : sheets) search.descend(sheet, 0, 0, 0, 0);
}

}  // namespace rilievo
