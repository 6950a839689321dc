#include "rilievo/compare/drawn_error.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>

#include "rilievo/core/expects.h"
#include "rilievo/core/linear_maps.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/scene/position_colors.h"

namespace rilievo {
namespace {

constexpr int kLookedAt = 8;      // frames from which the half periods are chosen
constexpr int kMinPixels = 16;    // of an object that counts there
constexpr double kMeanCode = 26;  // pixels, about the geometric mean of finest and coarsest
// A step: neighbours whose depths differ by more than this many pixels' widths, a slope of 76
// degrees or a jump.
constexpr double kStep = 4;

// The width of a pixel at eye_z 1.
double pixel_at_one(const Camera& camera) {
  return (camera.window.right - camera.window.left) / camera.width;
}

double scale_of(const glm::dmat4& world_from_model) {
  return std::cbrt(std::abs(glm::determinant(glm::dmat3(world_from_model))));
}

// 1 where the pixel or a neighbour to the right or below lies across a step.
Image<std::uint8_t> steps_of(const IdImage& objects, const Image<float>& eye_z, double pixel) {
  const int w = objects.width(), h = objects.height();
  Image<std::uint8_t> steps(w, h);
  const auto mark = [&](int x, int y, int dx, int dy) {
    const float a = eye_z(x, y), b = eye_z(x + dx, y + dy);
    if (objects(x, y) == objects(x + dx, y + dy) &&
        double(std::abs(a - b)) <= kStep * pixel * double(std::min(a, b)))
      return;
    steps(x, y) = steps(x + dx, y + dy) = 1;
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      if (x + 1 < w) mark(x, y, 1, 0);
      if (y + 1 < h) mark(x, y, 0, 1);
    }
  return steps;
}

// 1 where `marks` has a 1 within `margin` pixels in x and y.
Image<std::uint8_t> within(const Image<std::uint8_t>& marks, int margin) {
  const int w = marks.width(), h = marks.height();
  Image<std::uint8_t> across(w, h), out(w, h);
  parallel_for(0, h, [&](int y) {
    for (int x = 0; x < w; ++x)
      for (int i = std::max(x - margin, 0); i <= std::min(x + margin, w - 1); ++i)
        across(x, y) |= marks(i, y);
  });
  parallel_for(0, h, [&](int y) {
    for (int x = 0; x < w; ++x)
      for (int j = std::max(y - margin, 0); j <= std::min(y + margin, h - 1); ++j)
        out(x, y) |= across(x, j);
  });
  return out;
}

// Do the pixel and its eight neighbours show one object?
bool is_inside(const IdImage& objects, int x, int y) {
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, objects.height() - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, objects.width() - 1); ++i)
      if (objects(i, j) != objects(x, y)) return false;
  return true;
}

// The inverse of an affine map; of one that flattens, the pseudo-inverse: from the nearest place of
// the sheet to what is nearest to the origin of all that is put there.
glm::dmat4 affine_inverse(const glm::dmat4& m) {
  const glm::dmat3 linear(m);
  if (is_invertible(linear)) return glm::inverse(m);
  glm::dmat3 gram = glm::transpose(linear) * linear;
  const double size = gram[0][0] + gram[1][1] + gram[2][2];
  if (!(size > 0)) return glm::dmat4(0.0);
  for (int k = 0; k < 3; ++k) gram[k][k] += 1e-12 * size;
  const glm::dmat3 back = glm::inverse(gram) * glm::transpose(linear);
  glm::dmat4 inverse(back);
  inverse[3] = glm::dvec4(-(back * glm::dvec3(m[3])), 1.0);
  return inverse;
}

// An object in a frame.
struct Placed {
  glm::dmat4 world_from_model{1.0}, model_from_world{1.0};
  double half_period = 0, half_period_world = 0;
};

std::vector<Placed> place_objects(const Scene& scene, std::span<const double> half_periods,
                                  double time) {
  std::vector<glm::mat4> poses;
  pose(scene, time, poses);
  std::vector<Placed> placed(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const glm::dmat4 world_from_model(poses[i]);
    const double half_period = half_periods[std::size_t(scene.objects[i].model)];
    placed[i] = {world_from_model, affine_inverse(world_from_model), half_period,
                 half_period * scale_of(world_from_model)};
  }
  return placed;
}

// Projects as raster_from_world(), quickly.
class Projector {
 public:
  explicit Projector(const Camera& camera)
      : eye_from_world_(eye_from_world(camera)),
        window_(camera.window),
        size_(camera.width, camera.height) {
    RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  }
  [[nodiscard]] glm::dmat4 eye_from_model(const Placed& object) const {
    return eye_from_world_ * object.world_from_model;
  }
  // Of a place before the eye.
  [[nodiscard]] glm::dvec2 raster(const glm::dvec3& eye) const {
    return size_ * glm::dvec2((eye.x / -eye.z - window_.left) / (window_.right - window_.left),
                              (window_.top - eye.y / -eye.z) / (window_.top - window_.bottom));
  }

 private:
  glm::dmat4 eye_from_world_;
  ImageWindow window_;
  glm::dvec2 size_;
};

// The least distance from the pixel to a place that its colour may mean.
double error_of(const Projector& projector, const Placed& object, const glm::dvec2& raster,
                const glm::u8vec4& color, std::initializer_list<glm::dvec3> guesses) {
  const glm::dmat4 eye_from_model = projector.eye_from_model(object);
  double least = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& world : guesses) {
    const glm::dvec3 guess(object.model_from_world * glm::dvec4(world, 1));
    for (int i = 0; i < kCodeCandidates; ++i) {
      const glm::dvec3 place = decode_position(color, guess, object.half_period, i);
      const glm::dvec3 eye(eye_from_model * glm::dvec4(place, 1));
      if (eye.z < 0) least = std::min(least, glm::distance(projector.raster(eye), raster));
    }
  }
  return least;
}

// What a row of pixels adds.
struct Row {
  std::vector<float> errors_px;
  double resolution_px = 0;
  std::uint64_t shown = 0, boundary = 0, mixed = 0, unresolved = 0, over_bound = 0, violations = 0,
                in_gaps = 0;
};

// 1 where a frame shows what lies behind the true surface: deeper by more than a surface without a
// step is within `off_px` pixels.
Image<std::uint8_t> shown_behind(const DrawnFrame& truth, const DrawnFrame& seen, double pixel,
                                 double off_px) {
  const int w = truth.objects.width(), h = truth.objects.height();
  Image<std::uint8_t> behind(w, h);
  const double deeper = 1 + kStep * off_px * pixel;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      behind(x, y) =
          truth.objects(x, y) != 0 && double(seen.eye_z(x, y)) > deeper * double(truth.eye_z(x, y));
  return behind;
}

// Is the pixel, or a neighbour that mixes with it, in a gap of at most `gap_px`?
bool is_in_gap(const Image<std::uint8_t>& behind, int x, int y, double gap_px) {
  const int w = behind.width(), h = behind.height();
  bool here = false;
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, h - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, w - 1); ++i) here |= behind(i, j) != 0;
  if (!here) return false;
  const double within = 0.5 * gap_px + kTexelError;
  const int most = int(within);
  for (int j = std::max(y - most, 0); j <= std::min(y + most, h - 1); ++j)
    for (int i = std::max(x - most, 0); i <= std::min(x + most, w - 1); ++i)
      if (behind(i, j) == 0 && std::hypot(i - x, j - y) <= within) return true;
  return false;
}

void add_to(DrawnErrors& errors, const Row& row) {
  for (const float px : row.errors_px) {
    errors.errors_px.add(px);
    errors.largest_px = std::max(errors.largest_px, double(px));
  }
  errors.resolution_px = std::max(errors.resolution_px, row.resolution_px);
  errors.shown += row.shown;
  errors.boundary += row.boundary;
  errors.mixed += row.mixed;
  errors.unresolved += row.unresolved;
  errors.over_bound += row.over_bound;
  errors.violations += row.violations;
  errors.in_gaps += row.in_gaps;
}

// Frames spread evenly, with the first and the last.
int spread(int i, int count, int frames) {
  return count == 1 ? 0 : int(std::int64_t(i) * (frames - 1) / (count - 1));
}

ErrorPx summary_of(const DrawnErrors& errors) {
  const double shown = double(std::max<std::uint64_t>(errors.shown, 1));
  const auto measured = errors.errors_px.count();
  ErrorPx out;
  out.p50 = errors.errors_px.percentile(0.50);
  out.p99 = errors.errors_px.percentile(0.99);
  out.max = errors.largest_px;
  out.resolution = errors.resolution_px;
  out.measured = double(measured) / shown;
  out.boundary = double(errors.boundary) / shown;
  out.mixed = double(errors.mixed) / shown;
  out.unresolved = double(errors.unresolved) / shown;
  if (measured > 0) out.over_bound = double(errors.over_bound) / double(measured);
  out.violations = std::int64_t(errors.violations);
  out.in_gaps = std::int64_t(errors.in_gaps);
  return out;
}

}  // namespace

Result<std::vector<double>> choose_half_periods(const Scene& scene, FrameSource& truth,
                                                const std::function<WalkFrame(int frame)>& walk,
                                                const CompareOptions& options) {
  FrameSource* const sources[] = {&truth};
  const Result<DrawTargets> own =
      DrawTargets::create(sources, options.width, options.height, options.samples);
  if (!own) return own.error();
  struct Mean {
    double sum = 0;
    int count = 0;
  };
  std::vector<Mean> models(scene.models.size()), objects;
  const int frames = std::min(options.frames, kLookedAt);
  for (int i = 0; i < frames; ++i) {
    const WalkFrame frame = walk(spread(i, frames, options.frames));
    Result<DrawnFrame> drawn = draw_frame(truth, *own, frame);
    if (!drawn) return drawn.error();
    objects.assign(scene.objects.size(), {});
    for (std::size_t p = 0; p < drawn->objects.texels().size(); ++p)
      if (const std::uint32_t id = drawn->objects.texels()[p]; id != 0) {
        objects[id - 1].sum += std::log(double(drawn->eye_z.texels()[p]));
        ++objects[id - 1].count;
      }
    // Each object counts once a frame, so that not only the nearest are measured.
    const std::vector<Placed> placed =
        place_objects(scene, std::vector<double>(scene.models.size(), 1), frame.time);
    for (std::size_t o = 0; o < objects.size(); ++o) {
      if (objects[o].count < kMinPixels || !(placed[o].half_period_world > 0)) continue;
      Mean& model = models[std::size_t(scene.objects[o].model)];
      model.sum += objects[o].sum / objects[o].count +
                   std::log(pixel_at_one(frame.camera) / placed[o].half_period_world);
      ++model.count;
    }
  }
  std::vector<double> half_periods;
  for (const Mean& model : models)
    half_periods.push_back(model.count == 0 ? 1 : kMeanCode * std::exp(model.sum / model.count));
  return half_periods;
}

Image<PixelState> find_measurable(const Scene& scene, std::span<const double> half_periods,
                                  const WalkFrame& frame, const DrawnFrame& truth, int margin) {
  const int w = truth.objects.width(), h = truth.objects.height();
  const Projector projector(frame.camera);
  const double pixel = pixel_at_one(frame.camera);
  const std::vector<Placed> objects = place_objects(scene, half_periods, frame.time);
  const auto code_px = [&](int x, int y) {
    return objects[truth.objects(x, y) - 1].half_period_world / (pixel * double(truth.eye_z(x, y)));
  };
  Image<std::uint8_t> mixing = steps_of(truth.objects, truth.eye_z, pixel);
  parallel_for(0, h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      const std::uint32_t id = truth.objects(x, y);
      if (id == 0 || mixing(x, y) != 0) continue;
      const glm::dvec2 raster(x + 0.5, y + 0.5);
      const double px =
          error_of(projector, objects[id - 1], raster, truth.color(x, y),
                   {world_from_raster(frame.camera, raster, double(truth.eye_z(x, y)))});
      mixing(x, y) = px > kCodeResolution * code_px(x, y);
    }
  });
  mixing = within(mixing, margin);
  Image<PixelState> states(w, h, PixelState::no_object);
  parallel_for(0, h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      if (truth.objects(x, y) == 0) continue;
      const bool at_border = std::min({x, y, w - 1 - x, h - 1 - y}) < margin;
      if (at_border || !is_inside(truth.objects, x, y)) {
        states(x, y) = PixelState::boundary;
      } else if (mixing(x, y) != 0) {
        states(x, y) = PixelState::mixed;
      } else {
        const double code = code_px(x, y);
        states(x, y) = code >= kFinestCode && code <= kCoarsestCode ? PixelState::measurable
                                                                    : PixelState::unresolved;
      }
    }
  });
  return states;
}

void add_drawn_errors(const Scene& scene, std::span<const double> half_periods,
                      const WalkFrame& frame, const DrawnFrame& truth,
                      const Image<PixelState>& states, const DrawnFrame& seen,
                      DrawnErrors& errors) {
  const int w = truth.objects.width(), h = truth.objects.height();
  RILIEVO_EXPECTS(seen.objects.width() == w && seen.objects.height() == h);
  const Projector projector(frame.camera);
  const double pixel = pixel_at_one(frame.camera);
  const std::vector<Placed> objects = place_objects(scene, half_periods, frame.time);
  std::vector<Row> rows(static_cast<std::size_t>(h));
  const double bound_px = seen.stats.bound_px.value_or(0), gap_px = seen.stats.gap_px;
  Image<std::uint8_t> behind;
  if (gap_px > 0) behind = shown_behind(truth, seen, pixel, bound_px + kTexelError);
  parallel_for(0, h, [&](int y) {
    Row& row = rows[std::size_t(y)];
    for (int x = 0; x < w; ++x) {
      const std::uint32_t id = truth.objects(x, y);
      if (id == 0) continue;
      ++row.shown;
      const PixelState state = states(x, y);
      row.mixed += state == PixelState::mixed;
      row.unresolved += state == PixelState::unresolved;
      row.boundary += state == PixelState::boundary;
      if (state != PixelState::measurable) continue;
      if (seen.objects(x, y) != id || !is_inside(seen.objects, x, y)) {
        ++row.boundary;
        continue;
      }
      const Placed& object = objects[id - 1];
      const double true_z = double(truth.eye_z(x, y));
      const glm::dvec2 raster(x + 0.5, y + 0.5);
      const double px =
          error_of(projector, object, raster, seen.color(x, y),
                   {world_from_raster(frame.camera, raster, true_z),
                    world_from_raster(frame.camera, raster, double(seen.eye_z(x, y)))});
      const double resolution = kCodeResolution * object.half_period_world / (pixel * true_z);
      row.errors_px.push_back(float(px));
      row.resolution_px = std::max(row.resolution_px, resolution);
      if (bound_px == 0) continue;
      row.over_bound += px > bound_px + resolution;
      if (px <= bound_px + resolution + kTexelError) continue;
      const bool in_gap = gap_px > 0 && is_in_gap(behind, x, y, gap_px);
      ++(in_gap ? row.in_gaps : row.violations);
    }
  });
  for (const Row& row : rows) add_to(errors, row);
}

Result<> measure_drawn_errors(const Scene& coded, std::span<const double> half_periods,
                              std::span<const ComparedSource> sources,
                              const std::function<WalkFrame(int frame)>& walk,
                              const CompareOptions& options, Report& report) {
  RILIEVO_EXPECTS(!sources.empty());
  std::vector<FrameSource*> drawing;
  for (const ComparedSource& one : sources) drawing.push_back(one.source);
  const Result<DrawTargets> own =
      DrawTargets::create(drawing, options.width, options.height, options.samples);
  if (!own) return own.error();
  const DrawTargets& targets = *own;
  const int margin = 1 + int(std::ceil(options.limits.error_px));

  struct Walked {
    DrawnErrors errors;
    std::int64_t captures = 0, polygons = 0;
  };
  std::vector<Walked> walked(sources.size());
  for (std::size_t s = 0; s < sources.size(); ++s)
    for (int i = 0; i < options.warm_up; ++i) {
      if (const Result<double> ms = time_frame(*sources[s].source, targets, walk(0)); !ms)
        return ms.error();
      walked[s].captures += sources[s].source->stats().captures;
    }
  for (int i = 0; i < options.frames; ++i) {
    const WalkFrame frame = walk(i);
    std::optional<DrawnFrame> truth;
    Image<PixelState> states;
    for (std::size_t s = 0; s < sources.size(); ++s) {
      Result<DrawnFrame> drawn = draw_frame(*sources[s].source, targets, frame);
      if (!drawn) return drawn.error();
      walked[s].captures += drawn->stats.captures;
      walked[s].polygons += drawn->stats.polygons;
      if (!truth) {
        truth = *drawn;
        states = find_measurable(coded, half_periods, frame, *truth, margin);
      }
      add_drawn_errors(coded, half_periods, frame, *truth, states, *drawn, walked[s].errors);
    }
    if (options.progress) options.progress(i + 1, options.frames);
  }
  for (std::size_t s = 0; s < sources.size(); ++s)
    for (MethodResult& method : report.methods) {
      if (method.name != sources[s].name) continue;
      method.error_px = summary_of(walked[s].errors);
      if (walked[s].captures != method.captures)
        report.notes.push_back(method.name + ": error_px is of a second walk, which captured " +
                               std::to_string(walked[s].captures) +
                               " pictures, and the first one " + std::to_string(method.captures) +
                               ".");
    }
  return Done{};
}

}  // namespace rilievo
