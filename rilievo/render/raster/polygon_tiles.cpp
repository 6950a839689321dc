#include "rilievo/render/raster/polygon_tiles.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/core/box_view.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/raster/frame_raster.h"
#include "rilievo/render/raster/polygon_blocks.h"
#include "rilievo/render/software/block_place.h"

namespace rilievo {

namespace {

constexpr int kBlock = FrameTile::kBlock;
// Of so many objects, at most, it is found where in the frame they lie.
constexpr std::size_t kFewObjects = 64;
constexpr std::uint32_t kNotYetShaded = 0xff000000u;

// A rectangle of the frame's pixels: columns [left, right), rows [top, bottom).
struct PixelRect {
  int left = 0, top = 0, right = 0, bottom = 0;

  [[nodiscard]] bool meets(const BlockPlace& block) const {
    return block.x < right && block.x + kBlock > left && block.y < bottom && block.y + kBlock > top;
  }
  // Grows to where a box appears, as rasterisers round.
  void add(const RasterRect& rect) {
    if (rect.empty()) return;
    const PixelRect other{int(rect.left) - 1, int(rect.top) - 1, int(rect.right) + 2,
                          int(rect.bottom) + 2};
    *this = right == left ? other
                          : PixelRect{std::min(left, other.left), std::min(top, other.top),
                                      std::max(right, other.right), std::max(bottom, other.bottom)};
  }
};

// Adds what is visible of a row of pixels, `y` from the bottom.
void add_row(const VisibleRow& row, const std::uint32_t* triangles, int samples, int x, int y,
             std::span<const PlacedMesh> meshes, SeenTriangles& seen) {
  unsigned any = 0, all = row.whole;
  for (int s = 0; s < samples; ++s) any |= row.visible[s], all &= row.visible[s];
  const auto add = [&](int column, std::uint32_t triangle, unsigned mask) {
    seen.add(meshes, {triangle, std::uint16_t(x + column), std::uint16_t(y), std::uint16_t(mask)});
  };
  const unsigned every = (1u << samples) - 1;
  for (int column = 0; any >> column != 0; ++column) {
    if (!(any >> column & 1)) continue;
    const std::uint32_t* of_pixel = triangles + std::ptrdiff_t(column) * samples;
    if (all >> column & 1) {
      add(column, of_pixel[0], every);
      continue;
    }
    unsigned left = 0;
    for (int s = 0; s < samples; ++s) left |= unsigned(row.visible[s] >> column & 1) << s;
    for (int s = 0; left != 0; ++s) {
      if (!(left >> s & 1)) continue;
      unsigned same = 0;
      for (int k = s; k < samples; ++k) same |= unsigned(of_pixel[k] == of_pixel[s]) << k;
      add(column, of_pixel[s], same & left);
      left &= ~same;
    }
  }
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
  std::unique_ptr<FrameVisibility> visibility;  // or rays; null: a FrameRaster, once it is needed
  std::optional<PictureView> view;              // of the frame of colours
  bool any = false;                             // does the frame show any?
  PixelRect reach;                              // where, at most
  ObjectPicture objects;
  // Of each block of the frame: is any sample covered? draw_tile() finds it, shade_tile() uses it.
  mutable std::vector<std::uint8_t> covered;
  TileDepth tile_depth;
  mutable tbb::enumerable_thread_specific<SeenTriangles> threads;
  std::vector<ObjectWork> work;
  Shading shading;

  State(const Scene& scene, std::unique_ptr<FrameVisibility> visibility)
      : scene(scene), visibility(std::move(visibility)), shading(*this) {}

  [[nodiscard]] std::uint8_t& covered_at(const BlockPlace& place) const {
    return covered[std::size_t(place.y / kBlock) * blocks_in(visibility->seen().width) +
                   std::size_t(place.x / kBlock)];
  }
  [[nodiscard]] static std::size_t blocks_in(int pixels) {
    return std::size_t(pixels + kBlock - 1) / kBlock;
  }

  Result<> rasterize(const Camera& camera, int samples, const PlacedScene& placed,
                     std::span<const std::uint32_t> drawn, std::span<const CrossFade> fading);
  void find_reach(const Camera& camera, const PlacedScene& placed,
                  std::span<const std::uint32_t> drawn, std::span<const CrossFade> fading);
  void draw_identifiers(FrameTile& tile, int block, const BlockPlace& place) const;
  void shade_tile(FrameTile& tile) const;
};

Result<> PolygonTiles::State::rasterize(const Camera& camera, int samples,
                                        const PlacedScene& placed,
                                        std::span<const std::uint32_t> drawn,
                                        std::span<const CrossFade> fading) {
  any = !drawn.empty() || !fading.empty();
  for (SeenTriangles& seen : threads) seen.clear_counts();
  if (!any) return Done{};
  if (!visibility) visibility = std::make_unique<FrameRaster>(scene);
  if (Result<> done = visibility->find_visible(camera, samples, placed, drawn, fading); !done) {
    any = false;
    return done;
  }
  tile_depth = {float(1 / camera.z_far), float(1 / camera.z_near - 1 / camera.z_far)};
  const SampleBuffer& in = visibility->seen();
  covered.assign(blocks_in(in.width) * blocks_in(in.height), 0);
  find_reach(camera, placed, drawn, fading);
  return Done{};
}

// Few objects often lie in a small part of the frame: the rest need not be looked through.
void PolygonTiles::State::find_reach(const Camera& camera, const PlacedScene& placed,
                                     std::span<const std::uint32_t> drawn,
                                     std::span<const CrossFade> fading) {
  const PixelRect whole{0, 0, camera.width, camera.height};
  reach = {};
  if (drawn.size() + fading.size() > kFewObjects) {
    reach = whole;
    return;
  }
  const glm::dmat4 eye = eye_from_world(camera);
  const auto add = [&](std::uint32_t object) {
    // Lines and points are wider than their bounds.
    for (const Part& part : scene.models[std::size_t(scene.objects[object].model)].parts)
      if (scene.meshes[std::size_t(part.mesh)].primitive != Primitive::triangles) reach = whole;
    Box box = placed.bounds()[object];
    if (box.empty()) return;
    // Bounds in single precision are rounded, and so are far vertices that a placement brings near.
    const glm::vec3 slack = 4 * std::numeric_limits<float>::epsilon() *
                            (glm::max(glm::abs(box.min), glm::abs(box.max)) +
                             glm::abs(glm::vec3(placed.poses()[object][3])));
    box.min -= slack, box.max += slack;
    reach.add(rect_of_box(camera, view_of_box(eye, box, Projection::perspective)));
  };
  for (const std::uint32_t object : drawn) add(object);
  for (const CrossFade& one : fading) add(one.object);
  reach = {std::max(reach.left, 0), std::max(reach.top, 0), std::min(reach.right, camera.width),
           std::min(reach.bottom, camera.height)};
}

PolygonTiles::PolygonTiles(const Scene& scene, std::unique_ptr<FrameVisibility> visibility)
    : state_(new State(scene, std::move(visibility))) {}
PolygonTiles::~PolygonTiles() = default;

const TileDrawer& PolygonTiles::shading() const { return state_->shading; }

Result<> PolygonTiles::place(const Camera& camera, int samples, const PlacedScene& placed,
                             std::span<const std::uint32_t> objects,
                             std::span<const CrossFade> fading) {
  State& s = *state_;
  if (Result<> done = s.rasterize(camera, samples, placed, objects, fading); !done || !s.any)
    return done;
  s.view.emplace(s.visibility->view(camera));
  return Done{};
}

Result<> PolygonTiles::place_objects(const Camera& camera, const PlacedScene& placed,
                                     std::span<const std::uint32_t> objects,
                                     std::span<const CrossFade> fading) {
  State& s = *state_;
  if (Result<> done = s.rasterize(camera, 1, placed, objects, fading); !done || !s.any) return done;
  identify(s.visibility->seen(), s.visibility->meshes(), s.objects);
  return Done{};
}

void PolygonTiles::find_cover(const Camera& camera, Image<float>& cover) const {
  const State& s = *state_;
  if (cover.width() != camera.width || cover.height() != camera.height)
    cover = Image<float>(camera.width, camera.height);
  if (!s.any) {
    std::ranges::fill(cover.texels(), 0.0f);
    return;
  }
  const SampleBuffer& in = s.visibility->seen();
  const PixelRect& reach = s.reach;
  parallel_for(0, camera.height, [&](int y) {
    float* const to = cover.row(y).data();
    const bool reached = reach.top <= y && y < reach.bottom;
    std::fill_n(to, reached ? reach.left : camera.width, 0.0f);
    if (!reached) return;
    std::fill(to + reach.right, to + camera.width, 0.0f);
    const float* depths =
        in.depths(camera.height - 1 - y) + std::ptrdiff_t(reach.left) * in.samples;
    for (int x = reach.left; x < reach.right; ++x, depths += in.samples) {
      float farthest = depths[0];
      for (int i = 1; i < in.samples; ++i) farthest = std::max(farthest, depths[i]);
      to[x] = farthest < 1 ? s.tile_depth(farthest) : 0;
    }
  });
}

std::span<const ObjectWork> PolygonTiles::work() {
  State& s = *state_;
  s.work.clear();
  if (!s.any) return s.work;
  const std::span<const PlacedMesh> meshes = s.visibility->meshes();
  const std::span<const MeshWork> work = s.visibility->work();
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (s.work.empty() || s.work.back().object != meshes[i].object)
      s.work.push_back({meshes[i].object});
    ObjectWork& object = s.work.back();
    if (!work.empty()) object.projected += work[i].projected, object.filled += work[i].filled;
    for (const SeenTriangles& seen : s.threads) object.shaded += seen.shaded_of(i);
  }
  return s.work;
}

void PolygonTiles::State::draw_identifiers(FrameTile& tile, int block,
                                           const BlockPlace& place) const {
  FrameTile::Plane& plane = tile.plane(block, 0);
  for (int row = 0; row < place.rows; ++row)
    for (int column = 0; column < place.columns; ++column) {
      const std::size_t from =
          std::size_t(tile.height - 1 - place.y - row) * std::size_t(tile.width) +
          std::size_t(place.x + column);
      if (objects.depth[from] >= 1) continue;
      const float depth = tile_depth(objects.depth[from]);
      const int to = row * kBlock + column;
      if (!(depth > plane.inverse_z[to])) continue;
      plane.inverse_z[to] = depth;
      plane.content[to] = objects.object[from];
    }
}

void PolygonTiles::draw_tile(FrameTile& tile) const {
  const State& s = *state_;
  if (!s.any) return;
  const SampleBuffer& in = s.visibility->seen();
  RILIEVO_EXPECTS(in.width == tile.width && in.height == tile.height && in.samples == tile.samples);
  for (int block = 0; block < FrameTile::kBlockCount; ++block) {
    const BlockPlace place(tile, block);
    if (!place.within() || !s.reach.meets(place)) continue;
    const BlockSamples samples(in, place.x, place.y);
    const BlockCoverage coverage = find_coverage(samples);
    s.covered_at(place) = coverage.any;
    if (!coverage.any) continue;
    tile.changed[block] = true;
    if (tile.of == TileContent::object_id) {
      s.draw_identifiers(tile, block, place);
      continue;
    }
    if (coverage.partial && tile.samples == 4) tile.expand(block);
    draw_depths(samples, s.tile_depth, kNotYetShaded, tile, block);
  }
}

void PolygonTiles::State::shade_tile(FrameTile& tile) const {
  if (!any || tile.of != TileContent::color) return;
  const SampleBuffer& in = visibility->seen();
  SeenTriangles& seen = threads.local();
  for (int block = 0; block < FrameTile::kBlockCount; ++block) {
    const BlockPlace place(tile, block);
    if (!place.within() || !covered_at(place)) continue;
    const BlockSamples samples(in, place.x, place.y);
    for (int row = 0; row < place.rows; ++row)
      add_row(find_visible(samples, tile_depth, tile, block, row), samples.triangles[row],
              in.samples, place.x, tile.height - 1 - place.y - row, view->scene.meshes, seen);
  }
  seen.shade(view->scene, [&](const SeenTriangles::Shaded& shaded) {
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

}  // namespace rilievo
