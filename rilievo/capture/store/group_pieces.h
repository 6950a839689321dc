// Pictures of different cost as pieces that take about as long as each other.
#pragma once

#include <vector>

namespace rilievo {

// Pieces of several pictures each, and how even they are.
struct PieceGroups {
  std::vector<std::vector<int>> pictures;  // of each piece, ascending; every picture once
  std::vector<double> seconds;             // of each piece
  double least = 1, most = 1;              // of them, as shares of the mean
};

// At most `count` pieces (at least one) of pictures that take so long each: the longest first, each
// to the piece that has the least so far.
[[nodiscard]] PieceGroups group_pieces(const std::vector<double>& seconds, int count);

// As many pieces as can be when none is off the mean by more than a share of `uneven`.
[[nodiscard]] PieceGroups even_pieces(const std::vector<double>& seconds, double uneven);

}  // namespace rilievo
