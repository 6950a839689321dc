// A tile gathers triangles in their order, until one covers a sample that is taken already: then
// what was gathered is shaded together (seen_triangles.h), blended, and a new round begins.
#include "rilievo/render/raster/blended_tiles.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/draw_list.h"
#include "rilievo/render/raster/blended_triangle.h"
#include "rilievo/render/raster/near_clip.h"
#include "rilievo/render/raster/raster_instances.h"
#include "rilievo/render/shading/picture_shader.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {
namespace {

constexpr int kTile = FrameTile::kSize, kBlockSide = FrameTile::kBlock;

std::uint32_t blend(std::uint32_t under, std::uint32_t over) {
  const std::uint32_t through = 255 - (over >> 24);
  std::uint32_t out = 0;
  for (int shift = 0; shift < 32; shift += 8) {
    const std::uint32_t below = (under >> shift & 0xffu) * through;
    out |= std::min(255u, (over >> shift & 0xffu) + (below + 127) / 255) << shift;
  }
  return out;
}

// What of a tile waits to be shaded together. A thread's own; empty between tiles.
struct Gathered {
  SeenTriangles seen;
  std::uint8_t taken[kTile * kTile] = {};  // of each pixel, its samples that are taken
  float farthest[FrameTile::kBlockCount];  // of each block, the least 1 / eye_z
  // Of one triangle.
  struct Cover {
    std::uint16_t x, y;  // in the frame
    std::uint8_t samples;
  };
  std::vector<Cover> covers;  // kept, so that drawing does not allocate

  void find_farthest(FrameTile& tile) {
    for (int block = 0; block < FrameTile::kBlockCount; ++block) {
      farthest[block] = HUGE_VALF;
      for (int s = 0; s < tile.planes(block); ++s)
        for (const float inverse_z : tile.plane(block, s).inverse_z)
          farthest[block] = std::min(farthest[block], inverse_z);
    }
  }
  [[nodiscard]] std::uint8_t& taken_at(const FrameTile& tile, int x, int y) {
    return taken[(y - tile.y) * kTile + x - tile.x];
  }
};

}  // namespace

struct BlendedTiles::State {
  const Scene& scene;
  std::optional<SurfaceMaterials> materials;  // none: nothing has been drawn yet
  DrawList list;
  std::vector<PlacedMesh> placed;
  std::vector<RasterInstance> instances;
  std::vector<RasterMask> masks;
  std::vector<Light> lights;
  NearClip clip;
  // Some triangles of an instance, in order; those of them that can be seen, kept for their memory.
  struct Run {
    RasterInstance instance;
    std::uint32_t first = 0, count = 0;
    std::size_t place = 0;  // of its triangles among all
    std::vector<BlendedTriangle> triangles;
  };
  std::vector<Run> runs;
  std::size_t run_count = 0;                 // of those in use
  std::vector<BlendedTriangle> triangles;    // in their order
  std::vector<std::uint32_t> first, listed;  // of each tile, as NailboardComposer's
  int across = 0, down = 0;
  std::optional<ShadedScene> shaded;
  mutable tbb::enumerable_thread_specific<Gathered> threads;

  explicit State(const Scene& scene) : scene(scene) {}

  void place_all(const Camera& camera, int samples, const PlacedScene& from,
                 std::span<const std::uint32_t> objects);
  void add_runs(const RasterInstance& instance, const FarthestBlocks& nothing);
  void place_runs(const Camera& camera, int samples);
  void list_tiles();
  bool add(FrameTile& tile, const BlendedTriangle& t, Gathered& into) const;
  bool add_in(FrameTile& tile, const BlendedTriangle& t, const TriangleEdges& edges,
              const PixelRange& rect, Gathered& into) const;
  void flush(FrameTile& tile, Gathered& from) const;
};

// Those that are not beside the frame.
void BlendedTiles::State::add_runs(const RasterInstance& instance, const FarthestBlocks& nothing) {
  for (std::uint32_t first = 0; first < instance.triangles; first += Mesh::kRun) {
    if (!instance.boxes.empty() &&
        !can_be_seen(instance, instance.boxes[first / Mesh::kRun], nothing))
      continue;
    if (run_count == runs.size()) runs.emplace_back();
    Run& run = runs[run_count++];
    run.instance = instance;
    run.first = first, run.count = std::min<std::uint32_t>(Mesh::kRun, instance.triangles - first);
  }
}

void BlendedTiles::State::place_runs(const Camera& camera, int samples) {
  parallel_for(std::size_t(0), run_count, [&](std::size_t i) {
    Run& run = runs[i];
    const RasterInstance& in = run.instance;
    run.triangles.clear();
    for (std::uint32_t k = run.first; k < run.first + run.count; ++k)
      place_blended(camera, samples, in, in.numbers ? in.numbers[k] : in.first_triangle + k,
                    in.indices + 3 * std::size_t(k), run.triangles);
  });
  std::size_t count = 0;
  for (std::size_t i = 0; i < run_count; ++i)
    runs[i].place = count, count += runs[i].triangles.size();
  triangles.resize(count);
  parallel_for(std::size_t(0), run_count, [&](std::size_t i) {
    std::copy(runs[i].triangles.begin(), runs[i].triangles.end(),
              triangles.begin() + std::ptrdiff_t(runs[i].place));
  });
}

void BlendedTiles::State::place_all(const Camera& camera, int samples, const PlacedScene& from,
                                    std::span<const std::uint32_t> objects) {
  list.build_back_to_front(scene, camera, objects, from.poses(), from.bounds(),
                           from.blended_meshes());
  placed.clear();
  std::uint64_t count = 0;
  for (const Batch& batch : list.batches()) {
    const Mesh& mesh = scene.meshes[batch.mesh];
    const Placement& at = list.instances()[batch.first];
    placed.push_back(
        {&mesh, place_surface(mesh, materials->of_mesh(int(batch.mesh)), at.relative_from_mesh),
         std::uint32_t(count), std::uint32_t(mesh.triangles()), at.object});
    count += mesh.triangles();
  }
  RILIEVO_EXPECTS(count < 0xFFFFFFFFu);
  make_instances(camera, placed, instances, masks);
  clip.clear();
  run_count = 0;
  FarthestBlocks nothing;  // is known of what hides them
  nothing.begin(camera.width, camera.height);
  const float z_near = float(camera.z_near);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    RasterInstance& one = instances[i];
    const bool cut = NearClip::crosses(one, placed[i].mesh->bounds, z_near) &&
                     clip.cut(*placed[i].mesh, camera.width, camera.height, z_near, one);
    add_runs(one, nothing);
    // What reaches behind the eye comes last of its mesh.
    if (cut) add_runs(clip.instances().back(), nothing);
  }
  place_runs(camera, samples);
  across = (camera.width + kTile - 1) / kTile, down = (camera.height + kTile - 1) / kTile;
  shaded.emplace(ShadedScene{placed, picture_rays(camera),
                             surface_lights(scene, camera.position(), lights), samples});
}

// A list for each tile: counted, then filled.
void BlendedTiles::State::list_tiles() {
  const auto each_tile = [&](const BlendedTriangle& t, const auto& visit) {
    const int left = t.x0 / kTile, right = (t.x1 - 1) / kTile, top = t.y0 / kTile,
              bottom = (t.y1 - 1) / kTile;
    const bool one = left == right && top == bottom;
    const TriangleEdges edges(t);
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x)
        if (one || !edges.beside({x * kTile, y * kTile, (x + 1) * kTile, (y + 1) * kTile}))
          visit(std::size_t(y) * std::size_t(across) + std::size_t(x));
  };
  first.assign(std::size_t(across) * std::size_t(down) + 2, 0);
  for (const BlendedTriangle& t : triangles)
    each_tile(t, [&](std::size_t tile) { ++first[tile + 2]; });
  for (std::size_t t = 2; t < first.size(); ++t) first[t] += first[t - 1];
  listed.resize(first.back());
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    each_tile(triangles[i], [&](std::size_t tile) { listed[first[tile + 1]++] = i; });
}

// Adds a triangle's samples; false, and adds none, if one of them is taken.
bool BlendedTiles::State::add(FrameTile& tile, const BlendedTriangle& t, Gathered& into) const {
  const TriangleEdges edges(t);
  into.covers.clear();
  const int left = std::max(t.x0 - tile.x, 0) / kBlockSide,
            right = (std::min(t.x1 - tile.x, kTile) - 1) / kBlockSide,
            top = std::max(t.y0 - tile.y, 0) / kBlockSide,
            bottom = (std::min(t.y1 - tile.y, kTile) - 1) / kBlockSide;
  for (int by = top; by <= bottom; ++by)
    for (int bx = left; bx <= right; ++bx) {
      const int x = tile.x + bx * kBlockSide, y = tile.y + by * kBlockSide;
      const PixelRange rect{std::max(t.x0, x), std::max(t.y0, y), std::min(t.x1, x + kBlockSide),
                            std::min(t.y1, y + kBlockSide)};
      if (nearest_in(t, rect) > into.farthest[by * FrameTile::kBlocks + bx] &&
          !edges.beside(rect) && !add_in(tile, t, edges, rect, into))
        return false;
    }
  for (const Gathered::Cover& cover : into.covers) {
    std::uint8_t& taken = into.taken_at(tile, cover.x, cover.y);
    taken = std::uint8_t(taken | cover.samples);
    into.seen.add(placed,
                  {t.number, cover.x, std::uint16_t(tile.height - 1 - cover.y), cover.samples});
  }
  return true;
}

// Finds the triangle's samples in a part of a block; false if one of them is taken.
bool BlendedTiles::State::add_in(FrameTile& tile, const BlendedTriangle& t,
                                 const TriangleEdges& edges, const PixelRange& rect,
                                 Gathered& into) const {
  const int samples = tile.samples;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) {
      const unsigned mask = edges.samples_in(x, y, samples);
      if (mask == 0) continue;
      const TilePixel at(tile, x, y);
      const bool expanded = tile.expanded[at.block];
      const bool apart = samples == 4 && (expanded || mask != 15u);
      unsigned nearer = 0;
      for (int s = 0; s < samples; ++s) {
        if (!(mask >> s & 1)) continue;
        // Where a block has one sample a pixel, that stands for all.
        const int of = apart ? s : 0;
        const float sx = samples == 1 ? 0.5f : FrameTile::kSampleX[of],
                    sy = samples == 1 ? 0.5f : FrameTile::kSampleY[of];
        const float inverse_z = float(t.inverse_z + (double(x) + double(sx)) * t.per_x +
                                      (double(y) + double(sy)) * t.per_y);
        if (inverse_z > tile.plane(at.block, expanded ? s : 0).inverse_z[at.pixel])
          nearer |= 1u << s;
      }
      if (nearer == 0) continue;
      if (apart) tile.expand(at.block);
      if (into.taken_at(tile, x, y) & nearer) return false;
      into.covers.push_back({std::uint16_t(x), std::uint16_t(y), std::uint8_t(nearer)});
    }
  return true;
}

// Shades and blends what was gathered, and empties it.
void BlendedTiles::State::flush(FrameTile& tile, Gathered& from) const {
  from.seen.shade(*shaded, [&](const SeenTriangles::Shaded& part) {
    std::uint32_t bytes[Surfaces::kMaxCount];
    premultiplied_bytes(part.surfaces, part.colors, bytes);
    for (std::size_t i = 0; i < part.pixels.size(); ++i) {
      const SeenTriangles::Pixel& pixel = part.pixels[i];
      const int y = tile.height - 1 - pixel.y;
      const TilePixel at(tile, pixel.x, y);
      at.for_samples(tile, pixel.samples, [&](FrameTile::Plane& plane) {
        plane.content[at.pixel] = blend(plane.content[at.pixel], bytes[i]);
      });
      from.taken_at(tile, pixel.x, y) = 0;
    }
  });
}

BlendedTiles::BlendedTiles(const Scene& scene) : state_(new State(scene)) {}
BlendedTiles::~BlendedTiles() = default;

bool BlendedTiles::any() const { return !state_->triangles.empty(); }

void BlendedTiles::place(const Camera& camera, int samples, const PlacedScene& placed,
                         std::span<const std::uint32_t> objects) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  RILIEVO_EXPECTS(samples == 1 || samples == 4);
  State& s = *state_;
  s.triangles.clear();
  if (objects.empty()) return;
  if (!s.materials) s.materials.emplace(s.scene, TexturedMaterials::blended);
  s.place_all(camera, samples, placed, objects);
  s.list_tiles();
}

void BlendedTiles::draw_tile(FrameTile& tile) const {
  const State& s = *state_;
  if (!any() || tile.of != TileContent::color) return;
  const std::size_t t =
      std::size_t(tile.y / kTile) * std::size_t(s.across) + std::size_t(tile.x / kTile);
  if (s.first[t] == s.first[t + 1]) return;
  Gathered& local = s.threads.local();
  // Nothing that blends writes a depth.
  local.find_farthest(tile);
  for (std::uint32_t i = s.first[t]; i < s.first[t + 1]; ++i) {
    const BlendedTriangle& triangle = s.triangles[s.listed[i]];
    if (s.add(tile, triangle, local)) continue;
    s.flush(tile, local);
    [[maybe_unused]] const bool added = s.add(tile, triangle, local);
    RILIEVO_EXPECTS(added);
  }
  s.flush(tile, local);
}

}  // namespace rilievo
