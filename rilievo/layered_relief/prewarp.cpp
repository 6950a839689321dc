// Cf. [Parilov, Stuerzlinger 2002, sections 3.1, 4.1 and 5]. How we differ: sources may be in
// perspective; the result's grid stands still on the source plane, so that tiles can be kept from
// eye to eye; depths come along; the size of a splat is du / (1 + k3 d) (the printed formula adds a
// displacement to a size).
#include "rilievo/layered_relief/prewarp.h"

#include <tbb/enumerable_thread_specific.h>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_relief/fill_pinholes.h"
#include "rilievo/layered_relief/prewarp_grid.h"
#include "rilievo/layered_relief/prewarp_runs.h"

namespace rilievo {
namespace {

// Texels between the rows of a tile beyond its width: rows then do not share their places in the
// processor's cache.
constexpr int kPitchPadding = 8;

// A tile of the last result that is kept.
struct KeptTile {
  bool warped = false;
  ReliefWarp by;
  RunRange range;  // of what `by` puts into it and its neighbours
  std::vector<ReliefSample> texels;
};

// A tile and its neighbours: what lies in it after the eye moved may have come from beside it.
Texels with_neighbors(const TileGrid& grid, const glm::ivec2& tile) {
  return {grid.texels_of(tile - 1).min, grid.texels_of(tile + 1).max};
}

// How far, in source texels, samples with codes of `range` that `before` put into [min, max] lie
// from where `now` puts them. One with displacement d at q would go to
//   q + d (q (k3 - k3') + k1' - k1) / (1 + k3' d)
// which is affine in q and, as its factor, monotone in d.
double moved_by(const LayeredRelief& relief, const RunRange& range, const ReliefWarp& before,
                const ReliefWarp& now, const glm::dvec2& min, const glm::dvec2& max) {
  if (range.nearest > range.farthest) return 0;
  double most = 0;
  for (const std::uint32_t code : {range.nearest, range.farthest}) {
    const double d = relief.d(code), factor = std::abs(d / (1 + now.k3 * d));
    for (const double x : {min.x, max.x})
      most = std::max(most, factor * std::abs(x * (before.k3 - now.k3) + now.k1 - before.k1));
    for (const double y : {min.y, max.y})
      most = std::max(most, factor * std::abs(y * (before.k3 - now.k3) + now.k2 - before.k2));
  }
  return most;
}

// Is the quad of world points outside one of the frustum's planes?
bool outside(const glm::dmat4& clip_from_world, const std::array<glm::dvec3, 4>& quad) {
  unsigned all = ~0u;
  for (const glm::dvec3& corner : quad) {
    const glm::dvec4 c = clip_from_world * glm::dvec4(corner, 1);
    unsigned out = 0;
    for (int k = 0; k < 2; ++k)
      out |= unsigned(c[k] < -c.w) << (2 * k) | unsigned(c[k] > c.w) << (2 * k + 1);
    all &= out | unsigned(c.w <= 0) << 4;
  }
  return all != 0;
}

// Of what is no nearer than `least_d`: the hull is one of boxes along d, which end there.
ReliefRectangle rectangle_beyond(const LayeredRelief& relief, const ReliefWarp& warp,
                                 double splat_size, double least_d) {
  ReliefRectangle rectangle{glm::dvec2(1e300), glm::dvec2(-1e300)};
  const double beyond = std::max(0.0, 0.5 * (splat_size - 1));
  for (const glm::dvec3& corner : relief.hull) {
    const double d = std::max(corner.z, least_d);
    const glm::dvec2 at = warp.moved(corner.x, corner.y, d);
    const glm::dvec2 reach(beyond * warp.magnification(d));
    rectangle.min = glm::min(rectangle.min, at - reach);
    rectangle.max = glm::max(rectangle.max, at + reach);
  }
  return rectangle;
}

}  // namespace

std::optional<ReliefRectangle> relief_rectangle(const LayeredRelief& relief, const ReliefWarp& warp,
                                                double splat_size) {
  const double least = warp.least_d(kMaxPrewarpMagnification);
  for (const glm::dvec3& corner : relief.hull)
    if (!(corner.z >= least)) return std::nullopt;
  return rectangle_beyond(relief, warp, splat_size, least);
}

struct Prewarp::State {
  const LayeredRelief* relief;
  PrewarpOptions options;
  ReliefFrame frame;
  // Of the last result.
  Texels kept_tiles;  // in tiles
  double kept_resolution = 0;
  std::vector<KeptTile> kept;
  struct Scratch {
    std::vector<ReliefSample> texels;
    std::vector<PrewarpRun> runs;
  };
  tbb::enumerable_thread_specific<Scratch> scratch;
  std::vector<std::uint16_t> before_filling;

  struct Job {
    glm::ivec2 tile;
    double error = 0;  // infinite if never warped
    bool warp = true;
  };
  // What one warp() needs to know everywhere.
  struct Frame {
    ReliefWarp warp;
    double resolution = 1;
    Texels all, shown;  // of the result, before and after clipping to the view
    TileGrid grid;
    std::vector<Sheet> sheets;
    glm::dvec3 eye{0.0};
    std::uint32_t least_code = 0;  // nearer samples are not drawn
    PrewarpCoefficients coefficients;
    ResolveCoefficients resolve;
  };

  [[nodiscard]] bool in_view(const Frame& f, const glm::dmat4& clip, const Texels& texels) const;
  void plan_tiles(Frame& f, const Camera* view, bool keeps, std::vector<Job>& jobs) const;
  void set_coefficients(Frame& f) const;
  void set_geometry(const Frame& f, PictureGeometry& geometry) const;
  void set_resolve(Frame& f, const Camera& camera) const;
  void keep_tiles(const Frame& f, std::vector<Job>& jobs);
  void do_tile(const Frame& f, const Job& job, Prewarped& result, PrewarpStats& stats);
  [[nodiscard]] KeptTile* kept_tile(const glm::ivec2& tile) {
    const glm::ivec2 at = tile - kept_tiles.min, size = kept_tiles.size();
    if (at.x < 0 || at.y < 0 || at.x >= size.x || at.y >= size.y) return nullptr;
    return &kept[std::size_t(at.y) * std::size_t(size.x) + std::size_t(at.x)];
  }
};

Prewarp::Prewarp(const LayeredRelief& relief, const PrewarpOptions& options)
    : state_(std::make_unique<State>()) {
  RILIEVO_EXPECTS(options.tile_size >= 16 && options.max_size >= 16);
  RILIEVO_EXPECTS(options.resolution > 0 && options.splat_size > 0);
  state_->relief = &relief;
  state_->options = options;
  state_->frame = relief.frame();
}
Prewarp::~Prewarp() = default;
Prewarp::Prewarp(Prewarp&&) noexcept = default;
Prewarp& Prewarp::operator=(Prewarp&&) noexcept = default;

void Prewarp::reset() {
  state_->kept.clear();
  state_->kept_tiles = {};
}

bool Prewarp::State::in_view(const Frame& f, const glm::dmat4& clip, const Texels& texels) const {
  std::array<glm::dvec3, 4> quad;
  for (int i = 0; i < 4; ++i)
    quad[std::size_t(i)] =
        f.eye + frame.ray(f.eye, (i & 1 ? texels.max.x : texels.min.x) / f.resolution,
                          (i & 2 ? texels.max.y : texels.min.y) / f.resolution);
  return !outside(clip, quad);
}

// The tiles in view, and the rectangle around them. Where no tile is kept, what is shown need not
// begin and end where tiles do: it is found in smaller steps.
void Prewarp::State::plan_tiles(Frame& f, const Camera* view, bool keeps,
                                std::vector<Job>& jobs) const {
  constexpr int kViewStep = 64;
  f.grid = {glm::ivec2(0), glm::ivec2(keeps ? options.tile_size : kViewStep)};
  if (!keeps && !view) f.grid = strips(f.all, options.tile_size);
  const glm::dmat4 clip = view ? clip_from_world(*view) : glm::dmat4(1.0);
  f.shown = {f.all.max, f.all.min};
  const auto add_tiles = [&](const Texels& tiles, bool all) {
    for (int y = tiles.min.y; y < tiles.max.y; ++y)
      for (int x = tiles.min.x; x < tiles.max.x; ++x) {
        const Texels part = overlap(f.grid.texels_of({x, y}), f.all);
        if (!all && !in_view(f, clip, part)) continue;
        jobs.push_back({{x, y}, 0, true});
        f.shown = {glm::min(f.shown.min, part.min), glm::max(f.shown.max, part.max)};
      }
  };
  add_tiles(f.grid.tiles_of(f.all), !view);
  if (keeps || !view || jobs.empty()) return;
  const Texels seen = f.shown;
  jobs.clear();
  f.grid = strips(seen, options.tile_size);
  add_tiles(f.grid.tiles_of(seen), true);
  f.shown = seen;
}

void Prewarp::State::set_coefficients(Frame& f) const {
  const bool nearest = options.splat == Splat::nearest;
  const auto& [k1, k2, k3] = f.warp;
  const double s = f.resolution, d0 = relief->first_d, step = relief->d_step;
  // A splat covers the texels whose centres it contains: those from round(left) to below
  // round(right). A centre lies in texel round(position - 0.5).
  const glm::dvec2 shift = (nearest ? -0.5 : 0.0) - glm::dvec2(f.all.min);
  const double centre = nearest ? 0.5 * s : 0.0;
  f.coefficients.scale = float(s);
  f.coefficients.x_code = float(s * k1 * step + shift.x * k3 * step);
  f.coefficients.y_code = float(s * k2 * step + shift.y * k3 * step);
  f.coefficients.x_0 = float(s * k1 * d0 + shift.x * (1 + k3 * d0) + centre);
  f.coefficients.y_0 = float(s * k2 * d0 + shift.y * (1 + k3 * d0) + centre);
  f.coefficients.w_code = float(k3 * step);
  f.coefficients.w_0 = float(1 + k3 * d0);
  f.coefficients.low = float(0.5 - 0.5 * options.splat_size);
  f.coefficients.high = float(0.5 + 0.5 * options.splat_size);
  f.coefficients.least_code = float(f.least_code);
}

// The camera of the result: at the eye, in the source's direction.
void Prewarp::State::set_geometry(const Frame& f, PictureGeometry& geometry) const {
  const double s = f.resolution;
  Camera& camera = geometry.capture;
  camera = relief->camera;
  camera.projection = Projection::perspective;
  camera.world_from_eye[3] = glm::dvec4(f.eye, 1);
  const glm::dvec3 right(camera.world_from_eye[0]), up(camera.world_from_eye[1]);
  const auto window = [&](int x, int y) {
    const glm::dvec3 ray = frame.ray(f.eye, x / s, y / s);
    return glm::dvec2(glm::dot(ray, right), glm::dot(ray, up)) / glm::dot(ray, camera.forward());
  };
  const glm::dvec2 upper_left = window(f.shown.min.x, f.shown.min.y);
  const glm::dvec2 lower_right = window(f.shown.max.x, f.shown.max.y);
  camera.window = {upper_left.x, lower_right.x, lower_right.y, upper_left.y};
  camera.width = f.shown.size().x;
  camera.height = f.shown.size().y;
  // No sample on a plane of the frustum.
  const double near = relief->d(f.least_code), far = relief->farthest_d();
  if (relief->perspective()) {
    const auto eye_z = [&](double d) { return -(1 + f.warp.k3 * d) / d; };
    camera.z_near = (1 - 1e-5) * eye_z(near);
    camera.z_far = (1 + 1e-5) * eye_z(far);
    geometry.plane_z = best_plane({camera.z_near, camera.z_far});
  } else {
    geometry.plane_z = 1 / f.warp.k3;
    camera.z_near = geometry.plane_z + near - relief->d_step;
    camera.z_far = geometry.plane_z + far + relief->d_step;
  }
  geometry.slab = {camera.z_near, camera.z_far};
  geometry.delta_bits = 16;
}

// A Delta is steps (z - z_near) / z, with d = z - h, h being the eye's height over the plane, or of
// a perspective relief, of which z = -(1 + k3 d) / d,
//
//   steps (1 + (k3 + z_near) d) / (1 + k3 d)
void Prewarp::State::set_resolve(Frame& f, const Camera& camera) const {
  const double steps = double(delta_steps(16)) * camera.z_far / (camera.z_far - camera.z_near);
  const double k3 = f.warp.k3, near = camera.z_near, d0 = relief->first_d, step = relief->d_step;
  if (relief->perspective())
    f.resolve = {float(steps * (k3 + near) * step), float(steps * (1 + (k3 + near) * d0)),
                 float(k3 * step), float(1 + k3 * d0)};
  else
    f.resolve = {float(steps * step), float(steps * (1 / k3 + d0 - near)), float(step),
                 float(1 / k3 + d0)};
}

// The new grid of tiles, with what can be kept of the old one; how wrong each has become.
void Prewarp::State::keep_tiles(const Frame& f, std::vector<Job>& jobs) {
  const Texels tiles = f.grid.tiles_of(f.all);
  const glm::ivec2 count = tiles.size();
  std::vector<KeptTile> next(std::size_t(count.x) * std::size_t(count.y));
  if (f.resolution == kept_resolution)
    for (int y = 0; y < count.y; ++y)
      for (int x = 0; x < count.x; ++x)
        if (KeptTile* old = kept_tile(tiles.min + glm::ivec2(x, y)))
          next[std::size_t(y) * std::size_t(count.x) + std::size_t(x)] = std::move(*old);
  kept = std::move(next);
  kept_tiles = tiles;
  kept_resolution = f.resolution;

  const RunRange all{relief->tree[0].nearest, relief->tree[0].farthest};
  for (Job& job : jobs) {
    const KeptTile& tile = *kept_tile(job.tile);
    if (!tile.warped) {
      job.error = std::numeric_limits<double>::infinity();
      continue;
    }
    const auto moved = [&](const RunRange& range, const ReliefWarp& before, const ReliefWarp& now,
                           const Texels& in) {
      return f.resolution * moved_by(*relief, range, before, now, glm::dvec2(in.min) / f.resolution,
                                     glm::dvec2(in.max) / f.resolution);
    };
    job.error = moved(tile.range, tile.by, f.warp, with_neighbors(f.grid, job.tile));
    // What would lie in the tile now and has come from beyond its neighbours is not in its range.
    const double farthest = moved(all, f.warp, tile.by, f.grid.texels_of(job.tile));
    if (farthest > f.grid.size.x) job.error = std::max(job.error, farthest);
    job.warp = job.error > options.reuse_error;
  }
  std::stable_sort(jobs.begin(), jobs.end(),
                   [](const Job& a, const Job& b) { return a.error > b.error; });
}

// Warps the job's tile unless it stays, and puts it into the result.
void Prewarp::State::do_tile(const Frame& f, const Job& job, Prewarped& result,
                             PrewarpStats& stats) {
  Scratch& own = scratch.local();
  KeptTile* keep = kept_tile(job.tile);
  std::vector<ReliefSample>& texels = keep ? keep->texels : own.texels;
  // One more row than texels, for what misses.
  constexpr ReliefSample kNothing{0xffffffff, 0xffffffff};
  const int pitch = f.grid.size.x + kPitchPadding, missed = f.grid.size.y * pitch;
  if (texels.size() <= std::size_t(missed)) texels.resize(std::size_t(missed) + 1, kNothing);
  // A tile that is not kept is no larger than what is shown of it.
  const Texels whole = f.grid.texels_of(job.tile), shown = overlap(whole, f.shown);
  const Texels part = keep ? whole : shown;
  const glm::ivec2 at = part.min - f.all.min;
  const PrewarpTile tile{texels.data(), missed, at.x, at.y, part.size().x, part.size().y, pitch};
  if (job.warp) {
    RunQuery query;
    const auto set_rectangle = [&](const Texels& of) {
      query.min = glm::dvec2(of.min) / f.resolution, query.max = glm::dvec2(of.max) / f.resolution;
    };
    query.half_splat = 0.5 * options.splat_size;
    query.resolution = f.resolution;
    query.nearest = options.splat == Splat::nearest;
    query.least_code = f.least_code;
    if (keep) {
      own.runs.clear();
      set_rectangle(with_neighbors(f.grid, job.tile));
      keep->range = find_runs(*relief, f.warp, f.sheets, query, own.runs);
      keep->warped = true, keep->by = f.warp;
    }
    own.runs.clear();
    set_rectangle(part);
    find_runs(*relief, f.warp, f.sheets, query, own.runs);
    // A tile that is not kept was emptied when it was copied out.
    if (keep) std::fill(texels.begin(), texels.end(), kNothing);
    stats.samples_drawn += prewarp_tile(f.coefficients, own.runs, tile);
    for (const PrewarpRun& run : own.runs) stats.samples_warped += run.count;
    ++stats.warped;
  } else {
    stats.largest_reuse_error = std::max(stats.largest_reuse_error, job.error);
  }
  const glm::ivec2 from = shown.min - part.min, to = shown.min - f.shown.min;
  const std::size_t pitch_out = std::size_t(f.shown.size().x);
  const std::size_t first = std::size_t(to.y) * pitch_out + std::size_t(to.x);
  resolve_tile(f.resolve, tile, from.x, from.y, shown.size().x, shown.size().y, !keep,
               reinterpret_cast<std::uint32_t*>(result.color.data()) + first,
               result.delta.data() + first, pitch_out);
  if (!keep) texels[std::size_t(missed)] = kNothing;
}

std::optional<PrewarpStats> Prewarp::warp(const glm::dvec3& eye, const Camera* view,
                                          Prewarped& result,
                                          const std::function<bool()>& out_of_time) {
  State& s = *state_;
  const PrewarpOptions& options = s.options;
  State::Frame f;
  const auto warp = relief_warp(s.frame, eye);
  if (!warp) return std::nullopt;
  f.warp = *warp;
  const double splat = options.splat == Splat::nearest ? 0.0 : options.splat_size;
  f.eye = eye;
  // Rounded up, so that no code that is drawn is before it.
  const double least_d = f.warp.least_d(kMaxPrewarpMagnification);
  f.least_code = std::uint32_t(std::clamp(
      std::ceil((least_d - s.relief->first_d) / s.relief->d_step), 0.0, double(kEmptyCode)));
  if (f.least_code > s.relief->tree[0].farthest) return std::nullopt;
  const ReliefRectangle rectangle =
      rectangle_beyond(*s.relief, f.warp, splat, s.relief->d(f.least_code));
  const glm::dvec2 extent = rectangle.max - rectangle.min;
  f.resolution = options.resolution;
  // Two texels are lost to rounding.
  while (std::max(extent.x, extent.y) * f.resolution > options.max_size - 2) f.resolution *= 0.5;
  f.all = {glm::ivec2(glm::floor(rectangle.min * f.resolution)),
           glm::ivec2(glm::ceil(rectangle.max * f.resolution))};
  f.all.max = glm::max(f.all.max, f.all.min + 1);

  const bool keeps = options.reuse_error > 0 || out_of_time;
  std::vector<State::Job> jobs;
  s.plan_tiles(f, view, keeps, jobs);
  PrewarpStats stats;
  stats.resolution = f.resolution;
  stats.tiles = int(jobs.size());
  if (jobs.empty()) {
    result.color.clear();
    result.delta.clear();
    return stats;
  }

  s.set_coefficients(f);
  s.set_geometry(f, result.geometry);
  const Camera& camera = result.geometry.capture;
  s.set_resolve(f, camera);
  f.sheets = sheets_of(*s.relief, f.warp);
  const std::size_t texels = std::size_t(camera.width) * std::size_t(camera.height);
  result.color.resize(texels);
  result.delta.resize(texels);
  // Between tiles in view there may be some that are not, and are not written.
  const glm::ivec2 around = f.grid.tiles_of(f.shown).size();
  if (int(jobs.size()) < around.x * around.y) {
    std::fill(result.color.begin(), result.color.end(), glm::u8vec4(0));
    std::fill(result.delta.begin(), result.delta.end(), std::uint16_t(kEmptyCode));
  }
  if (keeps)
    s.keep_tiles(f, jobs);
  else
    reset();

  tbb::enumerable_thread_specific<PrewarpStats> sums;
  parallel_for(std::size_t(0), jobs.size(), [&](std::size_t i) {
    State::Job job = jobs[i];
    const bool new_one = !(job.error < std::numeric_limits<double>::infinity());
    if (job.warp && !new_one && out_of_time && out_of_time()) job.warp = false;
    s.do_tile(f, job, result, sums.local());
  });
  for (const PrewarpStats& sum : sums) {
    stats.warped += sum.warped;
    stats.samples_warped += sum.samples_warped;
    stats.samples_drawn += sum.samples_drawn;
    stats.largest_reuse_error = std::max(stats.largest_reuse_error, sum.largest_reuse_error);
  }
  if (options.fill_pinholes) fill_pinholes(result, s.before_filling);
  return stats;
}

}  // namespace rilievo
