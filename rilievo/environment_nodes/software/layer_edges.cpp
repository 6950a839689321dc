// The samples of pixels that a silhouette crosses: where a frame has one sample of each pixel, its
// silhouettes would be stairs, and what is thinner than a pixel would come and go.
//
// All that is found of the others before is used: a silhouette behind the surfaces of its own layer
// is not marked, and of triangles those alone are rasterised that reach a marked pixel.
#include <algorithm>
#include <bit>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/environment_nodes/software/node_layer.h"

namespace rilievo {
namespace {

// What lies behind an edge by less than this is no other surface for it.
constexpr float kBehind = 1.015f;

// The part of a line, from 0 to 1, on which what is `from` and `to` at its ends is not negative.
void keep_positive(double from, double to, double& low, double& high) {
  if (from < 0 && to < 0) {
    high = -1;
  } else if (from < 0) {
    low = std::max(low, from / (from - to));
  } else if (to < 0) {
    high = std::min(high, from / (from - to));
  }
}

// Is there a sample of a marked pixel in which no layer shows a surface?
bool has_gap(std::span<const NodeLayer> layers, std::uint32_t pixel) {
  for (int s = 0; s < NodeLayer::kEdgeSamples; ++s)
    if (std::none_of(layers.begin(), layers.end(),
                     [&](const NodeLayer& layer) { return layer.edge_depths(pixel)[s] < 1; }))
      return true;
  return false;
}

}  // namespace

// Does the pixel, or one beside it, show what lies behind an edge? `nearness`: of the edge,
// kSkyDepth - depth.
bool NodeLayer::shows_edge(int x, int y, float nearness) const {
  const SampleBuffer& seen = surfaces_.raster.seen();
  const auto is_behind = [&](int column, int row) {
    if (column < 0 || row < 0 || column >= width_ || row >= height_) return false;
    return kBehind * (kSkyDepth - seen.depths(height_ - 1 - row)[column]) <= nearness;
  };
  return is_behind(x, y) || is_behind(x - 1, y) || is_behind(x + 1, y) || is_behind(x, y - 1) ||
         is_behind(x, y + 1);
}

void NodeLayer::mark_edge(const Placed& placed, const MeshEdge& edge, EdgePixels& pixels) const {
  const glm::dvec3* const corners = &corners_[placed.first_corner];
  const glm::dvec3 a = corners[edge.from], b = corners[edge.to];
  const double wide = width_, tall = height_;
  double low = 0, high = 1;
  const auto& vertices = placed.drawn.node->mesh.vertices;
  const double disparity_a = double(vertices[edge.from].disparity),
               disparity_b = double(vertices[edge.to].disparity);
  keep_positive(a.z - nearest_ * disparity_a, b.z - nearest_ * disparity_b, low, high);
  keep_positive(a.x, b.x, low, high);
  keep_positive(wide * a.z - a.x, wide * b.z - b.x, low, high);
  keep_positive(a.y, b.y, low, high);
  keep_positive(tall * a.z - a.y, tall * b.z - b.y, low, high);
  if (low >= high) return;
  // On which side of the edge are the triangles, as the eye sees them?
  const glm::dvec3 line = glm::cross(a, b);
  const bool from_front = glm::dot(line, corners[edge.inner]) > 0;
  if (edge.outer != MeshEdge::kNone) {
    if (from_front == (glm::dot(line, corners[edge.outer]) < 0)) return;
  } else if (placed.drawn.front_only && !from_front) {
    return;
  }
  struct End {
    double x, y;  // y downwards
    double nearness;
  };
  const auto end = [&](double at) {
    const glm::dvec3 c = glm::mix(a, b, at);
    const double w = std::max(c.z, 1e-30);
    return End{c.x / w, tall - c.y / w,
               nearest_ * std::max(glm::mix(disparity_a, disparity_b, at) / w, 0.0)};
  };
  End top = end(low), bottom = end(high);
  if (top.y > bottom.y) std::swap(top, bottom);
  const double dx = bottom.x - top.x, dy = bottom.y - top.y, length2 = dx * dx + dy * dy;
  const double x_per_y = dy > 0 ? dx / dy : 0;
  // Ends may be farther away than an int reaches. What is no number becomes 0: max() compares with
  // it, and keeps its first argument.
  const auto pixel = [](double at, int size) {
    return int(std::min(std::max(0.0, at), double(size - 1)));
  };
  const int first = pixel(top.y, height_), last = pixel(bottom.y, height_);
  if (only_ && !only_->any(pixel(std::min(top.x, bottom.x), width_), first,
                           pixel(std::max(top.x, bottom.x), width_), last))
    return;
  for (int y = first; y <= last; ++y) {
    // Of a line that is nearly level, all of it lies in a row or two.
    const double enters = y <= first ? top.x : top.x + (y - top.y) * x_per_y,
                 leaves = y >= last ? bottom.x : top.x + (y + 1 - top.y) * x_per_y;
    const int x0 = pixel(std::min(enters, leaves), width_),
              x1 = pixel(std::max(enters, leaves), width_);
    for (int x = x0; x <= x1; ++x) {
      const double along = (x + 0.5 - top.x) * dx + (y + 0.5 - top.y) * dy;
      const double at = length2 > 0 ? std::clamp(along / length2, 0.0, 1.0) : 0.0;
      if (reaches(x, y) && shows_edge(x, y, float(glm::mix(top.nearness, bottom.nearness, at))))
        pixels.mark(x, y);
    }
  }
}

void NodeLayer::mark_silhouettes(EdgePixels& pixels) const {
  if (surfaces_.triangle.empty()) return;
  for (const Placed& placed : nodes_)
    for (std::size_t f = 0; f < 6; ++f) {
      if (!placed.visible[f]) continue;
      for (const MeshEdge& edge : placed.drawn.node->edges[f]) {
        if (double(edge.reach) > placed.eye_distance) break;
        mark_edge(placed, edge, pixels);
      }
    }
}

// Which triangles of a soup reach a marked pixel?
void NodeLayer::find_near_edges(const EdgePixels& pixels, Part part) {
  const Soup& soup = soup_of(part);
  for (std::uint32_t t = 0; t < soup.triangle.size(); ++t) {
    const auto corner = [&](std::size_t k) {
      return soup.positions[soup.indices[3 * std::size_t(t) + k]];
    };
    const glm::vec3 a = corner(0), b = corner(1), c = corner(2);
    const glm::vec3 least = glm::min(a, glm::min(b, c)), most = glm::max(a, glm::max(b, c));
    if (most.x < 0 || most.y < 0 || least.x >= float(width_) || least.y >= float(height_)) continue;
    const int left = int(std::max(least.x, 0.0f)),
              right = std::min(int(std::min(most.x, float(width_))), width_ - 1);
    const int low = height_ - 1 - std::min(int(std::min(most.y, float(height_))), height_ - 1),
              high = height_ - 1 - int(std::max(least.y, 0.0f));
    if (part == Part::surfaces && nodes_[soup.node[t]].drawn.front_only &&
        !((b.x - a.x) * (c.y - a.y) > (c.x - a.x) * (b.y - a.y)))
      continue;
    if (pixels.any(left, low, right, high)) near_edges_.push_back({part, t, low, high});
  }
}

// The rows [low, high) of pixels of `wanted`, whole blocks of them; `pixels` has their numbers.
void NodeLayer::fill_edge_samples(const EdgePixels& pixels, const EdgePixels& wanted, int low,
                                  int high) {
  constexpr int kBlock = EdgePixels::kBlock;
  const std::array<Seen, 3> parts = seen();
  for (const NearEdge& near : near_edges_) {
    if (near.low >= high || near.high < low) continue;
    const bool skin = near.part != Part::surfaces;
    const Soup& soup = soup_of(near.part);
    const std::uint32_t* const corner = &soup.indices[3 * std::size_t(near.triangle)];
    const glm::vec3 &a = soup.positions[corner[0]], &b = soup.positions[corner[1]],
                    &c = soup.positions[corner[2]];
    const CornerEdges edges(a, b, c);
    const float nearest = std::min(a.z, std::min(b.z, c.z)),
                farthest = std::max(a.z, std::max(b.z, c.z));
    const std::uint32_t number = parts[std::size_t(near.part)].first + near.triangle;
    // What the edges' numbers of samples are more than those of their pixel's lower left corner.
    glm::vec2 place[kEdgeSamples];
    std::int64_t more[kEdgeSamples][3], most[3];
    for (int s = 0; s < kEdgeSamples; ++s) {
      place[s] = sample_position(s, kEdgeSamples);
      for (int k = 0; k < 3; ++k) {
        more[s][k] = edges.per_x[k] * std::int64_t(place[s].x * CornerEdges::kUnit) +
                     edges.per_y[k] * std::int64_t(place[s].y * CornerEdges::kUnit);
        most[k] = s == 0 ? more[s][k] : std::max(most[k], more[s][k]);
      }
    }
    const int right = std::min(width_, edges.x1), bottom = std::min(near.high, high - 1);
    for (int top = std::max(near.low, low) / kBlock * kBlock; top <= bottom; top += kBlock)
      for (int left = std::max(0, edges.x0) / kBlock * kBlock; left < right; left += kBlock) {
        std::uint64_t word = wanted.word(left, top);
        if (word == 0 || !reaches(left, top)) continue;
        // Of the block, what the triangle's bounds reach.
        const auto bits = [](int from, int to) {
          return (2u << std::min(to, kBlock - 1)) - (1u << std::max(from, 0));
        };
        const std::uint64_t columns = bits(edges.x0 - left, edges.x1 - 1 - left),
                            from_row = std::uint64_t(std::max(near.low - top, 0)),
                            to_row = std::uint64_t(std::min(near.high - top, kBlock - 1));
        word &= columns * 0x0101010101010101u & ~std::uint64_t(0) << kBlock * from_row &
                ~std::uint64_t(0) >> kBlock * (kBlock - 1 - to_row);
        if (word == 0) continue;
        // At the block's upper left pixel, and the most anywhere in it.
        std::int64_t block[3];
        bool reaches = true;
        for (int k = 0; k < 3; ++k) {
          block[k] = edges.at[k] + CornerEdges::kUnit * (edges.per_x[k] * left +
                                                         edges.per_y[k] * (height_ - 1 - top));
          reaches = reaches && block[k] + most[k] +
                                       CornerEdges::kUnit * (kBlock - 1) *
                                           (std::max(edges.per_x[k], std::int64_t(0)) +
                                            std::max(-edges.per_y[k], std::int64_t(0))) >
                                   0;
        }
        if (!reaches) continue;
        for (; word != 0; word &= word - 1) {
          const int bit = std::countr_zero(word), across = bit % kBlock, down = bit / kBlock;
          const int x = left + across, row = height_ - 1 - top - down;
          std::int64_t at[3];
          for (int k = 0; k < 3; ++k)
            at[k] =
                block[k] + CornerEdges::kUnit * (edges.per_x[k] * across - edges.per_y[k] * down);
          // Inside of all edges no number is less than 1.
          unsigned covered = 0;
          for (int s = 0; s < kEdgeSamples; ++s)
            covered |= unsigned(((at[0] + more[s][0] - 1) | (at[1] + more[s][1] - 1) |
                                 (at[2] + more[s][2] - 1)) >= 0)
                       << s;
          if (covered == 0) continue;
          const std::size_t first = kEdgeSamples * std::size_t(pixels.number_of(left, top, bit));
          bool asked = near.part != Part::doubtful;
          for (; covered != 0; covered &= covered - 1) {
            const int s = std::countr_zero(covered);
            float& depth = edge_depth_[first + std::size_t(s)];
            std::uint32_t& triangle = edge_triangle_[first + std::size_t(s)];
            // Skins lie behind all surfaces.
            if (skin && depth < 1 && triangle < first_skin()) continue;
            const float own =
                std::clamp(edges.depth(glm::vec2(x, row) + place[s]), nearest, farthest);
            if (!(own < depth)) continue;
            if (!asked && !doubtful_edges_[near.triangle].width.is_narrow(x, row)) break;
            asked = true;
            depth = own, triangle = number;
          }
        }
      }
  }
}

void NodeLayer::begin_edge_surfaces(const EdgePixels& pixels) {
  RILIEVO_EXPECTS(samples_ == 1);
  edge_depth_.assign(kEdgeSamples * pixels.count(), 1.0f);
  edge_triangle_.resize(kEdgeSamples * pixels.count());
  near_edges_.clear();
  find_near_edges(pixels, Part::surfaces);
}

void NodeLayer::begin_edge_skins(const EdgePixels& gaps) {
  near_edges_.clear();
  find_near_edges(gaps, Part::skins);
  find_near_edges(gaps, Part::doubtful);
}

namespace {

// Calls visit(layer) for each, and then visits all rows of the pixels `wanted`.
template <class Visit>
void fill_pixels(std::span<NodeLayer> layers, int height, const EdgePixels& edges,
                 const EdgePixels& wanted, const Visit& visit) {
  constexpr int kBand = 4 * EdgePixels::kBlock;
  const int bands = (height + kBand - 1) / kBand, count = int(layers.size());
  parallel_for(0, count, [&](int k) { visit(layers[std::size_t(k)]); });
  parallel_for(0, bands * count, [&](int piece) {
    const int low = piece / count * kBand;
    layers[std::size_t(piece % count)].fill_edge_samples(edges, wanted, low,
                                                         std::min(low + kBand, height));
  });
}

}  // namespace

void find_edge_surfaces(std::span<NodeLayer> layers, int height, EdgePixels& edges,
                        EdgePixels& gaps) {
  parallel_for(0, int(layers.size()),
               [&](int k) { layers[std::size_t(k)].mark_silhouettes(edges); });
  edges.number();
  fill_pixels(layers, height, edges, edges,
              [&](NodeLayer& layer) { layer.begin_edge_surfaces(edges); });
  edges.for_each([&](int x, int y, std::uint32_t pixel) {
    if (has_gap(layers, pixel)) gaps.mark(x, y);
  });
}

void find_edge_skins(std::span<NodeLayer> layers, int height, const EdgePixels& edges,
                     const EdgePixels& gaps) {
  fill_pixels(layers, height, edges, gaps, [&](NodeLayer& layer) { layer.begin_edge_skins(gaps); });
}

}  // namespace rilievo
