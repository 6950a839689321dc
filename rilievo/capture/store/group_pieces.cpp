#include "rilievo/capture/store/group_pieces.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

namespace rilievo {

PieceGroups group_pieces(const std::vector<double>& seconds, int count) {
  const int pieces = std::clamp(count, 1, std::max(1, int(seconds.size())));
  std::vector<int> order(seconds.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return seconds[std::size_t(a)] > seconds[std::size_t(b)]; });
  using Load = std::pair<double, int>;  // seconds, piece
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (int p = 0; p < pieces; ++p) loads.emplace(0.0, p);
  PieceGroups groups;
  groups.pictures.resize(std::size_t(pieces));
  groups.seconds.resize(std::size_t(pieces));
  for (const int picture : order) {
    const auto [load, piece] = loads.top();
    loads.pop();
    const double more = load + seconds[std::size_t(picture)];
    groups.pictures[std::size_t(piece)].push_back(picture);
    groups.seconds[std::size_t(piece)] = more;
    loads.emplace(more, piece);
  }
  for (std::vector<int>& of : groups.pictures) std::sort(of.begin(), of.end());
  const double mean =
      std::accumulate(groups.seconds.begin(), groups.seconds.end(), 0.0) / double(pieces);
  if (!(mean > 0)) return groups;
  const auto [least, most] = std::minmax_element(groups.seconds.begin(), groups.seconds.end());
  groups.least = *least / mean, groups.most = *most / mean;
  return groups;
}

PieceGroups even_pieces(const std::vector<double>& seconds, double uneven) {
  for (int count = int(seconds.size()); count > 1; --count) {
    PieceGroups groups = group_pieces(seconds, count);
    if (groups.least >= 1 - uneven && groups.most <= 1 + uneven) return groups;
  }
  return group_pieces(seconds, 1);
}

}  // namespace rilievo
