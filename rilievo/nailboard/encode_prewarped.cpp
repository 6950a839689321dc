#include "rilievo/nailboard/encode_prewarped.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "rilievo/core/depth.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/nailboard/nearest_beside.h"

namespace rilievo {
namespace {

constexpr std::uint32_t kDeltaSteps = delta_steps(16);
constexpr std::uint32_t kEmptyDelta = delta_transparent(16);

glm::u8vec4 mean_of(const glm::u8vec4* texels[4], const std::uint16_t* [4]) {
  glm::uvec4 sum(2);
  for (int i = 0; i < 4; ++i) sum += glm::uvec4(*texels[i]);
  return glm::u8vec4(sum / 4u);
}

glm::u8vec4 nearest_of(const glm::u8vec4* texels[4], const std::uint16_t* deltas[4]) {
  int best = 0;
  for (int i = 1; i < 4; ++i)
    if (*deltas[i] < *deltas[best]) best = i;
  return *texels[best];
}

template <class Choose>
void halve_once(const Prewarped& from, Prewarped& to, Choose&& choose) {
  const int w = from.width(), h = from.height();
  to.geometry = from.geometry;
  Camera& camera = to.geometry.capture;
  camera.width = (w + 1) / 2;
  camera.height = (h + 1) / 2;
  ImageWindow& window = camera.window;
  window.right = window.left + (window.right - window.left) / w * (2 * camera.width);
  window.bottom = window.top - (window.top - window.bottom) / h * (2 * camera.height);
  to.color.resize(std::size_t(camera.width) * std::size_t(camera.height));
  to.delta.resize(to.color.size());
  static constexpr glm::u8vec4 kNothing(0);
  static constexpr std::uint16_t kNone = kEmptyDelta;
  parallel_for(0, camera.height, [&, w, h](int y) {
    const std::size_t width = std::size_t(to.geometry.capture.width);
    for (int x = 0; x < int(width); ++x) {
      const glm::u8vec4* colors[4];
      const std::uint16_t* deltas[4];
      std::uint16_t nearest = kNone;
      for (int i = 0; i < 4; ++i) {
        const int u = 2 * x + (i & 1), v = 2 * y + (i >> 1);
        const bool inside = u < w && v < h;
        const std::size_t at = std::size_t(v) * std::size_t(w) + std::size_t(u);
        colors[i] = inside ? &from.color[at] : &kNothing;
        deltas[i] = inside ? &from.delta[at] : &kNone;
        nearest = std::min(nearest, *deltas[i]);
      }
      to.color[std::size_t(y) * width + std::size_t(x)] = choose(colors, deltas);
      to.delta[std::size_t(y) * width + std::size_t(x)] = nearest;
    }
  });
}

template <class Choose>
void halve(const Prewarped& picture, int level, Prewarped& halved, Prewarped& scratch,
           Choose&& choose) {
  RILIEVO_EXPECTS(level >= 1);
  halve_once(picture, halved, choose);
  for (int i = 1; i < level; ++i) {
    std::swap(halved, scratch);
    halve_once(scratch, halved, choose);
  }
}

}  // namespace

void halve_prewarped(const Prewarped& picture, int level, Prewarped& halved, Prewarped& scratch) {
  halve(picture, level, halved, scratch, mean_of);
}

void halve_identifiers(const Prewarped& picture, int level, Prewarped& halved, Prewarped& scratch) {
  halve(picture, level, halved, scratch, nearest_of);
}

std::vector<PicturePiece> pieces_of(int width, int height, int most) {
  std::vector<PicturePiece> pieces;
  for (int y = 0; y < height; y += most)
    for (int x = 0; x < width; x += most)
      pieces.push_back({x, y, std::min(most, width - x), std::min(most, height - y)});
  return pieces;
}

PictureGeometry geometry_of(const PictureGeometry& whole, const PicturePiece& piece) {
  PictureGeometry part = whole;
  Camera& camera = part.capture;
  const ImageWindow w = camera.window;
  const double step_x = (w.right - w.left) / camera.width,
               step_y = (w.top - w.bottom) / camera.height;
  camera.window = {w.left + step_x * piece.x, w.left + step_x * (piece.x + piece.width),
                   w.top - step_y * (piece.y + piece.height), w.top - step_y * piece.y};
  camera.width = piece.width;
  camera.height = piece.height;
  return part;
}

PictureGeometry placed(PictureGeometry geometry, const glm::dmat4& world_from_capture) {
  const double scale = glm::length(glm::dvec3(world_from_capture[0]));
  Camera& camera = geometry.capture;
  camera.world_from_eye = world_from_capture * camera.world_from_eye;
  for (int k = 0; k < 3; ++k)
    camera.world_from_eye[k] = glm::dvec4(glm::normalize(glm::dvec3(camera.world_from_eye[k])), 0);
  camera.z_near *= scale;
  camera.z_far *= scale;
  geometry.plane_z *= scale;
  geometry.slab = {scale * geometry.slab.front, scale * geometry.slab.back};
  return geometry;
}

void codes_of_row(const Prewarped& picture, const PicturePiece& piece, int y,
                  std::uint16_t* codes) {
  const int w = picture.width(), h = picture.height(), v = piece.y + y;
  if (piece.width <= 0) return;
  const auto row = [&](int at) {
    return picture.delta.data() + std::size_t(std::clamp(at, 0, h - 1)) * std::size_t(w) +
           std::size_t(piece.x);
  };
  const std::uint16_t* const rows[3] = {row(v - 1), row(v), row(v + 1)};
  nearest_beside(rows[0], rows[1], rows[2], piece.width, codes);
  for (const int x : {0, piece.width - 1}) {
    codes[x] = rows[1][x];
    if (codes[x] != kEmptyDelta) continue;
    const int from = std::max(x - 1, -piece.x), to = std::min(x + 1, w - 1 - piece.x);
    for (const std::uint16_t* at : rows)
      codes[x] = std::min(codes[x], *std::min_element(at + from, at + to + 1));
  }
}

void encode_prewarped(const Prewarped& picture, const PicturePiece& piece, EncodedPiece& encoded) {
  const std::size_t width = std::size_t(piece.width), texels = width * std::size_t(piece.height);
  encoded.color.resize(texels);
  encoded.picture.codes16.resize(texels);
  const int columns = blocks_across(piece.width), rows = blocks_across(piece.height);
  encoded.picture.blocks.resize(std::size_t(columns) * std::size_t(rows));
  parallel_for(0, rows, [&, width, columns](int row) {
    const int begin = row * kBlockTexels, end = std::min(piece.height, begin + kBlockTexels);
    for (int y = begin; y < end; ++y) {
      const int row_of = piece.height - 1 - y;  // from the top
      codes_of_row(picture, piece, row_of, encoded.picture.codes16.data() + std::size_t(y) * width);
      const std::size_t source =
          std::size_t(piece.y + row_of) * std::size_t(picture.width()) + std::size_t(piece.x);
      std::copy_n(picture.color.data() + source, width,
                  encoded.color.data() + std::size_t(y) * width);
    }
    for (int column = 0; column < columns; ++column)
      encoded.picture.blocks[std::size_t(row) * std::size_t(columns) + std::size_t(column)] =
          tile_of(encoded.picture.codes16.data(), encoded.color.data(), piece.width, column, begin,
                  end, kDeltaSteps);
  });
}

}  // namespace rilievo
