#include "rilievo/web_walk/board_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rilievo/nailboard/nailboard.h"
#include "rilievo/web_walk/dilate.h"
#include "rilievo/web_walk/plane16.h"
#include "rilievo/web_walk/webp.h"

namespace rilievo {
namespace {

constexpr int kBoardDeltaBits = 16;

// Nailboards have colours multiplied by alpha, files do not.
Rgba8Image straight_alpha(const Rgba8Image& multiplied) {
  Rgba8Image straight = multiplied;
  for (glm::u8vec4& texel : straight.texels()) {
    if (texel.a == 0 || texel.a == 255) continue;
    for (int c = 0; c < 3; ++c)
      texel[c] = std::uint8_t(std::min(255l, std::lround(255.0 * texel[c] / texel.a)));
  }
  return straight;
}

Result<WalkBoard> write_board(const DepthImage& picture, WalkWriter& writer,
                              const WalkOptions& options) {
  if (picture.camera.projection != Projection::perspective)
    return Error{"", "is no picture in perspective"};
  const Nailboard nailboard = make_nailboard(picture, kBoardDeltaBits);
  WalkBoard board;
  board.camera = picture.camera;
  board.plane_z = nailboard.geometry.plane_z;
  Rgba8Image colors = straight_alpha(nailboard.color);
  dilate_colors(colors);
  const Result<WebpFile> file = encode_webp(colors, {options.least_psnr_db, true});
  if (!file) return file.error();
  board.psnr_db = file->psnr_db;
  Result<WalkFile> color_file = writer.add(file->bytes, "webp");
  if (!color_file) return color_file.error();
  board.colors = std::move(*color_file);
  Result<WalkFile> depth_file = writer.add(encode_plane16(nailboard.delta), "bin");
  if (!depth_file) return depth_file.error();
  board.depths = std::move(*depth_file);
  return board;
}

}  // namespace

Result<> add_boards(std::span<const DepthImage> pictures, WalkWriter& writer,
                    WalkManifest& manifest, const WalkOptions& options) {
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    Result<WalkBoard> board = write_board(pictures[i], writer, options);
    if (!board) return Error{fmt::format("picture {}", i), board.error().message()};
    manifest.boards.push_back(std::move(*board));
    if (options.progress) options.progress(int(i) + 1, int(pictures.size()));
  }
  return Done{};
}

}  // namespace rilievo
