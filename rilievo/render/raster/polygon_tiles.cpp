// Depth is window_z in the rasteriser and 1 / eye_z in tiles, and one is affine in the other:
//
//   window_z = (1 / z_near - 1 / eye_z) / (1 / z_near - 1 / z_far)
#include "rilievo/render/raster/polygon_tiles.h"

#include <algorithm>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/render/raster/frame_raster.h"

namespace rilievo {

struct PolygonTiles::State {
  const Scene& scene;
  std::unique_ptr<FrameRaster> raster;  // null: nothing has been drawn yet
  PictureShader shader;
  bool any = false;                    // does the frame show any?
  std::vector<std::uint32_t> content;  // of each sample, as in the SampleBuffer
  std::vector<std::uint8_t> covered;   // of each row, of each 8 pixels: is any sample covered?
  ObjectPicture objects;
  double inverse_near = 1, inverse_range = 1;  // 1 / eye_z = inverse_near - window_z inverse_range

  explicit State(const Scene& scene) : scene(scene) {}

  // The number of blocks across; rows are the SampleBuffer's.
  [[nodiscard]] static std::size_t across(int width) {
    return std::size_t(width + FrameTile::kBlock - 1) / FrameTile::kBlock;
  }

  Result<> rasterize(const Camera& camera, int samples, const PlacedScene& placed,
                     std::span<const std::uint32_t> drawn, std::span<const CrossFade> fading) {
    any = !drawn.empty() || !fading.empty();
    if (!any) return Done{};
    if (!raster) raster = std::make_unique<FrameRaster>(scene);
    if (Result<> done = raster->rasterize(camera, samples, placed, drawn, fading); !done) {
      any = false;
      return done;
    }
    content.resize(raster->seen().depth.size());
    covered.assign(across(camera.width) * std::size_t(camera.height), 0);
    inverse_near = 1 / camera.z_near;
    inverse_range = 1 / camera.z_near - 1 / camera.z_far;
    return Done{};
  }

  void draw_block(FrameTile& tile, int block, int x, int y) const;
};

PolygonTiles::PolygonTiles(const Scene& scene) : state_(new State(scene)) {}
PolygonTiles::~PolygonTiles() = default;

Result<> PolygonTiles::place(const Camera& camera, int samples, const PlacedScene& placed,
                             std::span<const std::uint32_t> objects,
                             std::span<const CrossFade> fading) {
  State& s = *state_;
  if (Result<> done = s.rasterize(camera, samples, placed, objects, fading); !done || !s.any)
    return done;
  PictureView view = s.raster->view(camera, s.scene);
  view.sample_colors = s.content.data();
  const auto width = std::size_t(camera.width);
  s.shader.shade(view, [&](const BandShader& shaded, int from, int to) {
    for (int y = from; y < to; ++y) {
      const std::uint8_t* row = shaded.covered().data() + std::size_t(y - from) * width;
      std::uint8_t* flags = &s.covered[std::size_t(y) * State::across(camera.width)];
      for (std::size_t x = 0; x < width; ++x) flags[x / FrameTile::kBlock] |= row[x];
    }
  });
  return Done{};
}

Result<> PolygonTiles::place_objects(const Camera& camera, const PlacedScene& placed,
                                     std::span<const std::uint32_t> objects,
                                     std::span<const CrossFade> fading) {
  State& s = *state_;
  if (Result<> done = s.rasterize(camera, 1, placed, objects, fading); !done || !s.any) return done;
  identify(s.raster->seen(), s.raster->meshes(), s.objects);
  const auto width = std::size_t(camera.width);
  for (int y = 0; y < camera.height; ++y) {
    const std::uint32_t* from = &s.objects.object[std::size_t(y) * width];
    std::copy_n(from, width, &s.content[s.raster->seen().row(y)]);
    std::uint8_t* flags = &s.covered[std::size_t(y) * State::across(camera.width)];
    for (std::size_t x = 0; x < width; ++x)
      flags[x / FrameTile::kBlock] |= std::uint8_t(from[x] != kNoObject);
  }
  return Done{};
}

// The pixels of a block; (x, y) is its upper left one in the frame.
void PolygonTiles::State::draw_block(FrameTile& tile, int block, int x, int y) const {
  constexpr int kBlock = FrameTile::kBlock;
  const SampleBuffer& in = raster->seen();
  const int samples = in.samples;
  const int columns = std::min(kBlock, in.width - x), rows = std::min(kBlock, in.height - y);
  const auto at = [&](int px, int py) {
    return in.row(in.height - 1 - (y + py)) + std::size_t(x + px) * std::size_t(samples);
  };
  const auto inverse_z = [&](float window_z) {
    return float(inverse_near - double(window_z) * inverse_range);
  };
  if (samples == 4 && !tile.expanded[block]) {
    bool partial = false;
    for (int py = 0; py < rows; ++py)
      for (int px = 0; px < columns; ++px) {
        const std::size_t i = at(px, py);
        int covered = 0;
        bool alike = true;
        for (std::size_t s = 0; s < 4; ++s) {
          covered += in.depth[i + s] < 1;
          alike &= in.triangle[i + s] == in.triangle[i];
        }
        partial |= covered != 0 && !(covered == 4 && alike);
      }
    if (partial) tile.expand(block);
  }
  const int planes = samples == 4 ? tile.planes(block) : 1;
  for (int s = 0; s < planes; ++s) {
    FrameTile::Plane& plane = tile.plane(block, s);
    for (int py = 0; py < rows; ++py)
      for (int px = 0; px < columns; ++px) {
        const std::size_t i = at(px, py) + std::size_t(s);
        if (in.depth[i] >= 1) continue;
        const float depth = inverse_z(in.depth[i]);
        const int to = py * kBlock + px;
        if (!(depth > plane.inverse_z[to])) continue;
        plane.inverse_z[to] = depth;
        plane.content[to] = content[i];
      }
  }
  tile.changed[block] = true;
}

void PolygonTiles::draw_tile(FrameTile& tile) const {
  const State& s = *state_;
  if (!s.any) return;
  const SampleBuffer& in = s.raster->seen();
  RILIEVO_EXPECTS(in.width == tile.width && in.height == tile.height && in.samples == tile.samples);
  constexpr int kBlock = FrameTile::kBlock;
  const std::size_t across = State::across(in.width);
  for (int block = 0; block < FrameTile::kBlockCount; ++block) {
    const int x = tile.x + block % FrameTile::kBlocks * kBlock,
              y = tile.y + block / FrameTile::kBlocks * kBlock;
    if (x >= in.width || y >= in.height) continue;
    bool any = false;
    for (int row = y; row < std::min(y + kBlock, in.height); ++row)
      any |= s.covered[std::size_t(in.height - 1 - row) * across + std::size_t(x / kBlock)] != 0;
    if (any) s.draw_block(tile, block, x, y);
  }
}

}  // namespace rilievo
