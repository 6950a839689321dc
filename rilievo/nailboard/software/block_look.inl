// Is there anything of a board to draw in a block of pixels? For compose_tile.cpp, within its
// namespace: compiled once for each instruction set. Internal: not a stable interface.

// Affine over the tile.
struct Plane {
  float at, per_x, per_y;
};

// A nailboard over one tile, with `at` at the tile's corner.
struct Board {
  const PlacedNailboard& placed;
  const SoftwareNailboard& picture;
  Plane u, v, w;
};

// A block's planes, its texels, and what is known of it.
struct Patch {
  float u, v, w;                // at its upper left corner
  bool inside = false;          // all of it is, and no colour comes from beyond the picture's edge
  bool opaque = false;          // all its texels are
  float low_u = 0, high_v = 0;  // of its texels, if its corners were looked at
  Reach reach = Reach::any;     // of the texels of a row of its pixels
};

// How far do texels lie apart in rows of the block's pixels? Between two pixels of a row, u changes
// by no more than at the block's upper and lower edges: within 7/8 of that and the square of the
// ratio of w, which bounds how much du/dx varies; and what u(y) of an edge is off a straight line,
// which is a quarter of its change by that ratio less 1, for both edges.
HWY_INLINE Reach find_reach(const float (&u)[4], const float (&v)[4], float range_u, float range_v,
                            float w_ratio) {
  constexpr float kSlack = 1.0f / 64;  // rounded otherwise than the pixels
  const auto most = [&](const float(&a)[4], float range) {
    const float edges = std::max(std::abs(a[1] - a[0]), std::abs(a[3] - a[2]));
    return (0.875f * edges + 0.5f * range * (w_ratio - 1)) * w_ratio * w_ratio + kSlack;
  };
  const float across = most(u, range_u), down = most(v, range_v);
  if (across < float(kBlock - 1) && down < 2) return down < 1 ? Reach::block : Reach::steep;
  return across < float(kSpan - 2) && down < 1 ? Reach::span : Reach::any;
}

alignas(16) constexpr float kCornerX[4] = {0, kBlock, 0, kBlock}, kCornerY[4] = {0, 0, kBlock,
                                                                                 kBlock};

// Looks at the block's corners and at the cells between them: is there anything to draw?
HWY_INLINE bool look_at_block(const Board& board, FrameTile& tile, int block, Patch& patch) {
  const SoftwareNailboard& picture = board.picture;
  const PlacedNailboard& placed = board.placed;
  HWY_ALIGN float u[4], v[4], w[4];
  const hn::CappedTag<float, 4> corners;
  const auto at_corners = [&](float at, const Plane& plane, int i) {
    const auto x = hn::Load(corners, kCornerX + i), y = hn::Load(corners, kCornerY + i);
    return hn::Add(hn::Set(corners, at), hn::Add(hn::Mul(x, hn::Set(corners, plane.per_x)),
                                                 hn::Mul(y, hn::Set(corners, plane.per_y))));
  };
  for (int i = 0; i < 4; i += int(hn::Lanes(corners)))
    hn::Store(at_corners(patch.w, board.w, i), corners, w + i);
  const float low_w = std::min(std::min(w[0], w[1]), std::min(w[2], w[3])),
              high_w = std::max(std::max(w[0], w[1]), std::max(w[2], w[3]));
  if (high_w <= tile.nothing || low_w >= placed.inverse_near) return false;
  // Where the polygon passes the eye's plane in the block, nothing is known of it.
  if (low_w <= tile.nothing) return true;
  for (int i = 0; i < 4; i += int(hn::Lanes(corners))) {
    const auto eye_z = hn::Div(hn::Set(corners, 1.0f), hn::Load(corners, w + i));
    hn::Store(hn::Mul(at_corners(patch.u, board.u, i), eye_z), corners, u + i);
    hn::Store(hn::Mul(at_corners(patch.v, board.v, i), eye_z), corners, v + i);
  }
  const float low_u = std::min(std::min(u[0], u[1]), std::min(u[2], u[3])),
              high_u = std::max(std::max(u[0], u[1]), std::max(u[2], u[3])),
              low_v = std::min(std::min(v[0], v[1]), std::min(v[2], v[3])),
              high_v = std::max(std::max(v[0], v[1]), std::max(v[2], v[3]));
  patch.low_u = low_u, patch.high_v = high_v;
  const float width = float(picture.width()), height = float(picture.height());
  if (high_u < 0 || high_v < 0 || low_u >= width || low_v >= height) return false;
  // Rounded otherwise than the pixels between, by less than this.
  constexpr float kSlack = 1.0f / 64;
  constexpr float kReach = 0.5f + kSlack;  // of interpolation
  patch.inside = low_u >= kReach && low_v >= kReach && high_u <= width - kReach &&
                 high_v <= height - kReach && high_w < placed.inverse_near;
  if (high_w < placed.inverse_near)
    patch.reach = find_reach(u, v, high_u - low_u, high_v - low_v, high_w / low_w);
  const auto cells = [&](float low, float high, int texels, int& from, int& to) {
    constexpr int kCell = SoftwareNailboard::kCell;
    from = int(std::max(0.0f, low - kReach)) / kCell;
    to = std::min(int(std::min(high + kReach, float(texels))), texels - 1) / kCell;
  };
  int x0, x1, y0, y1;
  cells(low_u, high_u, picture.width(), x0, x1);
  cells(low_v, high_v, picture.height(), y0, y1);
  if ((x1 - x0) * (y1 - y0) > 64) return true;  // many texels a pixel: a look costs more
  std::uint32_t nearest = 0xffff;
  bool opaque = true;
  for (int y = y0; y <= y1; ++y) {
    const int row = y * picture.cells_across();
    for (int x = x0; x <= x1; ++x) {
      nearest = std::min<std::uint32_t>(nearest, picture.cell_nearest()[row + x]);
      opaque = opaque && picture.cell_opaque()[row + x];
    }
  }
  if (nearest > picture.steps()) return false;
  patch.opaque = patch.inside && opaque;
  // The nearest that the block can show: see nailboard_composer.cpp.
  if (placed.nearest < std::numeric_limits<float>::infinity()) {
    const float q = placed.q_first + placed.q_per_code * float(nearest);
    const float most =
        placed.exact ? q / (q * placed.eye_z + 1 / high_w - placed.eye_z) : q * high_w;
    if (most * 1.0001f <= farthest(tile, block) && most > 0) return false;
  }
  return true;
}

// Begins to load the texels of the block below this one, which comes a row of blocks later.
HWY_INLINE void prefetch_below(const Board& board, const Patch& patch) {
  const SoftwareNailboard& picture = board.picture;
  const int column = int(std::clamp(patch.low_u, 0.0f, float(picture.width() - 1)));
  const int row = int(std::clamp(patch.high_v, 0.0f, float(picture.height() - 1)));
  const int last = std::min(row + kBlock, picture.height());
  for (int y = row; y <= last; ++y) {
    const std::size_t texel = std::size_t(y) * std::size_t(picture.stride()) + std::size_t(column);
    hwy::Prefetch(picture.color() + texel);
    hwy::Prefetch(picture.color() + texel + kBlock);
    hwy::Prefetch(picture.code_pairs() + texel / 2);
  }
}
