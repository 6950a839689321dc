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
template <int kSamples>
bool is_whole(const float* depths, const std::uint32_t* triangles) {
  bool whole = true;
  for (int s = 0; s < kSamples; ++s) whole &= (depths[s] < 1) & (triangles[s] == triangles[0]);
  return whole;
}

template <int kSamples>
bool is_covered(const float* depths) {
  bool covered = false;
  for (int s = 0; s < kSamples; ++s) covered |= depths[s] < 1;
  return covered;
}

// A block of a tile, its part within the frame.
struct BlockRange {
  int x, y, columns, rows;
  BlockRange(const FrameTile& tile, int block)
      : x(tile.x + block % FrameTile::kBlocks * FrameTile::kBlock),
        y(tile.y + block / FrameTile::kBlocks * FrameTile::kBlock),
        columns(std::min(FrameTile::kBlock, tile.width - x)),
        rows(std::min(FrameTile::kBlock, tile.height - y)) {}
};

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
  // Of each block of the frame: is any sample covered? draw_tile() finds it, shade_tile() uses it.
  mutable std::vector<std::uint8_t> covered;
  double inverse_near = 1, inverse_range = 1;  // 1 / eye_z = inverse_near - window_z inverse_range
  mutable tbb::enumerable_thread_specific<TileSamples> threads;
  Shading shading;

  explicit State(const Scene& scene) : scene(scene), shading(*this) {}

  [[nodiscard]] std::uint8_t& covered_at(const BlockRange& block) const {
    const SampleBuffer& in = raster->seen();
    return covered[std::size_t(block.y / FrameTile::kBlock) * blocks_in(in.width) +
                   std::size_t(block.x / FrameTile::kBlock)];
  }
  [[nodiscard]] static std::size_t blocks_in(int pixels) {
    return std::size_t(pixels + FrameTile::kBlock - 1) / FrameTile::kBlock;
  }
  [[nodiscard]] float inverse_z(float window_z) const {
    return float(inverse_near - double(window_z) * inverse_range);
  }

  Result<> rasterize(const Camera& camera, int samples, const PlacedScene& placed,
                     std::span<const std::uint32_t> drawn, std::span<const CrossFade> fading);
  template <int kSamples>
  [[nodiscard]] bool shows_any(const BlockRange& range) const;
  template <int kSamples>
  void draw_block(FrameTile& tile, int block, const BlockRange& range) const;
  void shade_tile(FrameTile& tile) const;
  template <int kSamples>
  bool copy_visible(FrameTile& tile, int block, const BlockRange& range, TileSamples& out) const;
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
  covered.assign(blocks_in(in.width) * blocks_in(in.height), 0);
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

template <int kSamples>
bool PolygonTiles::State::shows_any(const BlockRange& range) const {
  const SampleBuffer& in = raster->seen();
  float nearest = 1;
  for (int row = 0; row < range.rows; ++row) {
    const float* depths = &in.depth[first_sample(in, range.x, range.y + row)];
    for (int i = 0; i < range.columns * kSamples; ++i) nearest = std::min(nearest, depths[i]);
  }
  return nearest < 1;
}

template <int kSamples>
void PolygonTiles::State::draw_block(FrameTile& tile, int block, const BlockRange& range) const {
  constexpr int kBlock = FrameTile::kBlock;
  const SampleBuffer& in = raster->seen();
  if (kSamples == 4 && !tile.expanded[block]) {
    bool partial = false;
    for (int py = 0; py < range.rows; ++py)
      for (int px = 0; px < range.columns; ++px) {
        const std::size_t i = first_sample(in, range.x + px, range.y + py);
        // Without branches: vectors of pixels.
        partial |= bool(int(is_covered<kSamples>(&in.depth[i])) &
                        int(!is_whole<kSamples>(&in.depth[i], &in.triangle[i])));
      }
    if (partial) tile.expand(block);
  }
  const bool identify = tile.of == TileContent::object_id;
  const int planes = kSamples == 4 ? tile.planes(block) : 1;
  for (int s = 0; s < planes; ++s) {
    FrameTile::Plane& plane = tile.plane(block, s);
    for (int py = 0; py < range.rows; ++py) {
      const float* depths = &in.depth[first_sample(in, range.x, range.y + py) + std::size_t(s)];
      for (int px = 0; px < range.columns; ++px) {
        const float window_z = depths[px * kSamples];
        if (window_z >= 1) continue;
        const float depth = inverse_z(window_z);
        const int to = py * kBlock + px;
        if (!(depth > plane.inverse_z[to])) continue;
        plane.inverse_z[to] = depth;
        plane.content[to] =
            identify
                ? objects.object[std::size_t(in.height - 1 - range.y - py) * std::size_t(in.width) +
                                 std::size_t(range.x + px)]
                : 0xff000000u;  // until it is shaded
      }
    }
  }
  tile.changed[block] = true;
}

void PolygonTiles::draw_tile(FrameTile& tile) const {
  const State& s = *state_;
  if (!s.any) return;
  const SampleBuffer& in = s.raster->seen();
  RILIEVO_EXPECTS(in.width == tile.width && in.height == tile.height && in.samples == tile.samples);
  for (int block = 0; block < FrameTile::kBlockCount; ++block) {
    const BlockRange range(tile, block);
    if (range.columns <= 0 || range.rows <= 0) continue;
    const bool shown = in.samples == 4 ? s.shows_any<4>(range) : s.shows_any<1>(range);
    s.covered_at(range) = shown;
    if (!shown) continue;
    in.samples == 4 ? s.draw_block<4>(tile, block, range) : s.draw_block<1>(tile, block, range);
  }
}

// Copies the samples of a block that are not hidden; is there any?
template <int kSamples>
bool PolygonTiles::State::copy_visible(FrameTile& tile, int block, const BlockRange& range,
                                       TileSamples& out) const {
  constexpr int kBlock = FrameTile::kBlock;
  const SampleBuffer& in = raster->seen();
  const int planes = kSamples == 4 ? tile.planes(block) : 1;
  const FrameTile::Plane* plane[kSamples];
  for (int s = 0; s < kSamples; ++s) plane[s] = &tile.plane(block, planes == 1 ? 0 : s);
  bool found = false;
  for (int py = 0; py < range.rows; ++py)
    for (int px = 0; px < range.columns; ++px) {
      const std::size_t from = first_sample(in, range.x + px, range.y + py);
      const std::size_t to =
          first_sample(out.samples, range.x + px - tile.x, range.y + py - tile.y);
      const float* depths = &in.depth[from];
      const std::uint32_t* triangles = &in.triangle[from];
      const int at = py * kBlock + px;
      const bool whole = is_whole<kSamples>(depths, triangles);
      const float first = inverse_z(depths[0]);
      for (int s = 0; s < kSamples; ++s) {
        // A block that was expanded later has the first sample's depth in all of them.
        const float now = plane[s]->inverse_z[at];
        const bool visible =
            (depths[s] < 1) & ((now == inverse_z(depths[s])) | (whole & (now == first)));
        out.samples.depth[to + std::size_t(s)] = visible ? depths[s] : 1.0f;
        out.samples.triangle[to + std::size_t(s)] = triangles[s];
        found |= visible;
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
    const BlockRange range(tile, block);
    if (range.columns <= 0 || range.rows <= 0 || !covered_at(range)) continue;
    if (!begun) local.begin(tile.samples);
    begun = true;
    found[block] = tile.samples == 4 ? copy_visible<4>(tile, block, range, local)
                                     : copy_visible<1>(tile, block, range, local);
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
