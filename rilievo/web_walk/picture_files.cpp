#include "rilievo/web_walk/picture_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/nailboard/nailboard.h"
#include "rilievo/web_walk/dilate.h"
#include "rilievo/web_walk/plane16.h"
#include "rilievo/web_walk/webp.h"

namespace rilievo {
namespace {

// Codes of disparities: 0 is nothing.
constexpr double kDisparitySteps = 65534;

// `disparity` is 0 where nothing is; `colors` are not multiplied by alpha.
Result<> write_picture(const Image<float>& disparity, Rgba8Image colors, WalkWriter& writer,
                       const WalkOptions& options, WalkPicture& picture) {
  float least = INFINITY, most = 0;
  for (const float q : disparity.texels())
    if (q > 0) least = std::min(least, q), most = std::max(most, q);
  if (!(most > 0)) least = most = 1;
  picture.least_disparity = double(least);
  picture.disparity_step =
      std::max(double(most) - double(least), 1e-9 * double(most)) / kDisparitySteps;
  Image<std::uint16_t> codes(disparity.width(), disparity.height());
  std::ranges::transform(disparity.texels(), codes.texels().begin(), [&](float q) {
    if (q == 0) return std::uint16_t(0);
    return std::uint16_t(
        1 + std::lround((double(q) - picture.least_disparity) / picture.disparity_step));
  });
  Result<WalkFile> depths = writer.add(encode_plane16(codes), "bin");
  if (!depths) return depths.error();
  picture.depths = std::move(*depths);
  Result<WalkColors> file = write_colors(std::move(colors), writer, options);
  if (!file) return file.error();
  picture.colors = std::move(file->file);
  picture.psnr_db = file->psnr_db;
  return Done{};
}

// sRGB, not multiplied by alpha; nothing where `shows` of the texel's number says so.
template <typename Shows>
Rgba8Image straight_colors(const DepthImage& picture, const Shows& shows) {
  ColorImage straight = picture.color;
  for (std::size_t i = 0; i < straight.texels().size(); ++i) {
    glm::vec4& c = straight.texels()[i];
    c = shows(i) && c.a > 0 ? glm::vec4(glm::vec3(c) / c.a, c.a) : glm::vec4(0);
  }
  return srgb8_from_linear(straight);
}

// The Deltas of a board, in steps of 1 / 254 rounded outwards, as an atlas knows them.
std::optional<DeltaRange> delta_range(const Nailboard& board) {
  const auto steps = delta_steps(board.geometry.delta_bits);
  std::uint32_t nearest = steps + 1, farthest = 0;
  for (const std::uint32_t code : board.delta.texels())
    if (code <= steps) nearest = std::min(nearest, code), farthest = std::max(farthest, code);
  if (nearest > farthest) return std::nullopt;
  return DeltaRange{double(nearest * 254 / steps) / 254,
                    double((farthest * 254 + steps - 1) / steps) / 254};
}

}  // namespace

Result<WalkColors> write_colors(Rgba8Image colors, WalkWriter& writer, const WalkOptions& options) {
  dilate_colors(colors);
  const Result<WebpFile> encoded =
      encode_webp(colors, {.least_psnr_db = options.least_psnr_db, .alpha = true});
  if (!encoded) return encoded.error();
  Result<WalkFile> file = writer.add(encoded->bytes, "webp");
  if (!file) return file.error();
  return WalkColors{std::move(*file), encoded->psnr_db};
}

Result<> write_each(std::size_t count, const WalkOptions& options,
                    const std::function<Result<>(std::size_t)>& write) {
  std::vector<std::optional<Error>> errors(count);
  std::mutex mutex;
  int done = 0;
  parallel_for(std::size_t(0), count, [&](std::size_t i) {
    if (Result<> written = write(i); !written) errors[i] = written.error();
    const std::lock_guard lock(mutex);
    if (options.progress) options.progress(++done, int(count));
  });
  for (std::size_t i = 0; i < count; ++i)
    if (errors[i]) return Error{fmt::format("picture {}", i), errors[i]->message()};
  return Done{};
}

Result<> add_layered_impostor(const LayeredImpostor& impostor, WalkWriter& writer,
                              WalkManifest& manifest, const WalkOptions& options) {
  WalkPictures& made = manifest.pictures;
  made.drawn = WalkPictures::Drawn::surfaces;
  made.bounds = impostor.bounds;
  made.handover = kHandover * mean_spacing(impostor.views);
  made.links = view_links(impostor.views);
  made.pictures.resize(impostor.pictures.size());
  return write_each(made.pictures.size(), options, [&](std::size_t i) {
    WalkPicture& to = made.pictures[i];
    const TexelSurface& surface = impostor.surfaces[i];
    to.camera = impostor.pictures[i].camera;
    to.complete = impostor.complete[i], to.sees_through = impostor.sees_through[i];
    to.direction = impostor.views.directions[i];
    Image<float> disparity(surface.texels.width(), surface.texels.height());
    std::ranges::transform(surface.texels.texels(), disparity.texels().begin(),
                           [](const SurfaceTexel& texel) { return texel.q; });
    return write_picture(disparity,
                         straight_colors(impostor.pictures[i],
                                         [&](std::size_t k) { return disparity.texels()[k] > 0; }),
                         writer, options, to);
  });
}

Result<> add_nailboards(std::span<const DepthImage> pictures, int delta_bits, WalkWriter& writer,
                        WalkManifest& manifest, const WalkOptions& options) {
  RILIEVO_EXPECTS(delta_bits >= 2 && delta_bits <= 16);
  WalkPictures& made = manifest.pictures;
  made.drawn = WalkPictures::Drawn::nailboards;
  for (const DepthImage& picture : pictures) {
    if (picture.camera.projection != Projection::perspective)
      return Error{picture.name, "only perspective pictures are nailboards"};
    for (int y = 0; y < picture.camera.height; ++y)
      for (int x = 0; x < picture.camera.width; ++x)
        if (picture.covered(x, y))
          made.bounds.add(glm::vec3(
              world_from_raster(picture.camera, {x + 0.5, y + 0.5},
                                eye_z_from(picture.depth_kind, double(picture.depth(x, y)),
                                           picture.camera, {x + 0.5, y + 0.5}))));
  }
  if (made.bounds.empty()) return Error{"", "its pictures show nothing"};
  made.pictures.resize(pictures.size());
  return write_each(made.pictures.size(), options, [&](std::size_t i) {
    WalkPicture& to = made.pictures[i];
    // As it is drawn elsewhere: with depths in so many bits, on the same polygon.
    Nailboard board = make_nailboard(pictures[i], delta_bits);
    if (const auto range = delta_range(board)) narrow_slab(board.geometry, *range);
    to.camera = pictures[i].camera;
    to.plane_z = board.geometry.plane_z;
    Image<float> disparity(board.delta.width(), board.delta.height());
    std::ranges::transform(
        board.delta.texels(), disparity.texels().begin(), [&](std::uint16_t code) {
          if (code == delta_transparent(delta_bits)) return 0.0f;
          const double window_z = double(decode_delta(code, delta_bits));
          return float(1 / eye_z_from(DepthKind::window_z, window_z, to.camera, {0, 0}));
        });
    const auto shows = [&](std::size_t k) { return board.color.texels()[k].a > 0; };
    return write_picture(disparity, straight_colors(pictures[i], shows), writer, options, to);
  });
}

}  // namespace rilievo
