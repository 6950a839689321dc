// Corners are rounded to 1/256 of a pixel, as OpenGL does: edge functions are then whole numbers,
// and of two triangles that share an edge exactly one covers a sample on it.
//
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
#include "rilievo/render/raster/clip_polygon.h"
#include "rilievo/render/raster/near_clip.h"
#include "rilievo/render/raster/raster_instances.h"
#include "rilievo/render/shading/picture_shader.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {
namespace {

constexpr int kUnit = 256;  // of a pixel
constexpr int kTile = FrameTile::kSize;

// Triangles are cut where they reach farther to the sides, in pixels. Coordinates are then below
// 2^28 kUnit, the largest frame's height of 2^22 included, and differences below 2^29. An area is
// the difference of two products of differences, an edge function at a sample the sum of two
// products of a difference and a coordinate: below 2^59, and 64 bits hold up to 2^63.
constexpr double kReach = 1e6;

// In the frame; y points down.
struct BlendedTriangle {
  std::int64_t x[3], y[3];         // kUnit a pixel, counter-clockwise where y points up
  double inverse_z, per_x, per_y;  // at the frame's upper left corner; of a pixel
  std::uint32_t number;            // as in PlacedMesh
  int x0, y0, x1, y1;              // pixels that it can cover: x0 <= x < x1
};

// > 0 left of the edge; 0 on it, if it is the triangle's.
struct Edge {
  std::int64_t at, per_x, per_y;

  Edge(const BlendedTriangle& t, int k) {
    const int a = k, b = (k + 1) % 3;
    const std::int64_t dx = t.x[b] - t.x[a], dy = t.y[b] - t.y[a];
    const bool own = dy > 0 || (dy == 0 && dx > 0);
    per_x = dy, per_y = -dx;
    at = -dy * t.x[a] + dx * t.y[a] + (own ? 1 : 0);
  }
  [[nodiscard]] std::int64_t operator()(std::int64_t x, std::int64_t y) const {
    return at + per_x * x + per_y * y;
  }
};

std::uint32_t blend(std::uint32_t under, std::uint32_t over) {
  const std::uint32_t through = 255 - (over >> 24);
  std::uint32_t out = 0;
  for (int shift = 0; shift < 32; shift += 8) {
    const std::uint32_t below = (under >> shift & 0xffu) * through;
    out |= std::min(255u, (over >> shift & 0xffu) + (below + 127) / 255) << shift;
  }
  return out;
}

// To the nearest, without a call.
std::int64_t rounded(double v) { return std::int64_t(v < 0 ? v - 0.5 : v + 0.5); }

// Of pixel (x, y), kUnit a pixel.
glm::i64vec2 sample_at(int x, int y, int s, int samples) {
  const float sx = samples == 1 ? 0.5f : FrameTile::kSampleX[s],
              sy = samples == 1 ? 0.5f : FrameTile::kSampleY[s];
  return {std::int64_t(float(kUnit) * sx) + std::int64_t(x) * kUnit,
          std::int64_t(float(kUnit) * sy) + std::int64_t(y) * kUnit};
}

// Does it cover a sample? Only small ones are looked at: most of what is far away covers none.
bool may_cover(const BlendedTriangle& t, int samples) {
  if (t.x1 - t.x0 > 2 || t.y1 - t.y0 > 2) return true;
  const Edge edges[] = {{t, 0}, {t, 1}, {t, 2}};
  for (int y = t.y0; y < t.y1; ++y)
    for (int x = t.x0; x < t.x1; ++x)
      for (int s = 0; s < samples; ++s) {
        const glm::i64vec2 p = sample_at(x, y, s, samples);
        if (edges[0](p.x, p.y) > 0 && edges[1](p.x, p.y) > 0 && edges[2](p.x, p.y) > 0) return true;
      }
  return false;
}

// One triangle, if it can be seen in the frame. Corners as in place_pieces().
std::optional<BlendedTriangle> place_triangle(const Camera& camera, int samples,
                                              const RasterInstance& in, std::uint32_t number,
                                              const glm::dvec3 (&corner)[3]) {
  BlendedTriangle t;
  double per_w[3];
  for (int k = 0; k < 3; ++k) {
    per_w[k] = 1 / corner[k].z;
    const double x = corner[k].x / corner[k].z, y = corner[k].y / corner[k].z;
    // What was cut lies at kReach but for rounding: this is no number.
    if (!(std::abs(x) < 1.001 * kReach && std::abs(y) < 1.001 * kReach)) return std::nullopt;
    t.x[k] = rounded(x * kUnit), t.y[k] = rounded((camera.height - y) * kUnit);
  }
  std::int64_t area = (t.x[1] - t.x[0]) * (t.y[2] - t.y[0]) - (t.x[2] - t.x[0]) * (t.y[1] - t.y[0]);
  if (area == 0 || !(area < 0 ? in.front : in.back)) return std::nullopt;
  if (area > 0) {
    std::swap(t.x[1], t.x[2]), std::swap(t.y[1], t.y[2]), std::swap(per_w[1], per_w[2]);
    area = -area;
  }
  const auto pixels = [](std::int64_t a, std::int64_t b, std::int64_t c, int limit, int& from,
                         int& to) {
    const auto clamped = [&](std::int64_t v) { return int(std::clamp<std::int64_t>(v, 0, limit)); };
    from = clamped(std::min({a, b, c}) / kUnit);
    to = clamped(std::max({a, b, c}) / kUnit + 1);
  };
  pixels(t.x[0], t.x[1], t.x[2], camera.width, t.x0, t.x1);
  pixels(t.y[0], t.y[1], t.y[2], camera.height, t.y0, t.y1);
  if (t.x0 >= t.x1 || t.y0 >= t.y1 || !may_cover(t, samples)) return std::nullopt;
  // 1 / eye_z is affine.
  const double x1 = double(t.x[1] - t.x[0]) / kUnit, y1 = double(t.y[1] - t.y[0]) / kUnit,
               x2 = double(t.x[2] - t.x[0]) / kUnit, y2 = double(t.y[2] - t.y[0]) / kUnit;
  const double det = x1 * y2 - x2 * y1, d1 = per_w[1] - per_w[0], d2 = per_w[2] - per_w[0];
  t.per_x = (d1 * y2 - d2 * y1) / det, t.per_y = (d2 * x1 - d1 * x2) / det;
  t.inverse_z = per_w[0] - (double(t.x[0]) * t.per_x + double(t.y[0]) * t.per_y) / kUnit;
  t.number = number;
  return t;
}

// Cuts a polygon at kReach on all four sides.
void cut_to_reach(std::vector<glm::dvec3>& polygon) {
  static thread_local std::vector<glm::dvec3> scratch;  // kept, so that drawing does not allocate
  for (int side = 0; side < 4; ++side)
    clip_polygon(
        polygon, scratch,
        [&](const glm::dvec3& p) { return kReach * p.z + (side % 2 ? 1 : -1) * p[side / 2]; },
        [](const glm::dvec3& in, const glm::dvec3& out, double share) {
          return glm::mix(in, out, share);
        });
}

// Appends one triangle, or the pieces of it within kReach, if they can be seen in the frame. A
// corner is x w, y w and w, in pixels; y points up.
void place_pieces(const Camera& camera, int samples, const RasterInstance& in, std::uint32_t number,
                  const std::uint32_t* indices, std::vector<BlendedTriangle>& placed) {
  glm::dvec3 corner[3];
  bool far = false;
  for (int k = 0; k < 3; ++k) {
    const glm::vec4 p(in.positions[indices[k]], 1);
    corner[k] = {glm::dot(in.row_x, p), glm::dot(in.row_y, p), glm::dot(in.row_w, p)};
    const double w = corner[k].z;
    if (!(w > double(in.min_w)) || w <= 0) return;
    far = far || !(std::abs(corner[k].x) < kReach * w && std::abs(corner[k].y) < kReach * w);
  }
  const auto place = [&](const glm::dvec3(&of)[3]) {
    if (const auto t = place_triangle(camera, samples, in, number, of)) placed.push_back(*t);
  };
  if (!far) return place(corner);
  static thread_local std::vector<glm::dvec3> polygon;
  polygon.assign(corner, corner + 3);
  cut_to_reach(polygon);
  for (std::size_t k = 2; k < polygon.size(); ++k) place({polygon[0], polygon[k - 1], polygon[k]});
}

// What of a tile waits to be shaded together. A thread's own; empty between tiles.
struct Gathered {
  SeenTriangles seen;
  std::uint8_t taken[kTile * kTile] = {};  // of each pixel, its samples that are taken
  // Of one triangle.
  struct Cover {
    std::uint16_t x, y;  // in the frame
    std::uint8_t samples;
  };
  std::vector<Cover> covers;  // kept, so that drawing does not allocate

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
      place_pieces(camera, samples, in, in.numbers ? in.numbers[k] : in.first_triangle + k,
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
    for (int y = t.y0 / kTile; y <= (t.y1 - 1) / kTile; ++y)
      for (int x = t.x0 / kTile; x <= (t.x1 - 1) / kTile; ++x)
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
  const Edge edges[] = {{t, 0}, {t, 1}, {t, 2}};
  const int samples = tile.samples;
  const int x0 = std::max(t.x0, tile.x), x1 = std::min(t.x1, tile.x + kTile);
  const int y0 = std::max(t.y0, tile.y), y1 = std::min(t.y1, tile.y + kTile);
  into.covers.clear();
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const TilePixel at(tile, x, y);
      unsigned mask = 0;
      for (int s = 0; s < samples; ++s) {
        const glm::i64vec2 p = sample_at(x, y, s, samples);
        if (edges[0](p.x, p.y) > 0 && edges[1](p.x, p.y) > 0 && edges[2](p.x, p.y) > 0)
          mask |= 1u << s;
      }
      if (mask == 0) continue;
      if (samples == 4 && mask != 15u) tile.expand(at.block);
      const bool apart = samples == 4 && tile.expanded[at.block];
      unsigned nearer = 0;
      for (int s = 0; s < samples; ++s) {
        if (!(mask >> s & 1)) continue;
        // Where a block has one sample a pixel, that stands for all.
        const int of = apart ? s : 0;
        const float sx = samples == 1 ? 0.5f : FrameTile::kSampleX[of],
                    sy = samples == 1 ? 0.5f : FrameTile::kSampleY[of];
        const float inverse_z = float(t.inverse_z + (double(x) + double(sx)) * t.per_x +
                                      (double(y) + double(sy)) * t.per_y);
        if (inverse_z > tile.plane(at.block, of).inverse_z[at.pixel]) nearer |= 1u << s;
      }
      if (nearer == 0) continue;
      if (into.taken_at(tile, x, y) & nearer) return false;
      into.covers.push_back({std::uint16_t(x), std::uint16_t(y), std::uint8_t(nearer)});
    }
  for (const Gathered::Cover& cover : into.covers) {
    std::uint8_t& taken = into.taken_at(tile, cover.x, cover.y);
    taken = std::uint8_t(taken | cover.samples);
    into.seen.add(placed,
                  {t.number, cover.x, std::uint16_t(tile.height - 1 - cover.y), cover.samples});
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
