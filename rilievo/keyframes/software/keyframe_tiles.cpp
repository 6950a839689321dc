#include "rilievo/keyframes/software/keyframe_tiles.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <optional>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr int kTileSize = FrameTile::kSize, kBlockSize = FrameTile::kBlock;

int tiles_of(int pixels) { return (pixels + kTileSize - 1) / kTileSize; }

}  // namespace

struct KeyframeTiles::State {
  struct SkyDrawer final : TileDrawer {
    const State& state;
    explicit SkyDrawer(const State& state) : state(state) {}
    void draw_tile(FrameTile& tile) const override { state.draw_sky(tile); }
  };

  PixelCaster caster;
  const WarpedFrame* warped = nullptr;
  const Image<std::uint32_t>* shown = nullptr;  // the objects; null: colours
  int samples = 1;                              // that were cast in holes
  std::vector<FramePixel> holes;                // tile by tile
  std::vector<std::uint32_t> first;             // of each tile, and the end
  std::optional<ShadedScene> view;
  mutable tbb::enumerable_thread_specific<SeenTriangles> threads;
  SkyDrawer sky{*this};

  explicit State(const RayScene& rays) : caster(rays) {}

  void find_holes(const Camera& camera);
  void draw_sky(FrameTile& tile) const;
  void copy_block(FrameTile& tile, int block) const;
  [[nodiscard]] float farthest_in(int x, int y, int columns, int rows) const;
  void fill(FrameTile& tile) const;
};

KeyframeTiles::KeyframeTiles(const RayScene& rays) : state_(new State(rays)) {}
KeyframeTiles::~KeyframeTiles() = default;

const TileDrawer& KeyframeTiles::sky() const { return state_->sky; }

void KeyframeTiles::State::find_holes(const Camera& camera) {
  const int across = tiles_of(camera.width), count = across * tiles_of(camera.height);
  holes.clear();
  first.assign(std::size_t(count) + 1, 0);
  if (warped->holes() > 0) {
    // First how many, then where: a tile's holes lie together.
    const auto visit = [&](int tile, const auto& hole) {
      // Block by block: rays that are cast together lie close together.
      for (int block = 0; block < FrameTile::kBlockCount; ++block) {
        const int x0 = tile % across * kTileSize + block % FrameTile::kBlocks * kBlockSize,
                  y0 = tile / across * kTileSize + block / FrameTile::kBlocks * kBlockSize;
        for (int y = y0; y < std::min(y0 + kBlockSize, camera.height); ++y)
          for (int x = x0; x < std::min(x0 + kBlockSize, camera.width); ++x)
            if (warped->hole(x, y)) hole(FramePixel{std::uint16_t(x), std::uint16_t(y)});
      }
    };
    parallel_for(0, count, [&](int tile) {
      std::uint32_t number = 0;
      visit(tile, [&](FramePixel) { ++number; });
      first[std::size_t(tile) + 1] = number;
    });
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    holes.resize(first.back());
    parallel_for(0, count, [&](int tile) {
      std::uint32_t to = first[std::size_t(tile)];
      if (first[std::size_t(tile) + 1] > to) visit(tile, [&](FramePixel at) { holes[to++] = at; });
    });
  }
}

void KeyframeTiles::place(const Camera& camera, int samples, const WarpedFrame& warped,
                          std::span<const std::uint32_t> objects, std::size_t most_fine) {
  State& s = *state_;
  s.warped = &warped;
  s.shown = nullptr;
  s.find_holes(camera);
  s.samples = s.holes.size() > most_fine ? 1 : samples;
  s.caster.cast(camera, s.samples, s.holes, s.holes.empty() ? objects.first(0) : objects);
  s.view.emplace(s.caster.view(camera, s.samples));
}

void KeyframeTiles::place_objects(const Camera& camera, const WarpedFrame& warped,
                                  const Image<std::uint32_t>& shown,
                                  std::span<const std::uint32_t> objects) {
  State& s = *state_;
  s.warped = &warped;
  s.shown = &shown;
  s.find_holes(camera);
  s.samples = 1;
  s.caster.cast(camera, 1, s.holes, objects);
}

void KeyframeTiles::State::copy_block(FrameTile& tile, int block) const {
  const int x = tile.x + block % FrameTile::kBlocks * kBlockSize,
            y = tile.y + block / FrameTile::kBlocks * kBlockSize;
  if (x >= tile.width || y >= tile.height) return;
  const int columns = std::min(kBlockSize, tile.width - x),
            rows = std::min(kBlockSize, tile.height - y);
  const Image<std::uint32_t>& shows = shown ? *shown : warped->color;
  FrameTile::Plane& plane = tile.first[block];
  // Most blocks are surface: nothing has to be looked for behind it.
  if (const float farthest = farthest_in(x, y, columns, rows); farthest > tile.nothing) {
    for (int row = 0; row < rows; ++row) {
      const int to = row * kBlockSize;
      std::copy_n(warped->inverse_z.row(y + row).data() + x, kBlockSize, plane.inverse_z + to);
      std::copy_n(shows.row(y + row).data() + x, kBlockSize, plane.content + to);
    }
    tile.farthest[block] = farthest;
    return;
  }
  for (int row = 0; row < rows; ++row) {
    const float* depths = warped->inverse_z.row(y + row).data() + x;
    const std::uint32_t* contents = shows.row(y + row).data() + x;
    for (int column = 0; column < columns; ++column) {
      const int to = row * kBlockSize + column;
      if (!(depths[column] > tile.nothing)) continue;
      plane.inverse_z[to] = depths[column];
      plane.content[to] = contents[column];
    }
  }
  tile.changed[block] = true;
}

// The least 1 / eye_z of a block; 0 of one that is not whole.
float KeyframeTiles::State::farthest_in(int x, int y, int columns, int rows) const {
  if (columns < kBlockSize || rows < kBlockSize) return 0;
  float least[kBlockSize];
  std::copy_n(warped->inverse_z.row(y).data() + x, kBlockSize, least);
  for (int row = 1; row < kBlockSize; ++row) {
    const float* depths = warped->inverse_z.row(y + row).data() + x;
    for (int i = 0; i < kBlockSize; ++i) least[i] = depths[i] < least[i] ? depths[i] : least[i];
  }
  return *std::min_element(least, least + kBlockSize);
}

void KeyframeTiles::State::fill(FrameTile& tile) const {
  const int across = tiles_of(tile.width);
  const auto index = std::size_t(tile.y / kTileSize * across + tile.x / kTileSize);
  const std::uint32_t from = first[index], to = first[index + 1];
  if (from == to) return;
  const std::span<const float> depths = caster.inverse_z();
  const std::span<const std::uint32_t> triangles = caster.triangles();
  SeenTriangles* seen = shown ? nullptr : &threads.local();
  const unsigned every = (1u << samples) - 1;
  for (std::uint32_t i = from; i < to; ++i) {
    const FramePixel pixel = holes[i];
    const std::size_t sample = std::size_t(i) * std::size_t(samples);
    const TilePixel at(tile, pixel.x, pixel.y);
    if (!seen) {
      if (!(depths[sample] > tile.nothing)) continue;
      tile.first[at.block].inverse_z[at.pixel] = depths[sample];
      tile.first[at.block].content[at.pixel] = caster.object_of(triangles[sample]) + 1;
      continue;
    }
    unsigned left = 0;
    for (int s = 0; s < samples; ++s)
      left |= unsigned(depths[sample + std::size_t(s)] > tile.nothing) << s;
    if (left == 0) continue;
    const std::uint16_t y = std::uint16_t(tile.height - 1 - pixel.y);
    // Whole if all show one triangle: then one depth stands for all.
    bool whole = left == every;
    for (int s = 1; whole && s < samples; ++s)
      whole = triangles[sample + std::size_t(s)] == triangles[sample];
    if (!whole && samples == 4) tile.expand(at.block);
    const int planes = tile.planes(at.block);
    for (int s = 0; s < planes; ++s) {
      const int of = samples == 4 && !whole ? s : 0;
      if (left >> of & 1)
        tile.plane(at.block, s).inverse_z[at.pixel] = depths[sample + std::size_t(of)];
    }
    if (whole || samples == 1) {
      seen->add(caster.meshes(), {triangles[sample], pixel.x, y, std::uint16_t(every)});
      continue;
    }
    for (int s = 0; left != 0; ++s) {
      if (!(left >> s & 1)) continue;
      unsigned same = 0;
      for (int k = s; k < samples; ++k)
        same |= unsigned(triangles[sample + std::size_t(k)] == triangles[sample + std::size_t(s)])
                << k;
      same &= left;
      seen->add(caster.meshes(),
                {triangles[sample + std::size_t(s)], pixel.x, y, std::uint16_t(same)});
      left &= ~same;
    }
  }
  if (!seen) return;
  seen->shade(*view, [&](const SeenTriangles::Shaded& shaded) {
    std::uint32_t bytes[Surfaces::kMaxCount];
    premultiplied_bytes(shaded.surfaces, shaded.colors, bytes);
    for (std::size_t i = 0; i < shaded.pixels.size(); ++i) {
      const SeenTriangles::Pixel& pixel = shaded.pixels[i];
      const TilePixel at(tile, pixel.x, tile.height - 1 - pixel.y);
      at.for_samples(tile, pixel.samples,
                     [&](FrameTile::Plane& plane) { plane.content[at.pixel] = bytes[i]; });
    }
  });
}

void KeyframeTiles::draw_tile(FrameTile& tile) const {
  for (int block = 0; block < FrameTile::kBlockCount; ++block) state_->copy_block(tile, block);
  state_->fill(tile);
}

void KeyframeTiles::State::draw_sky(FrameTile& tile) const {
  if (tile.of != TileContent::color) return;
  for (int block = 0; block < FrameTile::kBlockCount; ++block) {
    const int x = tile.x + block % FrameTile::kBlocks * kBlockSize,
              y = tile.y + block / FrameTile::kBlocks * kBlockSize;
    if (!tile.changed[block] && tile.farthest[block] > tile.nothing) continue;
    const int columns = std::min(kBlockSize, tile.width - x),
              rows = std::min(kBlockSize, tile.height - y);
    const int planes = tile.planes(block);
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        if (warped->inverse_z(x + column, y + row) > tile.nothing ||
            warped->hole(x + column, y + row))
          continue;
        for (int s = 0; s < planes; ++s) {
          FrameTile::Plane& plane = tile.plane(block, s);
          const int at = row * kBlockSize + column;
          if (!(plane.inverse_z[at] > tile.nothing))
            plane.content[at] = warped->color(x + column, y + row);
        }
      }
  }
}

}  // namespace rilievo
