// Cf. [Parilov, Stuerzlinger 2002, sections 3.1, 4.1 and 5]. How we differ: sources may be in
// perspective; no tile of the last result is kept (of turns by 1.2 degrees 1 to 3 % could be);
// depths come along; the size of a splat is du / (1 + k3 d) (the printed formula adds a
// displacement to a size).
#include "rilievo/layered_relief/prewarp.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>

#include "rilievo/core/on_this_thread.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_relief/fill_pinholes.h"
#include "rilievo/layered_relief/prewarp_grid.h"
#include "rilievo/layered_relief/prewarp_runs.h"
#include "rilievo/layered_relief/prewarp_strips.h"

namespace rilievo {
namespace {

// Texels between the rows of a tile beyond its width: rows then do not share their places in the
// processor's cache.
constexpr int kPitchPadding = 8;
// Where work is estimated.
constexpr std::size_t kWorkBorders = 65;

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
ReliefRectangle rectangle_beyond(const LayeredRelief& relief, const ReliefWarp& warp, double splat,
                                 double least_d) {
  ReliefRectangle rectangle{glm::dvec2(1e300), glm::dvec2(-1e300)};
  const double beyond = std::max(0.0, 0.5 * (splat - 1));
  for (const glm::dvec3& corner : relief.hull) {
    const double d = std::max(corner.z, least_d);
    const glm::dvec2 at = warp.moved(corner.x, corner.y, d);
    const glm::dvec2 reach(beyond * warp.magnification(d));
    rectangle.min = glm::min(rectangle.min, at - reach);
    rectangle.max = glm::max(rectangle.max, at + reach);
  }
  return rectangle;
}

// The steepest line of sight to the samples: the largest slope against the plane's axis.
double most_slope(const LayeredRelief& relief, const ReliefWarp& warp, const glm::dvec2& per_texel,
                  double least_d) {
  double most = 0;
  for (const glm::dvec3& corner : relief.hull) {
    const glm::dvec2 at = warp.moved(corner.x, corner.y, std::max(corner.z, least_d));
    most = std::max(most, glm::length((at - warp.epipole()) * per_texel));
  }
  return most;
}

}  // namespace

std::optional<ReliefRectangle> relief_rectangle(const LayeredRelief& relief, const ReliefWarp& warp,
                                                double splat_size) {
  const double least = warp.least_d(kMaxPrewarpMagnification);
  for (const glm::dvec3& corner : relief.hull)
    if (!(corner.z >= least)) return std::nullopt;
  return rectangle_beyond(relief, warp, relief.splat_scale * splat_size, least);
}

struct Prewarp::State {
  const LayeredRelief* relief;
  PrewarpOptions options;
  ReliefFrame frame;
  struct Scratch {
    std::vector<ReliefSample> texels;
    std::vector<PrewarpRun> runs;
  };
  tbb::enumerable_thread_specific<Scratch> scratch;
  PinholeScratch pinholes;
  std::vector<Texels> strips;
  std::vector<double> work;  // estimate_work()

  // What one warp() needs to know everywhere.
  struct Frame {
    ReliefWarp warp;
    double resolution = 1;
    Texels all, shown;  // of the result, before and after clipping to the view
    std::vector<Sheet> sheets;
    glm::dvec3 eye{0.0};
    glm::dvec2 slope_per_texel{0.0};  // RunQuery's
    double most_slope = 0;
    std::uint32_t least_code = 0;  // nearer samples are not drawn
    PrewarpCoefficients coefficients;
    ResolveCoefficients resolve;
  };

  [[nodiscard]] bool in_view(const Frame& f, const glm::dmat4& clip, const Texels& texels) const;
  void plan_strips(Frame& f, const Camera* view);
  void set_coefficients(Frame& f) const;
  void set_geometry(const Frame& f, PictureGeometry& geometry) const;
  void set_resolve(Frame& f, const Camera& camera) const;
  void do_strip(const Frame& f, const Texels& part, Prewarped& result, PrewarpStats& stats);
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

bool Prewarp::State::in_view(const Frame& f, const glm::dmat4& clip, const Texels& texels) const {
  std::array<glm::dvec3, 4> quad;
  for (int i = 0; i < 4; ++i)
    quad[std::size_t(i)] =
        f.eye + frame.ray(f.eye, (i & 1 ? texels.max.x : texels.min.x) / f.resolution,
                          (i & 2 ? texels.max.y : texels.min.y) / f.resolution);
  return !outside(clip, quad);
}

// The strips of what is in view. What is shown need not begin and end where tiles do: it is found
// in smaller steps.
void Prewarp::State::plan_strips(Frame& f, const Camera* view) {
  constexpr int kViewStep = 64;
  strips.clear();
  f.shown = f.all;
  if (view) {
    const TileGrid grid{glm::ivec2(0), glm::ivec2(kViewStep)};
    f.shown = {f.all.max, f.all.min};
    const glm::dmat4 clip = clip_from_world(*view);
    const Texels steps = grid.tiles_of(f.all);
    for (int y = steps.min.y; y < steps.max.y; ++y)
      for (int x = steps.min.x; x < steps.max.x; ++x) {
        const Texels part = overlap(grid.texels_of({x, y}), f.all);
        if (!in_view(f, clip, part)) continue;
        f.shown = {glm::min(f.shown.min, part.min), glm::max(f.shown.max, part.max)};
      }
    if (f.shown.empty()) return;
  }
  const int count = strip_count(f.shown.size(), options.tile_size, threads_of_calls());
  work.resize(kWorkBorders);
  if (count > 1) estimate_work(*relief, f.warp, f.resolution, f.least_code, f.shown, work);
  divide_work(f.shown, work, count, strips);
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

// Warps a strip, and puts it into the result.
void Prewarp::State::do_strip(const Frame& f, const Texels& part, Prewarped& result,
                              PrewarpStats& stats) {
  auto& [texels, runs] = scratch.local();
  if (texels.empty())
    texels.reserve(most_strip_texels(options.max_size, options.tile_size, kPitchPadding) + 1);
  // One more row than texels, for what misses.
  constexpr ReliefSample kNothing{0xffffffff, 0xffffffff};
  const glm::ivec2 first = part.min - f.all.min, size = part.size();
  const int pitch = size.x + kPitchPadding, missed = size.y * pitch;
  if (texels.size() <= std::size_t(missed)) texels.resize(std::size_t(missed) + 1, kNothing);
  const PrewarpTile tile{texels.data(), missed, first.x, first.y, size.x, size.y, pitch};
  RunQuery query;
  query.min = glm::dvec2(part.min) / f.resolution, query.max = glm::dvec2(part.max) / f.resolution;
  query.half_splat = 0.5 * options.splat_size * relief->splat_scale;
  query.slope_per_texel = f.slope_per_texel, query.most_slope = f.most_slope;
  query.resolution = f.resolution;
  query.nearest = options.splat == Splat::nearest;
  query.least_code = f.least_code;
  runs.clear();
  find_runs(*relief, f.warp, f.sheets, query, runs);
  stats.samples_drawn += prewarp_tile(f.coefficients, runs, tile);
  for (const PrewarpRun& run : runs) stats.samples_warped += run.count;
  const glm::ivec2 to = part.min - f.shown.min;
  const std::size_t pitch_out = std::size_t(f.shown.size().x);
  const std::size_t out = std::size_t(to.y) * pitch_out + std::size_t(to.x);
  // Empties the tile for the next one.
  resolve_tile(f.resolve, tile, reinterpret_cast<std::uint32_t*>(result.color.data()) + out,
               result.delta.data() + out, pitch_out);
  texels[std::size_t(missed)] = kNothing;
}

std::optional<PrewarpStats> Prewarp::warp(const glm::dvec3& eye, const Camera* view,
                                          Prewarped& result) {
  State& s = *state_;
  const PrewarpOptions& options = s.options;
  State::Frame f;
  const auto warp = relief_warp(s.frame, eye);
  if (!warp) return std::nullopt;
  f.warp = *warp;
  const bool nearest = options.splat == Splat::nearest;
  f.eye = eye;
  // Rounded up, so that no code that is drawn is before it.
  const double least_d = f.warp.least_d(kMaxPrewarpMagnification);
  f.least_code = std::uint32_t(std::clamp(
      std::ceil((least_d - s.relief->first_d) / s.relief->d_step), 0.0, double(kEmptyCode)));
  if (f.least_code > s.relief->tree[0].farthest) return std::nullopt;
  const double from_d = s.relief->d(f.least_code);
  if (options.splats_face_eye && !nearest && !s.relief->perspective()) {
    f.slope_per_texel = f.warp.k3 * glm::dvec2(glm::length(s.frame.a), glm::length(s.frame.b));
    f.most_slope = most_slope(*s.relief, f.warp, f.slope_per_texel, from_d);
  }
  const double splat =
      nearest ? 0.0 : s.relief->splat_scale * options.splat_size * splat_stretch(f.most_slope);
  const ReliefRectangle rectangle = rectangle_beyond(*s.relief, f.warp, splat, from_d);
  const glm::dvec2 extent = rectangle.max - rectangle.min;
  f.resolution = options.resolution;
  // Two texels are lost to rounding.
  while (std::max(extent.x, extent.y) * f.resolution > options.max_size - 2) f.resolution *= 0.5;
  f.all = {glm::ivec2(glm::floor(rectangle.min * f.resolution)),
           glm::ivec2(glm::ceil(rectangle.max * f.resolution))};
  f.all.max = glm::max(f.all.max, f.all.min + 1);

  s.plan_strips(f, view);
  PrewarpStats stats;
  stats.resolution = f.resolution;
  stats.tiles = int(s.strips.size());
  if (s.strips.empty()) {
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
  tbb::enumerable_thread_specific<PrewarpStats> sums;
  parallel_for(std::size_t(0), s.strips.size(),
               [&](std::size_t i) { s.do_strip(f, s.strips[i], result, sums.local()); });
  for (const PrewarpStats& sum : sums) {
    stats.samples_warped += sum.samples_warped;
    stats.samples_drawn += sum.samples_drawn;
  }
  if (options.fill_pinholes) {
    // Samples of other textures lie as far apart as their texels.
    const double scale = s.relief->splat_scale;
    fill_pinholes(result, s.relief->perspective() ? 0 : f.resolution * scale * scale, s.pinholes);
  }
  return stats;
}

}  // namespace rilievo
