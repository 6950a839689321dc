// The total bound of layered_impostor/error.h against all that is drawn.
#include "rilievo/layered_impostor/angular_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/layered_impostor/error.h"
#include "rilievo/layered_impostor/error_test_helpers.h"
#include "rilievo/layered_impostor/pixel_march.h"
#include "rilievo/layered_impostor/slice_quads.h"
#include "rilievo/layered_impostor/warp.h"

namespace rilievo {
namespace {

using test_shapes::impostor_of;
using test_shapes::random_camera;
using test_shapes::random_direction;
using test_shapes::sample_of;
using test_shapes::scene_of;
using test_shapes::Tally;

// Colours are floats, a part in 10^7 of metres.
constexpr double kPlaceRounding = 1e-5;

// An impostor whose colours are the places of its samples: what a frame of it shows is the source
// of each pixel.
LayeredImpostor places_of(const Scene& scene, std::mt19937& rng, int object) {
  constexpr ViewSpread kSpreads[] = {ViewSpread::faces_12, ViewSpread::vertices_20,
                                     ViewSpread::both_32};
  LayeredImpostor impostor =
      impostor_of(scene, rng, 32 + 16 * (object % 4), kSpreads[object / 4 % 3]);
  for (std::size_t v = 0; v < impostor.pictures.size(); ++v) {
    DepthImage& picture = impostor.pictures[v];
    for (int y = 0; y < picture.color.height(); ++y)
      for (int x = 0; x < picture.color.width(); ++x)
        if (picture.covered(x, y))
          picture.color(x, y) = glm::vec4(glm::vec3(sample_of(impostor.surfaces[v], {x, y})), 1.0f);
  }
  return impostor;
}

double error_px(const Camera& camera, int x, int y, const glm::vec4& place) {
  return glm::distance(glm::dvec2(raster_from_world(camera, glm::dvec3(place))),
                       glm::dvec2(x + 0.5, y + 0.5));
}

// Does a view's surface meet the ray? If none does, a pixel shows the skin over the inside.
bool meets_a_surface(const LayeredImpostor& impostor, const Camera& camera, int x, int y,
                     const ServingViews& serving) {
  const auto ray = pixel_ray(impostor.bounds, camera, {x + 0.5, y + 0.5});
  if (!ray) return false;
  for (int i = 0; i < serving.count; ++i)
    if (march_picture(impostor, serving.views[i], *ray).hit) return true;
  return false;
}

// Does the slice show the texel's patch there, or the inside behind it?
bool shows_a_patch(const LayeredImpostor& impostor, const SliceDraw& draw, const Camera& camera,
                   int x, int y, float eye_z) {
  const TexelSurface& surface = impostor.surfaces[std::size_t(draw.view)];
  const glm::dvec3 raster =
      raster_from_world(surface.camera, world_from_raster(camera, {x + 0.5, y + 0.5}, eye_z));
  // The texel may be another where the point is on its edge.
  const glm::dvec2 off = glm::abs(glm::dvec2(raster) - glm::round(glm::dvec2(raster)));
  if (std::min(off.x, off.y) < 1e-3) return false;
  const SurfaceTexel& texel = surface.texels(int(raster.x), int(raster.y));
  return texel.q != 0 && shows(impostor.slices[std::size_t(draw.view)][std::size_t(draw.slice)],
                               piece_interval(texel, impostor.slicing));
}

// What one frame shows, against the bound.
struct Judged {
  double bound_px = 0, worst_px = 0;
  int points = 0, violations = 0;

  void add(double px) {
    ++points;
    worst_px = std::max(worst_px, px);
    violations += px > bound_px * (1 + kPlaceRounding);
  }
};

double bound_at_pixels(const LayeredErrorStats& stats, const LayeredImpostor& impostor,
                       const Camera& camera) {
  return bound_layered_error(stats, impostor.bounds, glm::dmat4(1), camera).total_px +
         std::sqrt(0.5);
}

// One of the views that share the pixels, with or without the slices that fill its holes.
Judged judge_slices(const LayeredImpostor& impostor, const LayeredErrorStats& stats,
                    const Camera& camera, int choice) {
  const ServingViews serving =
      views_for_eye(impostor, camera.position(), {.method = LayeredMethod::slices});
  std::vector<SliceDraw> draws;
  slices_of_view(impostor, serving.views[choice % serving.weighted], camera.position(),
                 choice % 4 > 0, draws);
  Image<int> drawn;
  const DepthImage frame = warp_slices(impostor, draws, camera, &drawn);
  Judged judged{.bound_px = bound_at_pixels(stats, impostor, camera)};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      if (drawn(x, y) >= 0 &&
          shows_a_patch(impostor, draws[std::size_t(drawn(x, y))], camera, x, y, frame.depth(x, y)))
        judged.add(error_px(camera, x, y, frame.color(x, y)));
  return judged;
}

Judged judge_march(const LayeredImpostor& impostor, const LayeredErrorStats& stats,
                   const Camera& camera) {
  const ServingViews serving =
      views_for_eye(impostor, camera.position(), {.method = LayeredMethod::surfaces});
  const DepthImage frame = warp_surfaces(impostor, camera);
  Judged judged{.bound_px = bound_at_pixels(stats, impostor, camera)};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      if (frame.covered(x, y) && meets_a_surface(impostor, camera, x, y, serving))
        judged.add(error_px(camera, x, y, frame.color(x, y)));
  return judged;
}

TEST(AngularError, no_pixel_is_farther_from_the_source_of_its_colour_than_the_bound) {
  std::mt19937 rng(21);
  constexpr int kFrame = 32;
  for (const LayeredMethod method : {LayeredMethod::slices, LayeredMethod::surfaces}) {
    const std::string name = method == LayeredMethod::slices ? "slices" : "surfaces";
    Tally tally;
    // An object's table costs as much as the frames do.
    const int objects = sanitized_cases(24), eyes = sanitized_cases(100);
    for (int object = 0; object < objects; ++object) {
      const LayeredImpostor impostor = places_of(scene_of(object % 4), rng, object);
      const LayeredErrorStats stats = layered_error_stats(impostor, {.method = method});
      for (int eye = 0; eye < eyes; ++eye) {
        const Camera camera = random_camera(impostor.bounds, rng, kFrame);
        const Judged judged = method == LayeredMethod::slices
                                  ? judge_slices(impostor, stats, camera, eye)
                                  : judge_march(impostor, stats, camera);
        tally.violations += judged.violations;
        tally.add(judged.bound_px, judged.worst_px, judged.points);
      }
    }
    RecordProperty(name + "_points", tally.points);
    RecordProperty(name + "_violations", tally.violations);
    RecordProperty(name + "_tightness_least", std::to_string(tally.least()));
    EXPECT_EQ(tally.violations, 0) << name;
    // Most of the frames show something, however few they are.
    EXPECT_GE(tally.cases, objects * eyes * 5 / 6);
    EXPECT_GT(tally.points, objects * eyes * 250 / 3);
    EXPECT_GE(tally.least(), 1);
  }
}

// Where a frame has pixels enough to find its worst ones, and a texel is some pixels, as otherwise
// the half pixel that polygons are off by, too, is most of the bound. The bound is for all eyes
// that look from a range of directions, and of the up to six views that a ray may be looked up in
// it takes the worst, which few pixels show: two to three times what a frame has. Nearer than two
// radii, the wide angle of the frame adds to that: its corners stretch what its middle does not.
TEST(AngularError, the_bound_is_a_few_times_what_a_frame_shows) {
  std::mt19937 rng(23);
  std::uniform_real_distribution<double> distances(2, 8);
  constexpr int kFrame = 160;
  for (const LayeredMethod method : {LayeredMethod::slices, LayeredMethod::surfaces}) {
    const std::string name = method == LayeredMethod::slices ? "slices" : "surfaces";
    Tally tally;
    for (int object = 0; object < (kSanitized ? 3 : 9); ++object) {
      // A ball has neither edges nor steps: the march shows it nearly without an error.
      const LayeredImpostor impostor = places_of(scene_of(object % 3), rng, 4 * object + 2);
      const LayeredErrorStats stats = layered_error_stats(impostor, {.method = method});
      for (int eye = 0; eye < (kSanitized ? 4 : 10); ++eye) {
        const double distance = distances(rng), radius = impostor.bounds.radius();
        const glm::dvec3 center(impostor.bounds.center());
        const Camera camera =
            look_at(center + distance * radius * random_direction(rng), center, {0.1, 1, 0.05},
                    2 * std::asin(1 / distance), kFrame, kFrame, 0.02 * radius, 20 * radius);
        const Judged judged = method == LayeredMethod::slices
                                  ? judge_slices(impostor, stats, camera, eye)
                                  : judge_march(impostor, stats, camera);
        EXPECT_EQ(judged.violations, 0);
        tally.add(judged.bound_px, judged.worst_px, judged.points);
      }
    }
    RecordProperty(name + "_tightness_least", std::to_string(tally.least()));
    RecordProperty(name + "_tightness_median", std::to_string(tally.median()));
    EXPECT_LT(tally.median(), 3.5) << name;
    EXPECT_GE(tally.least(), 1) << name;
  }
}

// Every point that a texel of a view that is drawn can show, seen or not, by the definition.
TEST(AngularError, no_texel_is_forgotten) {
  std::mt19937 rng(24);
  std::uniform_real_distribution<double> u(-0.5, 0.5);
  int points = 0, violations = 0;
  double largest_share = 0;
  for (int object = 0; object < 6; ++object) {
    const LayeredImpostor impostor = places_of(scene_of(object % 3), rng, 4 * object);
    const AngularErrorTable table =
        make_angular_error_table(impostor, {.method = LayeredMethod::surfaces});
    const glm::dvec3 center(impostor.bounds.center());
    const double radius = impostor.bounds.radius();
    for (int i = 0; i < sanitized_cases(20); ++i) {
      const glm::dvec3 relative = (1.3 + 5 * (u(rng) + 0.5)) * random_direction(rng);
      const glm::dvec3 eye = center + radius * relative;
      const double bound = angular_error_sine(table, relative);
      EXPECT_LE(bound, angular_error_sine_from(table, glm::length(relative) * 0.9999));
      const ServingViews serving =
          views_for_eye(impostor, eye, {.method = LayeredMethod::surfaces});
      for (int v = 0; v < serving.count; ++v) {
        const TexelSurface& surface = impostor.surfaces[std::size_t(serving.views[v])];
        for (int y = 0; y < surface.texels.height(); ++y)
          for (int x = 0; x < surface.texels.width(); ++x) {
            const SurfaceTexel& texel = surface.texels(x, y);
            if (texel.q == 0) continue;
            const glm::dvec2 offset(u(rng), u(rng)), middle(x + 0.5, y + 0.5);
            const SampleWeights w = sample_weights(texel, offset);
            glm::dvec3 place = double(w.own) * sample_of(surface, {x, y});
            if (w.u > 0) place += double(w.u) * sample_of(surface, {x + w.side.x, y});
            if (w.v > 0) place += double(w.v) * sample_of(surface, {x, y + w.side.y});
            if (w.uv > 0) place += double(w.uv) * sample_of(surface, glm::ivec2(x, y) + w.side);
            const glm::dvec3 drawn = world_from_raster(
                surface.camera, middle + offset, 1 / surface_q(texel, middle, middle + offset));
            const double sine =
                glm::length(glm::cross(glm::normalize(drawn - eye), glm::normalize(place - eye)));
            ++points;
            violations += sine > bound * (1 + 1e-6) + 1e-9;
            largest_share = std::max(largest_share, sine / bound);
          }
      }
    }
  }
  EXPECT_GT(points, sanitized_cases(300000));
  EXPECT_EQ(violations, 0);
  EXPECT_GT(largest_share, 0.5);
}

}  // namespace
}  // namespace rilievo
