#include "rilievo/web_walk/relief_files.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "rilievo/web_walk/picture_files.h"
#include "rilievo/web_walk/plane16.h"

namespace rilievo {
namespace {

// A sheet's sides at most, which every WebGL 2 takes, in blocks.
constexpr int kMostBlocks = 4096 / kReliefBlock;

// The samples of a texel of a relief: `count` of them, the deepest first.
struct Line {
  const ReliefSample* first = nullptr;
  int count = 0;
};

Image<Line> lines_of(const LayeredRelief& relief) {
  Image<Line> lines(relief.camera.width, relief.camera.height);
  const std::vector<ReliefSample>& stream = relief.streams[0];
  for (int t = 0; t < relief.tiles_x * relief.tiles_y; ++t)
    for (std::uint32_t i = relief.first[std::size_t(t)]; i < relief.first[std::size_t(t) + 1];
         ++i) {
      const ReliefSample& sample = stream[i];
      Line& line = lines(t % relief.tiles_x * relief.tile_size + int(sample.u()),
                         t / relief.tiles_x * relief.tile_size + int(sample.v()));
      if (line.count++ == 0) line.first = &sample;
    }
  return lines;
}

// How many layers of the sheet each block of the picture has.
Image<std::uint16_t> count_layers(const Image<Line>& lines) {
  const auto across = [](int texels) { return (texels + kReliefBlock - 1) / kReliefBlock; };
  Image<std::uint16_t> layers(across(lines.width()), across(lines.height()));
  for (int v = 0; v < lines.height(); ++v)
    for (int u = 0; u < lines.width(); ++u) {
      std::uint16_t& most = layers(u / kReliefBlock, v / kReliefBlock);
      most = std::uint16_t(std::max(int(most), std::min(lines(u, v).count, 0xffff)));
    }
  return layers;
}

glm::u8vec4 straight(std::uint32_t color) {
  const std::uint32_t a = color >> 24;
  glm::u8vec4 c(0, 0, 0, a);
  for (int k = 0; k < 3 && a > 0; ++k)
    c[k] = std::uint8_t(std::min(255u, ((color >> (8 * k) & 0xff) * 255 + a / 2) / a));
  return c;
}

struct Sheet {
  Image<std::uint16_t> codes;
  Rgba8Image colors;
};

Sheet sheet_of(const Image<Line>& lines, const Image<std::uint16_t>& layers, int columns,
               int rows) {
  Sheet sheet{Image<std::uint16_t>(columns * kReliefBlock, rows * kReliefBlock),
              Rgba8Image(columns * kReliefBlock, rows * kReliefBlock)};
  const int most = std::ranges::max(layers.texels());
  int place = 0;
  for (int layer = 0; layer < most; ++layer)
    for (int y = 0; y < layers.height(); ++y)
      for (int x = 0; x < layers.width(); ++x) {
        if (layers(x, y) <= layer) continue;
        const int left = place % columns * kReliefBlock, top = place / columns * kReliefBlock;
        ++place;
        for (int j = 0; j < kReliefBlock; ++j)
          for (int i = 0; i < kReliefBlock; ++i) {
            const int u = x * kReliefBlock + i, v = y * kReliefBlock + j;
            if (u >= lines.width() || v >= lines.height() || lines(u, v).count <= layer) continue;
            const Line& line = lines(u, v);
            const ReliefSample& sample = line.first[line.count - 1 - layer];
            sheet.codes(left + i, top + j) = std::uint16_t(sample.code() + 1);
            sheet.colors(left + i, top + j) = straight(sample.color);
          }
      }
  return sheet;
}

Result<> write_relief(const LayeredRelief& relief, WalkWriter& writer, const WalkOptions& options,
                      WalkRelief& to) {
  to.camera = relief.camera;
  to.plane_z = relief.plane_z;
  to.first_d = relief.first_d;
  to.d_step = relief.d_step;
  to.splat_scale = relief.splat_scale;
  to.samples = relief.samples();
  const Image<Line> lines = lines_of(relief);
  const Image<std::uint16_t> layers = count_layers(lines);
  std::size_t blocks = 0;
  for (const std::uint16_t count : layers.texels()) blocks += count;
  const auto columns = std::max(std::size_t(std::min(layers.width(), kMostBlocks)),
                                (blocks + kMostBlocks - 1) / kMostBlocks);
  if (columns > std::size_t(kMostBlocks))
    return Error{"", "has more samples than a sheet of 4096 x 4096 texels holds"};
  const auto rows = (blocks + columns - 1) / columns;
  Sheet sheet = sheet_of(lines, layers, int(columns), int(rows));
  to.sheet_width = sheet.codes.width();
  to.sheet_height = sheet.codes.height();
  to.hull = relief.hull;
  for (const auto& [plane, file] :
       {std::pair{&layers, &to.layers}, std::pair{&std::as_const(sheet).codes, &to.codes}}) {
    Result<WalkFile> written = writer.add(encode_plane16(*plane), "bin");
    if (!written) return written.error();
    *file = std::move(*written);
  }
  Result<WalkColors> colors = write_colors(std::move(sheet.colors), writer, options);
  if (!colors) return colors.error();
  to.colors = std::move(colors->file);
  to.psnr_db = colors->psnr_db;
  return Done{};
}

}  // namespace

Result<> add_reliefs(const ReliefPictures& pictures, const PrewarpOptions& draw, WalkWriter& writer,
                     WalkManifest& manifest, const WalkOptions& options) {
  const Result<ReliefSet> set = make_relief_set(pictures);
  if (!set) return set.error();
  WalkReliefs& made = manifest.reliefs;
  made.bounds = pictures.bounds;
  // The page's splats do not face the eye: they are as large as those that do for an eye 21 degrees
  // beside a relief's axis.
  made.splat = draw.splat_size * (draw.splats_face_eye ? 1.07 : 1.0);
  made.resolution = draw.resolution;
  made.max_size = draw.max_size;
  made.reliefs.resize(set->reliefs.size());
  return write_each(made.reliefs.size(), options, [&](std::size_t i) {
    return write_relief(set->reliefs[i], writer, options, made.reliefs[i]);
  });
}

}  // namespace rilievo
