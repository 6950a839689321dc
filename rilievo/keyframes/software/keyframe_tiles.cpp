#include "rilievo/keyframes/software/keyframe_tiles.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/core/touch_memory.h"
#include "rilievo/keyframes/keyframe_light.h"
#include "rilievo/keyframes/software/hole_points.h"
#include "rilievo/render/software/block_place.h"

namespace rilievo {
namespace {

constexpr int kTileSize = FrameTile::kSize, kBlockSize = FrameTile::kBlock;

static_assert(WarpedFrame::kStrip % kBlockSize == 0, "a block lies in one strip");

// Open holes that a call of a thread looks at.
constexpr std::size_t kOpenRun = 4096;

int tiles_of(int pixels) { return (pixels + kTileSize - 1) / kTileSize; }

}  // namespace

struct KeyframeTiles::State {
  struct SkyDrawer final : TileDrawer {
    const State& state;
    explicit SkyDrawer(const State& state) : state(state) {}
    void draw_tile(FrameTile& tile) const override { state.draw_sky(tile); }
  };

  PixelCaster caster;
  const TileDrawer& scene_sky;
  std::size_t objects;               // of the scene
  std::unique_ptr<bool[]> included;  // by object: can holes show it?
  const WarpedFrame* warped = nullptr;
  const Image<std::uint32_t>* shown = nullptr;  // the objects; null: colours
  Camera camera;
  int samples = 1;                               // that were cast in holes
  bool uses_points = false;                      // there are many holes
  std::vector<FramePixel> holes, open;           // tile by tile; those that no point shows
  std::vector<std::uint32_t> first, first_open;  // of each tile, and the end
  HolePoints points;
  std::vector<FoundInHole> found;             // in the open holes
  std::vector<std::uint32_t> first_found;     // of each run of these, and the end
  mutable std::vector<std::uint32_t> colors;  // of these; 0: not shaded
  std::optional<ShadedScene> view;
  Relight light;
  // Is there one, as points have it? Those with another light are forgotten.
  bool points_have_light = false, forget_points = false;
  mutable tbb::enumerable_thread_specific<SeenTriangles> threads;
  SkyDrawer sky{*this};

  State(const RayScene& rays, const TileDrawer& scene_sky)
      : caster(rays),
        scene_sky(scene_sky),
        objects(rays.scene().objects.size()),
        included(std::make_unique<bool[]>(objects)) {}

  void find_holes();
  void find_open();
  void keep_points();
  void draw_sky(FrameTile& tile) const;
  void copy_sky(FrameTile& tile, int block) const;
  // Of a block in which the sky may be seen: is it plain in any of its pixels, in all?
  struct PlainSky {
    bool any, all;
  };
  [[nodiscard]] PlainSky plain_sky_in(const FrameTile& tile, int block) const;
  [[nodiscard]] std::size_t tile_index(const FrameTile& tile) const;
  void copy_block(FrameTile& tile, int block) const;
  // Of 1 / eye_z in a block; of one that is not whole: anything.
  struct DepthRange {
    float least, most;
  };
  [[nodiscard]] DepthRange range_of(int x, int y, int columns, int rows) const;
  void fill(FrameTile& tile) const;
  void read_tile(FrameTile& tile, std::vector<FilledHole>& filled) const;
  void show_points(FrameTile& tile, std::size_t index) const;
  void cast_open(FrameTile& tile, std::size_t index) const;
  // In the keyframes' light: the colour by rays of an open hole.
  [[nodiscard]] std::uint32_t relit(const SeenTriangles::Pixel& seen, std::uint32_t hole,
                                    std::uint32_t color) const;
};

KeyframeTiles::KeyframeTiles(const RayScene& rays, const TileDrawer& sky)
    : state_(new State(rays, sky)) {}
KeyframeTiles::~KeyframeTiles() = default;

const TileDrawer& KeyframeTiles::sky() const { return state_->sky; }

void KeyframeTiles::State::find_holes() {
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
        if (y0 >= camera.height || warped->holes_in_strip(y0 / WarpedFrame::kStrip, 0) == 0)
          continue;
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

// The holes that no point shows.
void KeyframeTiles::State::find_open() {
  open.clear(), colors.clear();
  first_open.assign(1, 0);
  for (std::size_t tile = 0; tile + 1 < first.size(); ++tile) {
    for (std::uint32_t i = first[tile]; i < first[tile + 1]; ++i)
      if (!uses_points || !points.shows(i)) open.push_back(holes[i]);
    first_open.push_back(std::uint32_t(open.size()));
  }
}

// Takes what rays found in the last frame of colours.
void KeyframeTiles::State::keep_points() {
  if (!uses_points) {
    points.clear();
    return;
  }
  // What rays found in the last frame has the new light.
  if (std::exchange(forget_points, false)) points.clear();
  RILIEVO_EXPECTS(colors.empty() || colors.size() == caster.inverse_z().size());
  // All but surfaces that were not shaded, as something else covers them.
  const auto taken = [&](std::size_t i) { return !(caster.inverse_z()[i] > 0) || colors[i] != 0; };
  const std::size_t runs = (colors.size() + kOpenRun - 1) / kOpenRun;
  const auto end_of = [&](std::size_t run) {
    return std::min((run + 1) * kOpenRun, colors.size());
  };
  first_found.assign(runs + 1, 0);
  parallel_for(std::size_t(0), runs, [&](std::size_t run) {
    std::uint32_t number = 0;
    for (std::size_t i = run * kOpenRun; i < end_of(run); ++i) number += std::uint32_t(taken(i));
    first_found[run + 1] = number;
  });
  for (std::size_t i = 1; i <= runs; ++i) first_found[i] += first_found[i - 1];
  found.resize(first_found.back());
  parallel_for(std::size_t(0), runs, [&](std::size_t run) {
    std::uint32_t to = first_found[run];
    for (std::size_t i = run * kOpenRun; i < end_of(run); ++i) {
      if (!taken(i)) continue;
      FoundInHole& one = found[to++] = {open[i]};
      const float inverse_z = caster.inverse_z()[i];
      if (inverse_z > 0)
        one.inverse_z = inverse_z, one.color = colors[i],
        one.object = caster.object_of(caster.triangles()[i]);
    }
  });
  points.keep(camera, found);
}

void KeyframeTiles::take_memory(int width, int height, std::size_t holes) {
  State& s = *state_;
  touch_memory(s.holes, 2 * holes);
  touch_memory(s.open, holes);
  touch_memory(s.found, holes);
  touch_memory(s.colors, holes);
  s.points.take_memory(width, height, holes);
  s.caster.take_memory(holes);
}

std::size_t KeyframeTiles::least_open(const WarpedFrame& warped) const {
  const std::size_t points = state_->points.size() + state_->colors.size();
  const std::size_t holes = warped.holes();
  return holes - std::min(holes, HolePoints::kMostShown * points);
}

std::size_t KeyframeTiles::find_holes(const Camera& camera, const WarpedFrame& warped,
                                      std::span<const std::uint32_t> objects,
                                      std::size_t most_fine) {
  State& s = *state_;
  s.keep_points();
  s.camera = camera;
  s.warped = &warped;
  s.find_holes();
  s.uses_points = s.holes.size() > most_fine;
  if (s.uses_points) {
    std::fill_n(s.included.get(), s.objects, false);
    for (const std::uint32_t object : objects) s.included[object] = true;
    s.points.show(camera, s.holes, {s.included.get(), s.objects});
  }
  s.find_open();
  return s.open.size();
}

void KeyframeTiles::place(int samples, std::span<const std::uint32_t> objects,
                          std::span<const WarpedKeyframe> keyframes) {
  State& s = *state_;
  const Camera& camera = s.camera;
  RILIEVO_EXPECTS(s.warped);
  s.shown = nullptr;
  s.samples = s.uses_points ? 1 : samples;
  s.caster.cast(camera, s.samples, s.open, s.open.empty() ? objects.first(0) : objects);
  // From now on there is something to take.
  s.colors.assign(s.uses_points ? s.open.size() : 0, 0);
  s.view.emplace(s.caster.view(camera, s.samples));
  s.light.begin(keyframes, camera);
  s.forget_points = s.light.any() != std::exchange(s.points_have_light, s.light.any());
}

void KeyframeTiles::place_objects(const Image<std::uint32_t>& shown,
                                  std::span<const std::uint32_t> objects) {
  State& s = *state_;
  RILIEVO_EXPECTS(s.warped);
  // Rays are cast anew, with one sample: what they found for colours is taken before.
  if (s.uses_points) (void)find_holes(s.camera, *s.warped, objects, 0);
  s.colors.clear();
  s.shown = &shown;
  s.samples = 1;
  s.caster.cast(s.camera, 1, s.open, objects);
}

void KeyframeTiles::State::copy_block(FrameTile& tile, int block) const {
  const BlockPlace place(tile, block);
  if (!place.within()) return;
  const auto [x, y, columns, rows] = place;
  const Image<std::uint32_t>& shows = shown ? *shown : warped->color;
  FrameTile::Plane& plane = tile.first[block];
  // Most blocks are surface: nothing has to be looked for behind it.
  const DepthRange depths_of = range_of(x, y, columns, rows);
  if (!(depths_of.most > tile.nothing)) return;
  if (depths_of.least > tile.nothing) {
    for (int row = 0; row < rows; ++row) {
      const int to = row * kBlockSize;
      std::copy_n(warped->inverse_z.row(y + row).data() + x, kBlockSize, plane.inverse_z + to);
      std::copy_n(shows.row(y + row).data() + x, kBlockSize, plane.content + to);
    }
    tile.farthest[block] = depths_of.least;
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

KeyframeTiles::State::DepthRange KeyframeTiles::State::range_of(int x, int y, int columns,
                                                                int rows) const {
  if (columns < kBlockSize || rows < kBlockSize) return {0, INFINITY};
  float least[kBlockSize], most[kBlockSize];
  std::copy_n(warped->inverse_z.row(y).data() + x, kBlockSize, least);
  std::copy_n(least, kBlockSize, most);
  for (int row = 1; row < kBlockSize; ++row) {
    const float* depths = warped->inverse_z.row(y + row).data() + x;
    for (int i = 0; i < kBlockSize; ++i) {
      least[i] = depths[i] < least[i] ? depths[i] : least[i];
      most[i] = depths[i] > most[i] ? depths[i] : most[i];
    }
  }
  return {*std::min_element(least, least + kBlockSize), *std::max_element(most, most + kBlockSize)};
}

std::size_t KeyframeTiles::State::tile_index(const FrameTile& tile) const {
  return std::size_t(tile.y / kTileSize * tiles_of(tile.width) + tile.x / kTileSize);
}

void KeyframeTiles::State::fill(FrameTile& tile) const {
  const std::size_t index = tile_index(tile);
  if (first[index] == first[index + 1]) return;
  if (uses_points) show_points(tile, index);
  cast_open(tile, index);
}

void KeyframeTiles::State::show_points(FrameTile& tile, std::size_t index) const {
  for (std::uint32_t i = first[index]; i < first[index + 1]; ++i) {
    if (!points.shows(i) || !(points.inverse_z(i) > tile.nothing)) continue;
    const TilePixel at(tile, holes[i].x, holes[i].y);
    tile.first[at.block].inverse_z[at.pixel] = points.inverse_z(i);
    tile.first[at.block].content[at.pixel] = shown ? points.object(i) + 1 : points.color(i);
  }
}

void KeyframeTiles::State::cast_open(FrameTile& tile, std::size_t index) const {
  const std::uint32_t from = first_open[index], to = first_open[index + 1];
  if (from == to) return;
  const std::span<const float> depths = caster.inverse_z();
  const std::span<const std::uint32_t> triangles = caster.triangles();
  SeenTriangles* seen = shown ? nullptr : &threads.local();
  std::uint32_t open_at[kTileSize * kTileSize];
  const unsigned every = (1u << samples) - 1;
  for (std::uint32_t i = from; i < to; ++i) {
    const FramePixel pixel = open[i];
    const std::size_t sample = std::size_t(i) * std::size_t(samples);
    const TilePixel at(tile, pixel.x, pixel.y);
    open_at[at.block * FrameTile::kBlockPixels + at.pixel] = i;
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
  const auto open_of = [&](const TilePixel& at) {
    return open_at[at.block * FrameTile::kBlockPixels + at.pixel];
  };
  seen->shade(*view, [&](const SeenTriangles::Shaded& shaded) {
    std::uint32_t bytes[Surfaces::kMaxCount];
    premultiplied_bytes(shaded.surfaces, shaded.colors, bytes);
    for (std::size_t i = 0; i < shaded.pixels.size(); ++i) {
      const SeenTriangles::Pixel& pixel = shaded.pixels[i];
      const TilePixel at(tile, pixel.x, tile.height - 1 - pixel.y);
      if (light.any()) bytes[i] = relit(pixel, open_of(at), bytes[i]);
      at.for_samples(tile, pixel.samples,
                     [&](FrameTile::Plane& plane) { plane.content[at.pixel] = bytes[i]; });
      if (uses_points) colors[open_of(at)] = bytes[i];
    }
  });
}

std::uint32_t KeyframeTiles::State::relit(const SeenTriangles::Pixel& seen, std::uint32_t hole,
                                          std::uint32_t color) const {
  const std::size_t sample = std::size_t(hole) * std::size_t(samples) +
                             std::size_t(samples == 1 ? 0 : std::countr_zero(seen.samples));
  return light.shown(float(open[hole].x) + 0.5f, float(open[hole].y) + 0.5f,
                     caster.inverse_z()[sample], caster.object_of(seen.triangle), color);
}

void KeyframeTiles::draw_tile(FrameTile& tile) const {
  for (int block = 0; block < FrameTile::kBlockCount; ++block) state_->copy_block(tile, block);
  state_->fill(tile);
}

// The tile holds nothing but what fills its holes.
void KeyframeTiles::State::read_tile(FrameTile& tile, std::vector<FilledHole>& filled) const {
  const std::size_t index = tile_index(tile);
  fill(tile);
  scene_sky.draw_tile(tile);
  for (std::uint32_t i = first[index]; i < first[index + 1]; ++i) {
    const TilePixel at(tile, holes[i].x, holes[i].y);
    FilledHole& hole = filled[i] = {holes[i].x, holes[i].y, kPlainSky, 0};
    const int planes = tile.planes(at.block);
    // Two bytes at a time; half a step, so that the mean is rounded.
    std::uint32_t even = 0, odd = 0;
    for (int s = 0; s < planes; ++s) {
      const FrameTile::Plane& plane = tile.plane(at.block, s);
      const std::uint32_t color = plane.content[at.pixel];
      even += color & 0x00ff00ffu, odd += color >> 8 & 0xffu;
      const float inverse_z = plane.inverse_z[at.pixel];
      if (hole.inverse_z == 0 && inverse_z > tile.nothing) hole.inverse_z = inverse_z;
    }
    if (hole.inverse_z == 0) continue;
    const std::uint32_t half = std::uint32_t(planes / 2), shift = planes == 4 ? 2 : 0;
    even += half << 16 | half, odd += half;
    hole.color = 0xff000000u | (even >> shift & 0x00ff00ffu) | odd >> shift << 8;
  }
}

void KeyframeTiles::read_holes(std::vector<FilledHole>& filled) const {
  const State& s = *state_;
  RILIEVO_EXPECTS(s.warped && !s.shown);
  filled.resize(s.holes.size());
  const int across = tiles_of(s.camera.width);
  parallel_for(0, int(s.first.size()) - 1, [&](int i) {
    if (s.first[std::size_t(i)] == s.first[std::size_t(i) + 1]) return;
    static thread_local const auto memory = std::make_unique<FrameTile>();
    FrameTile& tile = *memory;
    tile.x = i % across * kTileSize, tile.y = i / across * kTileSize;
    tile.width = s.camera.width, tile.height = s.camera.height;
    tile.samples = s.samples;
    tile.of = TileContent::color;
    tile.nothing = float(1 / s.camera.z_far);
    tile.clear(0);
    s.read_tile(tile, filled);
  });
}

void KeyframeTiles::State::draw_sky(FrameTile& tile) const {
  if (tile.of != TileContent::color) return;
  // Without holes keyframes show the sky where it is not plain.
  const std::size_t index = tile_index(tile);
  bool any_plain = first[index] != first[index + 1], all_plain[FrameTile::kBlockCount];
  for (int block = 0; block < FrameTile::kBlockCount; ++block) {
    const PlainSky plain = plain_sky_in(tile, block);
    any_plain = any_plain || plain.any, all_plain[block] = plain.all;
  }
  if (any_plain) scene_sky.draw_tile(tile);
  for (int block = 0; block < FrameTile::kBlockCount; ++block)
    if (!all_plain[block] && (tile.changed[block] || !(tile.farthest[block] > tile.nothing)))
      copy_sky(tile, block);
}

KeyframeTiles::State::PlainSky KeyframeTiles::State::plain_sky_in(const FrameTile& tile,
                                                                  int block) const {
  const BlockPlace place(tile, block);
  if (!place.within() || (!tile.changed[block] && tile.farthest[block] > tile.nothing))
    return {false, true};
  const auto [x, y, columns, rows] = place;
  std::uint32_t plain = 0, others = 0;
  for (int row = 0; row < rows; ++row) {
    const std::uint32_t* colors = warped->color.row(y + row).data() + x;
    // So written that a compiler makes vectors of it.
    for (int column = 0; column < columns; ++column) {
      plain |= std::uint32_t(colors[column] == kPlainSky);
      others |= colors[column] ^ kPlainSky;
    }
  }
  return {plain != 0, others == 0};
}

void KeyframeTiles::State::copy_sky(FrameTile& tile, int block) const {
  const BlockPlace place(tile, block);
  if (!place.within()) return;
  const auto [x, y, columns, rows] = place;
  const int planes = tile.planes(block);
  for (int row = 0; row < rows; ++row) {
    const float* depths = warped->inverse_z.row(y + row).data() + x;
    const std::uint32_t* colors = warped->color.row(y + row).data() + x;
    for (int s = 0; s < planes; ++s) {
      FrameTile::Plane& plane = tile.plane(block, s);
      float* nearest = plane.inverse_z + row * kBlockSize;
      std::uint32_t* contents = plane.content + row * kBlockSize;
      // So written that a compiler makes vectors of it.
      for (int column = 0; column < columns; ++column) {
        const bool shows = !(depths[column] > tile.nothing) & (colors[column] != 0) &
                           (colors[column] != kPlainSky) & !(nearest[column] > tile.nothing);
        contents[column] = shows ? colors[column] : contents[column];
      }
    }
  }
}

}  // namespace rilievo
