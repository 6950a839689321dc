// The bounds of layered_impostor/error.h for surfaces and samples against what the warps draw;
// angular_error_test.cpp has the total's.
#include "rilievo/layered_impostor/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/layered_impostor/error_test_helpers.h"
#include "rilievo/layered_impostor/pixel_march.h"
#include "rilievo/layered_impostor/warp.h"

namespace rilievo {
namespace {

using test_shapes::impostor_of;
using test_shapes::pixels_between;
using test_shapes::random_camera;
using test_shapes::sample_of;
using test_shapes::scene_of;
using test_shapes::Tally;

// From a point to the nearest of a grid of points on the piece over a texel, and how far from one
// of them a point of the piece may be in depth.
double distance_to_piece(const TexelSurface& surface, const glm::ivec2& texel,
                         const glm::dvec3& point, double& slack) {
  constexpr int kGrid = 16;
  const SurfaceTexel& piece = surface.texels(texel.x, texel.y);
  const DepthInterval depths = depth_interval(piece);
  slack = 2.0 * double(depths.back - depths.front) / kGrid;
  double nearest = 1e9;
  for (int j = 0; j <= kGrid; ++j)
    for (int i = 0; i <= kGrid; ++i) {
      const glm::dvec2 at = glm::dvec2(texel) + glm::dvec2(i, j) / double(kGrid);
      const double q = surface_q(piece, glm::dvec2(texel) + 0.5, at);
      nearest =
          std::min(nearest, glm::distance(point, world_from_raster(surface.camera, at, 1 / q)));
    }
  return nearest;
}

constexpr int kObjects = 24;

// The bound was not broken, nor is it far too large.
void expect_kept_and_tight(Tally& tally, int eyes) {
  // Most of the eyes see something, however few they are.
  EXPECT_GE(tally.cases, eyes * 5 / 6);
  EXPECT_GT(tally.points, eyes * 125 / 6);
  EXPECT_EQ(tally.violations, 0);
  // The largest slice, the steepest piece and the nearest corner seldom meet in one point.
  const double tightness = tally.median();
  EXPECT_GE(tally.least(), 1);
  testing::Test::RecordProperty("tightness_least", std::to_string(tally.least()));
  EXPECT_LT(tightness, 12);
  testing::Test::RecordProperty("tightness_median", std::to_string(tightness));
}

// Floats of slices and surfaces: a part in 10^6 of distances of some metres.
constexpr double kRounding = 1e-5;

TEST(LayeredError, no_point_of_a_slice_lies_farther_from_its_sample_than_claimed) {
  std::mt19937 rng(11);
  constexpr int kFrame = 16;
  const int eyes = sanitized_cases(100);
  Tally tally;
  int on_pieces = 0, off_pieces = 0;
  double worst_aside = 0;  // over the bound
  for (int object = 0; object < kObjects; ++object) {
    const LayeredImpostor impostor = impostor_of(scene_of(object % 4), rng, 24 + 8 * (object % 3));
    const LayeredErrorStats stats =
        layered_error_stats(impostor, {.method = LayeredMethod::slices});
    for (int eye = 0; eye < eyes; ++eye) {
      const Camera camera = random_camera(impostor.bounds, rng, kFrame);
      const LayeredError bound = bound_layered_error(stats, impostor.bounds, glm::dmat4(1), camera);
      const std::vector<SliceDraw> draws = slices_for_eye(impostor, camera.position(), eye % 2);
      Image<int> drawn;
      const DepthImage frame = warp_slices(impostor, draws, camera, &drawn);
      double worst_px = 0;
      int points = 0;
      for (int y = 0; y < kFrame; ++y)
        for (int x = 0; x < kFrame; ++x) {
          if (drawn(x, y) < 0) continue;
          const SliceDraw& draw = draws[std::size_t(drawn(x, y))];
          const Slice& slice = impostor.slices[draw.view][draw.slice];
          const TexelSurface& surface = impostor.surfaces[draw.view];
          const glm::dvec3 point = world_from_raster(camera, {x + 0.5, y + 0.5}, frame.depth(x, y));
          const glm::dvec3 raster = raster_from_world(surface.camera, point);
          const glm::ivec2 texel(glm::floor(glm::dvec2(raster)));
          // The texel may be another where the point is on its edge.
          if (glm::any(glm::lessThan(glm::abs(glm::dvec2(raster) - glm::round(glm::dvec2(raster))),
                                     glm::dvec2(1e-3))))
            continue;
          // The inside shows no sample.
          if (!shows(slice, piece_interval(surface.texels(texel.x, texel.y), impostor.slicing)))
            continue;
          const glm::dvec3 sample = sample_of(surface, texel);
          const double px = pixels_between(camera, point, sample);
          worst_px = std::max(worst_px, px);
          tally.violations += glm::distance(point, sample) > bound.sample_m + kRounding ||
                              px > bound.sample_px * (1 + kRounding);
          if (points++ % 5 || !impostor.slicing.pieces) continue;
          double slack = 0;
          const double aside = distance_to_piece(surface, texel, point, slack);
          ++on_pieces;
          off_pieces += aside > bound.surface_m + slack;
          worst_aside = std::max(worst_aside, aside / bound.surface_m);
        }
      tally.add(bound.sample_px, worst_px, points);
    }
  }
  expect_kept_and_tight(tally, kObjects * eyes);
  EXPECT_GT(on_pieces, sanitized_cases(5000));
  EXPECT_EQ(off_pieces, 0);
  EXPECT_GT(worst_aside, 0.5);
}

TEST(LayeredError, no_point_of_the_walk_lies_farther_from_its_sample_than_claimed) {
  std::mt19937 rng(12);
  constexpr int kFrame = 16;
  const int eyes = sanitized_cases(100);
  Tally tally;
  for (int object = 0; object < kObjects; ++object) {
    const LayeredImpostor impostor = impostor_of(scene_of(object % 4), rng, 24 + 8 * (object % 3));
    const LayeredErrorStats stats =
        layered_error_stats(impostor, {.method = LayeredMethod::surfaces});
    for (int eye = 0; eye < eyes; ++eye) {
      const Camera camera = random_camera(impostor.bounds, rng, kFrame);
      const LayeredError bound = bound_layered_error(stats, impostor.bounds, glm::dmat4(1), camera);
      EXPECT_EQ(bound.surface_px, 0);
      const int view = int(rng() % impostor.pictures.size());
      double worst_px = 0;
      int points = 0;
      for (int y = 0; y < kFrame; ++y)
        for (int x = 0; x < kFrame; ++x) {
          const auto ray = pixel_ray(impostor.bounds, camera, {x + 0.5, y + 0.5});
          if (!ray) continue;
          const SurfaceHit march = march_picture(impostor, view, *ray);
          if (!march.hit) continue;
          const TexelSurface& surface = impostor.surfaces[view];
          const glm::dvec3 point =
              world_from_raster(surface.camera, glm::dvec2(march.at), 1 / march.at.z);
          const glm::dvec3 sample = sample_of(surface, march.texel);
          const double px = pixels_between(camera, point, sample);
          ++points;
          worst_px = std::max(worst_px, px);
          tally.violations += glm::distance(point, sample) > bound.sample_m + kRounding ||
                              px > bound.sample_px * (1 + kRounding);
        }
      tally.add(bound.sample_px, worst_px, points);
    }
  }
  expect_kept_and_tight(tally, kObjects * eyes);
}

TEST(LayeredError, scales_with_the_instance_and_knows_the_distance) {
  std::mt19937 rng(13);
  const LayeredImpostor impostor = impostor_of(scene_of(0), rng, 32);
  const LayeredErrorStats stats = layered_error_stats(impostor, {.method = LayeredMethod::slices});
  Camera camera = look_at({0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 0.7, 64, 64, 0.1, 100);
  const glm::dmat4 one(1);
  const LayeredError here = bound_layered_error(stats, impostor.bounds, one, camera);
  EXPECT_GT(here.sample_px, 0);
  EXPECT_GT(here.surface_px, 0);
  // The box is nearer to the axis than the frame's corner is.
  const LayeredError anywhere =
      bound_layered_error_from(stats, impostor.bounds, camera, 8 - double(impostor.bounds.max.z));
  EXPECT_LT(here.sample_px, anywhere.sample_px);
  EXPECT_GT(here.sample_px, 0.8 * anywhere.sample_px);
  EXPECT_EQ(here.sample_m, anywhere.sample_m);
  // Everything three times as large and turned: the same pixels, three times the metres.
  glm::dmat4 motion = glm::translate(one, glm::dvec3(5, -2, 9));
  motion = glm::scale(glm::rotate(motion, 0.8, glm::normalize(glm::dvec3(1, 2, 3))), glm::dvec3(3));
  Camera moved = camera;
  moved.world_from_eye = motion * camera.world_from_eye;
  for (int k = 0; k < 3; ++k) moved.world_from_eye[k] /= 3.0;
  const LayeredError there = bound_layered_error(stats, impostor.bounds, motion, moved);
  EXPECT_NEAR(there.sample_px, here.sample_px, 1e-9);
  EXPECT_NEAR(there.sample_m, 3 * here.sample_m, 1e-9);
  // In the box nothing is known.
  camera.world_from_eye[3] = glm::dvec4(0, 0, 0, 1);
  EXPECT_TRUE(std::isinf(bound_layered_error(stats, impostor.bounds, one, camera).sample_px));
}

// A wall of polygons through the object. Where another of the two shows than in truth, the bound
// speaks: either the frame's true border between them (where they cut, or the object's outline) is
// within the bound in pixels; or the object's true surface is within the bound of the wall in
// metres, and depth alone is to blame.
TEST(LayeredError, through_a_wall_it_cuts_within_the_bound) {
  std::mt19937 rng(14);
  std::normal_distribution<double> n;
  constexpr int kFrame = 64;
  int differing = 0, near_border = 0, near_wall = 0, holes = 0, compared = 0;
  for (int object = 0; object < 8; ++object) {
    const Scene scene = scene_of(object % 4);
    const Result<RayScene> rays = RayScene::create(scene);
    const LayeredImpostor impostor = impostor_of(scene, rng, 64);
    const LayeredErrorStats of_march =
        layered_error_stats(impostor, {.method = LayeredMethod::surfaces});
    const LayeredErrorStats of_slices =
        layered_error_stats(impostor, {.method = LayeredMethod::slices});
    for (int eye = 0; eye < 8; ++eye) {
      const bool sliced = eye % 2;
      const Camera camera = random_camera(impostor.bounds, rng, kFrame);
      const LayeredError bound = bound_layered_error(sliced ? of_slices : of_march, impostor.bounds,
                                                     glm::dmat4(1), camera);
      // Through a point within the object, any way round.
      const glm::dvec3 normal = glm::normalize(glm::dvec3(n(rng), n(rng), n(rng)));
      const double offset = 0.2 * n(rng);
      const auto wall_z = [&](int x, int y) {  // eye_z of the wall; none behind the eye
        const glm::dvec3 along =
            world_from_raster(camera, {x + 0.5, y + 0.5}, 1.0) - camera.position();
        const double z = (offset - glm::dot(normal, camera.position())) / glm::dot(normal, along);
        return z > 0 ? z : double(kNoDepth);
      };
      const DepthImage truth = cast_picture(*rays, camera);
      const DepthImage frame =
          sliced ? warp_slices(impostor, slices_for_eye(impostor, camera.position(), true), camera)
                 : warp_surfaces(impostor, camera);
      const auto shows_object = [&](const DepthImage& picture, int x, int y) {
        return picture.depth(x, y) < wall_z(x, y);
      };
      std::vector<glm::dvec2> border;
      for (int y = 0; y < kFrame; ++y)
        for (int x = 0; x < kFrame; ++x)
          for (const auto& [dx, dy] : {std::pair(1, 0), {0, 1}}) {
            if (x + dx >= kFrame || y + dy >= kFrame) continue;
            if (shows_object(truth, x, y) != shows_object(truth, x + dx, y + dy))
              border.push_back({x + 0.5 + 0.5 * dx, y + 0.5 + 0.5 * dy});
          }
      for (int y = 0; y < kFrame; ++y)
        for (int x = 0; x < kFrame; ++x) {
          ++compared;
          if (shows_object(truth, x, y) == shows_object(frame, x, y)) continue;
          ++differing;
          if (truth.covered(x, y) && !frame.covered(x, y)) {
            ++holes;
            continue;
          }
          double nearest = 1e9;
          for (const glm::dvec2& b : border)
            nearest = std::min(nearest, glm::distance(b, glm::dvec2(x + 0.5, y + 0.5)));
          // The border is known to half a pixel.
          if (nearest <= bound.sample_px + 0.75) {
            ++near_border;
            continue;
          }
          const glm::dvec3 true_point =
              world_from_raster(camera, {x + 0.5, y + 0.5}, truth.depth(x, y));
          near_wall += truth.covered(x, y) &&
                       std::abs(glm::dot(normal, true_point) - offset) <= bound.sample_m;
        }
    }
  }
  EXPECT_GT(compared, 100000);
  EXPECT_GT(differing, 500);
  EXPECT_EQ(differing - holes, near_border + near_wall);
  EXPECT_LT(holes, differing / 5);
}

}  // namespace
}  // namespace rilievo
