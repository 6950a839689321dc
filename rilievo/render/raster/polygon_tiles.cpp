// Depth is window_z in the rasteriser and 1 / eye_z in tiles, and one is affine in the other:
//
//   window_z = (1 / z_near - 1 / eye_z) / (1 / z_near - 1 / z_far)
//
// A sample of a tile still shows its triangle if it still has the triangle's depth: what was drawn
// between was nearer.
#include "rilievo/render/raster/polygon_tiles.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/raster/frame_raster.h"
#include "rilievo/render/raster/tile_samples.h"

namespace rilievo {

namespace {

// Do all samples of a pixel show one triangle?
bool is_whole(const SampleBuffer& in, std::size_t first) {
  bool whole = true;
  for (std::size_t i = first; i < first + std::size_t(in.samples); ++i)
    whole &= in.depth[i] < 1 && in.triangle[i] == in.triangle[first];
  return whole;
}

}  // namespace

struct PolygonTiles::State {
  // The second step.
  struct Shading final : TileDrawer {
    const State& state;
    explicit Shading(const State& state) : state(state) {}
    void draw_tile(FrameTile& tile) const override { state.shade_tile(tile); }
  };

  const Scene& scene;
  std::unique_ptr<FrameRaster> raster;  // null: nothing has been drawn yet
  std::optional<PictureView> view;      // of the frame of colours
  bool any = false;                     // does the frame show any?
  ObjectPicture objects;
  std::vector<std::uint8_t> covered;  // of each row, of each 8 pixels: is any sample covered?
  double inverse_near = 1, inverse_range = 1;  // 1 / eye_z = inverse_near - window_z inverse_range
  mutable tbb::enumerable_thread_specific<TileSamples> threads;
  Shading shading;

  explicit State(const Scene& scene) : scene(scene), shading(*this) {}

  // The number of blocks across; rows are the SampleBuffer's.
  [[nodiscard]] static std::size_t across(int width) {
    return std::size_t(width + FrameTile::kBlock - 1) / FrameTile::kBlock;
  }
  [[nodiscard]] float inverse_z(float window_z) const {
    return float(inverse_near - double(window_z) * inverse_range);
  }

  Result<> rasterize(const Camera& camera, int samples, const PlacedScene& placed,
                     std::span<const std::uint32_t> drawn, std::span<const CrossFade> fading);
  [[nodiscard]] bool shows_any(int x, int y) const;
  void draw_block(FrameTile& tile, int block, int x, int y) const;
  void shade_tile(FrameTile& tile) const;
  bool copy_visible(FrameTile& tile, int block, int x, int y, TileSamples& out) const;
  static void write_colors(FrameTile& tile, int block, int x, int y, const TileSamples& from);
};

Result<> PolygonTiles::State::rasterize(const Camera& camera, int samples,
                                        const PlacedScene& placed,
                                        std::span<const std::uint32_t> drawn,
                                        std::span<const CrossFade> fading) {
  any = !drawn.empty() || !fading.empty();
  if (!any) return Done{};
  if (!raster) raster = std::make_unique<FrameRaster>(scene);
  if (Result<> done = raster->rasterize(camera, samples, placed, drawn, fading); !done) {
    any = false;
    return done;
  }
  inverse_near = 1 / camera.z_near;
  inverse_range = 1 / camera.z_near - 1 / camera.z_far;
  const SampleBuffer& in = raster->seen();
  covered.resize(across(in.width) * std::size_t(in.height));
  parallel_for(0, in.height, [&](int y) {
    const float* depths = in.depths(y);
    std::uint8_t* flags = &covered[std::size_t(y) * across(in.width)];
    for (int x = 0; x < in.width; x += FrameTile::kBlock) {
      const int end = std::min(x + FrameTile::kBlock, in.width) * in.samples;
      float nearest = 1;
      for (int i = x * in.samples; i < end; ++i) nearest = std::min(nearest, depths[i]);
      flags[x / FrameTile::kBlock] = nearest < 1;
    }
  });
  return Done{};
}

PolygonTiles::PolygonTiles(const Scene& scene) : state_(new State(scene)) {}
PolygonTiles::~PolygonTiles() = default;

const TileDrawer& PolygonTiles::shading() const { return state_->shading; }

Result<> PolygonTiles::place(const Camera& camera, int samples, const PlacedScene& placed,
                             std::span<const std::uint32_t> objects,
                             std::span<const CrossFade> fading) {
  State& s = *state_;
  if (Result<> done = s.rasterize(camera, samples, placed, objects, fading); !done || !s.any)
    return done;
  s.view.emplace(s.raster->view(camera));
  return Done{};
}

Result<> PolygonTiles::place_objects(const Camera& camera, const PlacedScene& placed,
                                     std::span<const std::uint32_t> objects,
                                     std::span<const CrossFade> fading) {
  State& s = *state_;
  if (Result<> done = s.rasterize(camera, 1, placed, objects, fading); !done || !s.any) return done;
  identify(s.raster->seen(), s.raster->meshes(), s.objects);
  return Done{};
}

// Is any sample covered in the block whose upper left pixel in the frame is (x, y)?
bool PolygonTiles::State::shows_any(int x, int y) const {
  const SampleBuffer& in = raster->seen();
  if (x >= in.width || y >= in.height) return false;
  bool shown = false;
  for (int row = y; row < std::min(y + FrameTile::kBlock, in.height); ++row)
    shown |= covered[std::size_t(in.height - 1 - row) * across(in.width) +
                     std::size_t(x / FrameTile::kBlock)] != 0;
  return shown;
}

void PolygonTiles::State::draw_block(FrameTile& tile, int block, int x, int y) const {
  constexpr int kBlock = FrameTile::kBlock;
  const SampleBuffer& in = raster->seen();
  const int columns = std::min(kBlock, in.width - x), rows = std::min(kBlock, in.height - y);
  const bool identify = tile.of == TileContent::object_id;
  if (in.samples == 4 && !tile.expanded[block]) {
    bool partial = false;
    for (int py = 0; py < rows; ++py)
      for (int px = 0; px < columns; ++px) {
        const std::size_t i = first_sample(in, x + px, y + py);
        bool any_covered = false;
        for (std::size_t s = 0; s < 4; ++s) any_covered |= in.depth[i + s] < 1;
        partial |= any_covered && !is_whole(in, i);
      }
    if (partial) tile.expand(block);
  }
  const int planes = in.samples == 4 ? tile.planes(block) : 1;
  for (int s = 0; s < planes; ++s) {
    FrameTile::Plane& plane = tile.plane(block, s);
    for (int py = 0; py < rows; ++py)
      for (int px = 0; px < columns; ++px) {
        const std::size_t i = first_sample(in, x + px, y + py) + std::size_t(s);
        if (in.depth[i] >= 1) continue;
        const float depth = inverse_z(in.depth[i]);
        const int to = py * kBlock + px;
        if (!(depth > plane.inverse_z[to])) continue;
        plane.inverse_z[to] = depth;
        plane.content[to] =
            identify ? objects.object[std::size_t(in.height - 1 - y - py) * std::size_t(in.width) +
                                      std::size_t(x + px)]
                     : 0xff000000u;  // until it is shaded
      }
  }
  tile.changed[block] = true;
}

void PolygonTiles::draw_tile(FrameTile& tile) const {
  const State& s = *state_;
  if (!s.any) return;
  [[maybe_unused]] const SampleBuffer& in = s.raster->seen();
  RILIEVO_EXPECTS(in.width == tile.width && in.height == tile.height && in.samples == tile.samples);
  for (int block = 0; block < FrameTile::kBlockCount; ++block) {
    const int x = tile.x + block % FrameTile::kBlocks * FrameTile::kBlock,
              y = tile.y + block / FrameTile::kBlocks * FrameTile::kBlock;
    if (s.shows_any(x, y)) s.draw_block(tile, block, x, y);
  }
}

// Copies the samples of a block that are not hidden; is there any?
bool PolygonTiles::State::copy_visible(FrameTile& tile, int block, int x, int y,
                                       TileSamples& out) const {
  constexpr int kBlock = FrameTile::kBlock;
  const SampleBuffer& in = raster->seen();
  const int columns = std::min(kBlock, in.width - x), rows = std::min(kBlock, in.height - y);
  const int planes = in.samples == 4 ? tile.planes(block) : 1;
  bool found = false;
  for (int py = 0; py < rows; ++py)
    for (int px = 0; px < columns; ++px) {
      const std::size_t from = first_sample(in, x + px, y + py);
      const std::size_t to = first_sample(out.samples, x + px - tile.x, y + py - tile.y);
      const int at = py * kBlock + px;
      const bool whole = is_whole(in, from);
      for (std::size_t s = 0; s < std::size_t(in.samples); ++s) {
        if (in.depth[from + s] >= 1) continue;
        // A block that was expanded later has the first sample's depth in all of them.
        const float now = tile.plane(block, planes == 1 ? 0 : int(s)).inverse_z[at];
        if (now != inverse_z(in.depth[from + s]) && !(whole && now == inverse_z(in.depth[from])))
          continue;
        out.samples.depth[to + s] = in.depth[from + s];
        out.samples.triangle[to + s] = in.triangle[from + s];
        found = true;
      }
    }
  return found;
}

void PolygonTiles::State::write_colors(FrameTile& tile, int block, int x, int y,
                                       const TileSamples& from) {
  constexpr int kBlock = FrameTile::kBlock;
  const int planes = from.samples.samples == 4 ? tile.planes(block) : 1;
  for (int s = 0; s < planes; ++s) {
    FrameTile::Plane& plane = tile.plane(block, s);
    for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
      const std::size_t at =
          first_sample(from.samples, x - tile.x + i % kBlock, y - tile.y + i / kBlock) +
          std::size_t(s);
      if (from.samples.depth[at] < 1) plane.content[i] = from.colors[at];
    }
  }
}

void PolygonTiles::State::shade_tile(FrameTile& tile) const {
  if (!any || tile.of != TileContent::color) return;
  constexpr int kBlock = FrameTile::kBlock, kBlocks = FrameTile::kBlocks;
  TileSamples& local = threads.local();
  bool begun = false, found[FrameTile::kBlockCount] = {};
  for (int block = 0; block < FrameTile::kBlockCount; ++block) {
    const int x = tile.x + block % kBlocks * kBlock, y = tile.y + block / kBlocks * kBlock;
    if (!shows_any(x, y)) continue;
    if (!begun) local.begin(tile.samples);
    begun = true;
    found[block] = copy_visible(tile, block, x, y, local);
  }
  if (!begun) return;
  for (int row = 0; row < kBlocks; ++row) {
    if (std::none_of(found + row * kBlocks, found + (row + 1) * kBlocks,
                     [](bool one) { return one; }))
      continue;
    local.shade_blocks(*view, tile, row);
    for (int block = row * kBlocks; block < (row + 1) * kBlocks; ++block)
      if (found[block])
        write_colors(tile, block, tile.x + block % kBlocks * kBlock, tile.y + row * kBlock, local);
  }
}

}  // namespace rilievo
