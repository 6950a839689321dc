// What is drawn of layered reliefs, against the objects themselves.

#include <gtest/gtest.h>

#include <bit>
#include <string>

#include "rilievo/capture/deep_image_source.h"
#include "rilievo/core/color.h"
#include "rilievo/layered_relief/merge_layers.h"
#include "rilievo/layered_relief/relief_error_test_helpers.h"
#include "rilievo/layered_relief/relief_kind.h"
#include "rilievo/layered_relief/relief_pictures.h"
#include "rilievo/layered_relief/relief_set.h"
#include "rilievo/layered_relief/relief_test_helpers.h"
#include "rilievo/layered_relief/splat_layers_test_helpers.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/render/rays/cast_layers.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

LayeredDepthImage one_line(const std::vector<LayerSample>& samples) {
  LayeredDepthImage layers;
  layers.camera.projection = Projection::parallel;
  layers.samples = samples;
  layers.first = {0, samples.size()};
  return layers;
}

TEST(MergeLayers, the_first_of_those_that_lie_together_stays) {
  const auto at = [](float depth) { return LayerSample{glm::vec4(1), depth, depth, 1}; };
  const LayeredDepthImage merged =
      merge_layers(one_line({at(1.0f), at(1.1f), at(1.2f), at(1.3f), at(2.0f)}), 0.25);
  ASSERT_EQ(merged.samples.size(), 3u);  // from the first, not from the last
  EXPECT_EQ(merged.samples[1].depth, 1.3f);
  EXPECT_EQ(merged.first, (std::vector<std::uint64_t>{0, 3}));
}

TEST(GatherLayers, translucent_samples_become_one_that_hides_as_much) {
  const auto fog = [](float depth, float alpha, const glm::vec3& color) {
    return LayerSample{glm::vec4(alpha * color, alpha), depth, depth, 1};
  };
  const LayeredDepthImage gathered =
      gather_layers(one_line({fog(1, 0.3f, {1, 0, 0}), fog(2, 0.4f, {0, 1, 0}),
                              fog(3, 1.0f, {0, 0, 1}), fog(4, 0.2f, {1, 1, 1})}),
                    0.5f);
  ASSERT_EQ(gathered.samples.size(), 2u);
  // 0.3 and 0.7 * 0.4 = 0.28 of 0.58; the first contributes most.
  const LayerSample& first = gathered.samples[0];
  EXPECT_EQ(first.depth, 1.0f);
  EXPECT_LT(glm::distance(first.color, glm::vec4(0.3f / 0.58f, 0.28f / 0.58f, 0, 1)), 1e-6f);
  EXPECT_EQ(gathered.samples[1].depth, 3.0f);
  EXPECT_EQ(gathered.samples[1].color, glm::vec4(0, 0, 1, 1));
}

TEST(ReliefSet, frames_of_the_ball_hold_the_box_and_have_texels_of_one_size) {
  const Box box{{-1, 2, 0}, {3, 3, 1.5f}};
  for (const glm::dvec3& direction : {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0), {0.6, 0, 0.8}}) {
    const Result<Camera> camera = relief_camera(box, direction, 64, 1.25);
    ASSERT_TRUE(camera);
    EXPECT_TRUE(camera->width == 64 && camera->height == 64);
    EXPECT_NEAR(texel_angle(*camera), 2.5 * double(box.radius()) / 64, 1e-9);
    for (const glm::vec3& corner : box.corners()) {
      const glm::dvec3 at = raster_from_world(*camera, corner);
      EXPECT_TRUE(at.x >= 0 && at.x <= 64 && at.y >= 0 && at.y <= 64);
    }
  }
}

TEST(ReliefSet, the_relief_is_switched_before_its_rectangle_stretches) {
  const Result<BuiltinScene> built = make_builtin("builtin:fish?triangles=3000");
  ASSERT_TRUE(built);
  const Result<RayScene> rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  const Result<std::vector<glm::dvec3>> six = relief_directions(6);
  const Result<ReliefSet> set = bake_reliefs(*rays, *six, {.size = 48});
  ASSERT_TRUE(set) << set.error().message();
  ASSERT_EQ(set->reliefs.size(), 6u);
  const Box box = world_bounds(built->scene);
  const glm::dvec3 center(box.center());
  double most = 0, most_of_one = 0;
  int current = -1, switches = 0;
  for (int step = 0; step < 360; ++step) {
    const double angle = step * 0.0174533, distance = 4 * double(box.radius());
    const glm::dvec3 eye = center + distance * glm::dvec3(std::sin(angle), 0.3, std::cos(angle));
    const int picked = pick_relief(*set, eye, current);
    ASSERT_GE(picked, 0);
    switches += picked != current;
    current = picked;
    most = std::max(most, relief_stretch(set->reliefs[std::size_t(picked)], eye));
    most_of_one = std::max(most_of_one, relief_stretch(set->reliefs[0], eye));
    // None faces the eye better, by more than what holds the current one.
    for (const LayeredRelief& other : set->reliefs)
      if (std::isfinite(relief_stretch(other, eye))) {
        const glm::dvec3 towards = glm::normalize(eye - center);
        const auto facing = [&](const LayeredRelief& r) {
          return std::acos(glm::dot(towards, -r.camera.forward()));
        };
        // The reliefs' centres differ a little from the box's.
        EXPECT_LE(facing(set->reliefs[std::size_t(picked)]), facing(other) + 0.05 + 0.03);
      }
  }
  EXPECT_GE(switches, 4);
  EXPECT_LE(switches, 6);
  // Up to 45 degrees to the side: a fish is flat, and seen from its head it is as deep as long.
  EXPECT_LT(most, 12);
  EXPECT_GT(most_of_one, 2 * most);  // or infinite
  EXPECT_FALSE(relief_directions(7));
  for (const int count : {1, 2, 6, 12, 20, 32})
    EXPECT_EQ(relief_directions(count)->size(), std::size_t(count));
}

// By position: each texel of the result shows a sample; the surfaces that this sample stands for
// lie anywhere in its source texel and in the depth that was merged into it.
TEST(ReliefError, no_sample_is_drawn_farther_from_where_it_belongs_than_the_bound) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  double closest = 0;
  for (int i = 0; i < 12; ++i) {
    const double merge = i % 3 ? 0.05 : 1e-3;
    LayeredRelief relief =
        *build_layered_relief(random_layers(rng, 40, 36), {.tile_size = 8, .merge = merge});
    const std::vector<PlacedSample> samples = label_samples(relief);
    const ReliefFrame frame = relief.frame();
    for (int e = 0; e < 8; ++e) {
      const glm::dvec3 eye = random_eye(rng, relief);
      PrewarpOptions options;
      options.splat_size = i % 2 ? 1.0 : 2.0;
      options.resolution = e % 2 ? 1.0 : 0.6;
      Prewarped result;
      const auto stats = Prewarp(relief, options).warp(eye, nullptr, result);
      ASSERT_TRUE(stats);
      const Camera camera = look_at(eye, frame.world(20 + 10 * unit(rng), 18 + 10 * unit(rng), 0),
                                    {0, 1, 0.1}, 0.9, 640, 480, 0.01, 100);
      const double bound = relief_error_px(
          relief, camera, {.splat_size = options.splat_size, .resolution = stats->resolution});
      for (int y = 0; y < result.height(); ++y)
        for (int x = 0; x < result.width(); ++x) {
          const std::size_t t = std::size_t(y) * std::size_t(result.width()) + std::size_t(x);
          if (result.delta[t] == kEmptyCode) continue;
          const PlacedSample& s = samples[std::bit_cast<std::uint32_t>(result.color[t])];
          // Somewhere in the result's texel; and somewhere in the surface that it shows.
          const glm::dvec3 drawn = world_from_raster(
              result.geometry.capture, {x + 0.5 + 0.499 * unit(rng), y + 0.5 + 0.499 * unit(rng)},
              result.geometry.plane_z);
          const glm::dvec3 is =
              frame.world(s.u + 0.5 + 0.5 * unit(rng), s.v + 0.5 + 0.5 * unit(rng),
                          relief.d(s.code) + relief.merged_d * std::abs(unit(rng)));
          const glm::dvec3 a = raster_from_world(camera, drawn), b = raster_from_world(camera, is);
          const auto in_frame = [](const glm::dvec3& p) {
            return p.z > 0 && p.x >= 0 && p.y >= 0 && p.x <= 640 && p.y <= 480;
          };
          if (!in_frame(a) || !in_frame(b)) continue;
          const double error = glm::distance(glm::dvec2(a), glm::dvec2(b));
          ASSERT_LE(error, bound);
          closest = std::max(closest, error / bound);
        }
    }
  }
  EXPECT_GT(closest, 0.3);  // and it is no idle promise
}

// A picture's share of pixels that differ from the truth in which of two things they show.
TEST(MapPicture, what_is_warped_and_a_polygon_cut_each_other_where_they_do) {
  const Result<BuiltinScene> built = make_builtin("builtin:fish?triangles=20000");
  ASSERT_TRUE(built);
  Scene scene = built->scene;
  const Result<RayScene> alone = RayScene::create(scene);
  ASSERT_TRUE(alone);
  const Box box = world_bounds(scene);
  ReliefBakeOptions bake;
  bake.size = 256;
  const std::vector<glm::dvec3> front = {{0, 0, 1}};
  const Result<ReliefSet> set = bake_reliefs(*alone, front, bake);
  ASSERT_TRUE(set);
  const LayeredRelief& relief = set->reliefs[0];

  const glm::dvec3 eye = glm::dvec3(box.center()) + glm::dvec3(0.7, 0.4, 3.5);
  const Camera camera = look_at(eye, glm::dvec3(box.center()), {0, 1, 0}, 0.75, 160, 120, 0.1, 20);
  Prewarped result;
  ASSERT_TRUE(Prewarp(relief, {.resolution = 2}).warp(eye, &camera, result));

  // A plane through the fish, across the line of sight but turned: x + z = 0, both sides.
  const DepthImage fish = cast_picture(*alone, camera);
  SplattedFrame frame = empty_frame(camera);
  const double bound_px = relief_error_px(relief, camera, {.resolution = 2});
  int compared = 0, wrong = 0;
  Image<float> plane(160, 120, kNoDepth);
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const glm::dvec3 ray = world_from_raster(camera, {x + 0.5, y + 0.5}, 1.0) - eye;
      const double t = -(eye.x + 3 * eye.z) / (ray.x + 3 * ray.z);
      frame.depth(x, y) = plane(x, y) = float(t);
      frame.color(x, y) = {1, 0, 1, 1};
    }
  map_picture(result, frame);
  const double pixel = (camera.window.right - camera.window.left) / 160;
  for (int y = 2; y < 118; ++y)
    for (int x = 2; x < 158; ++x) {
      // Away from the outline, and from where the two are nearer to each other than the bound puts
      // them apart: so many pixels beside, the fish may be as much deeper as it is steep.
      bool inside = true;
      float low = 1e30f, high = -1e30f;
      for (int v = y - 2; v <= y + 2; ++v)
        for (int u = x - 2; u <= x + 2; ++u) {
          inside &= fish.covered(u, v) == fish.covered(x, y);
          if (!fish.covered(u, v)) continue;
          low = std::min(low, fish.depth(u, v) - plane(u, v));
          high = std::max(high, fish.depth(u, v) - plane(u, v));
        }
      if (!inside) continue;
      const double slack = bound_px * pixel * double(plane(x, y));
      if (fish.covered(x, y) && low - slack < 0 && high + slack > 0) continue;
      const bool fish_is_nearer = fish.covered(x, y) && fish.depth(x, y) < plane(x, y);
      const bool shows_plane = frame.color(x, y) == glm::vec4(1, 0, 1, 1);
      ++compared;
      wrong += shows_plane == fish_is_nearer;
    }
  EXPECT_LT(bound_px, 2.0);
  EXPECT_GT(compared, 8000);
  // Cracks between splats show the plane: a few in a thousand.
  EXPECT_LE(wrong, compared / 200);
}

TEST(SplatLayers, squares_show_the_object_as_the_prewarp_does) {
  const Result<BuiltinScene> built = make_builtin("builtin:cube");
  ASSERT_TRUE(built);
  const Result<RayScene> rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  const std::vector<glm::dvec3> corner = {glm::normalize(glm::dvec3(1, 0.8, 1.2))};
  const Result<ReliefSet> set = bake_reliefs(*rays, corner, {.size = 200});
  ASSERT_TRUE(set);
  const Camera camera = look_at({2.2, 1.9, 3.0}, {0, 0, 0}, {0, 1, 0}, 0.5, 150, 150, 0.1, 20);
  const DepthImage truth = cast_picture(*rays, camera);
  for (const SplatShape shape : {SplatShape::square, SplatShape::gaussian}) {
    const SplattedFrame frame = splat_layers(set->reliefs[0], camera, shape);
    int inside = 0, far = 0, holes = 0;
    for (int y = 3; y < 147; ++y)
      for (int x = 3; x < 147; ++x) {
        bool all = true, none = true;
        for (int v = y - 3; v <= y + 3; ++v)
          for (int u = x - 3; u <= x + 3; ++u) truth.covered(u, v) ? none = false : all = false;
        if (none) {
          EXPECT_EQ(frame.color(x, y).a, 0);
        }
        if (!all) continue;
        ++inside;
        holes += frame.depth(x, y) == kNoDepth;
        if (frame.depth(x, y) != kNoDepth)
          // Three texels of depth at most: the cube's faces are steep.
          far += std::abs(frame.depth(x, y) - truth.depth(x, y)) > 0.05f;
      }
    EXPECT_GT(inside, 4000);
    EXPECT_LE(far, inside / 100);
    EXPECT_LE(holes, inside / 20);
  }
}

// A deep image of a plant, and the picture that a frame shows of it from its own eye: the nearest
// surface at each texel. 40 dB allow for what 8 bits and interpolation at texels' centres round.
TEST(DeepImages, from_its_own_eye_one_shows_its_own_picture) {
  const Result<BuiltinScene> built = make_builtin("builtin:fern?triangles=20000");
  ASSERT_TRUE(built);
  const Result<RayScene> rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  const glm::dvec3 center(world_bounds(built->scene).center());
  const glm::dvec3 eye = center + glm::dvec3(0.2, 0.5, 0.9);
  const Camera camera = look_at(eye, center, {0, 1, 0}, 0.9, 160, 120, 0.05, 20);
  LayeredDepthImage deep = cast_layers(*rays, camera);
  const Result<ReliefPictures> adopted = adopt_relief_pictures({&deep, 1}, {});
  ASSERT_TRUE(adopted) << adopted.error().message();
  const Result<ReliefSet> set = make_relief_set(*adopted);
  ASSERT_TRUE(set);
  ASSERT_TRUE(validate(set->reliefs[0]));
  Prewarped result;
  ASSERT_TRUE(Prewarp(set->reliefs[0], {.splat_size = 1.5}).warp(eye, &camera, result));
  SplattedFrame frame = empty_frame(camera);
  map_picture(result, frame);
  SplattedFrame own = empty_frame(camera);
  int covered = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const std::size_t i = std::size_t(y) * 160 + std::size_t(x);
      if (deep.first[i] == deep.first[i + 1]) continue;
      const LayerSample& first = deep.samples[deep.first[i]];
      for (int c = 0; c < 3; ++c) own.color(x, y)[c] = srgb_from_linear(first.color[c]);
      own.color(x, y).a = 1;
      ++covered;
    }
  // Texel by texel, with its depth, in 65534 steps of 1 / z from 0.05 to 20 m.
  const glm::ivec2 origin = grid_origin(set->reliefs[0], result, 1);
  int shown = 0;
  for (int y = 0; y < result.height(); ++y)
    for (int x = 0; x < result.width(); ++x) {
      const std::uint16_t delta = result.delta[std::size_t(y * result.width() + x)];
      if (delta == kEmptyCode) continue;
      ++shown;
      const std::size_t i = std::size_t(y + origin.y) * 160 + std::size_t(x + origin.x);
      ASSERT_LT(deep.first[i], deep.first[i + 1]);
      const double z = eye_z_from(DepthKind::window_z, double(decode_delta(delta, 16)),
                                  result.geometry.capture, {x + 0.5, y + 0.5});
      EXPECT_NEAR(z, double(deep.samples[deep.first[i]].depth), 1e-3);
    }
  EXPECT_EQ(shown, covered);
  EXPECT_GT(covered, 2000);
  EXPECT_GT(psnr_db(frame_over(own, glm::vec3(0.5f)), frame_over(frame, glm::vec3(0.5f))), 40);
}

// Ahead, back and aside of its own eye, and so near that a part is behind the new one.
TEST(DeepImages, from_other_eyes_surfaces_are_where_they_are) {
  const Result<BuiltinScene> built = make_builtin("builtin:fish?triangles=20000");
  ASSERT_TRUE(built);
  const Result<RayScene> rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  const glm::dvec3 center(world_bounds(built->scene).center());
  const glm::dvec3 eye = center + glm::dvec3(0.5, 0.4, 3.0);
  const Camera camera = look_at(eye, center, {0, 1, 0}, 0.9, 240, 180, 0.05, 20);
  LayeredDepthImage deep = cast_layers(*rays, camera);
  const Result<ReliefPictures> adopted = adopt_relief_pictures({&deep, 1}, {});
  ASSERT_TRUE(adopted);
  const Result<ReliefSet> set = make_relief_set(*adopted);
  ASSERT_TRUE(set);
  for (const glm::dvec3& step :
       {glm::dvec3(0, 0, -0.8), glm::dvec3(0, 0, 0.9), glm::dvec3(0.4, 0, 0),
        glm::dvec3(-0.2, 0.3, 0.2), glm::dvec3(0.3, -0.1, -0.4)}) {
    const Camera other = look_at(eye + step, center, {0, 1, 0}, 0.7, 120, 90, 0.05, 20);
    Prewarped result;
    ASSERT_TRUE(Prewarp(set->reliefs[0], {.splat_size = 1.5}).warp(eye + step, &other, result));
    SplattedFrame frame = empty_frame(other);
    map_picture(result, frame);
    const DepthImage truth = cast_picture(*rays, other);
    int inside = 0, wrong = 0;
    for (int y = 2; y < 88; ++y)
      for (int x = 2; x < 118; ++x) {
        // Where all around is one surface, no steeper than the slack.
        bool one = truth.covered(x, y);
        for (int k = 0; k < 25 && one; ++k) {
          const int u = x + k % 5 - 2, v = y + k / 5 - 2;
          one = truth.covered(u, v) && std::abs(truth.depth(u, v) - truth.depth(x, y)) < 0.1f;
        }
        if (!one) continue;
        ++inside;
        wrong += !(std::abs(frame.depth(x, y) - truth.depth(x, y)) < 0.1f);
      }
    EXPECT_GT(inside, 500);
    EXPECT_LE(wrong, inside / 100) << step.x << ' ' << step.y << ' ' << step.z;
  }
}

// What an option says and nothing heeds is refused.
TEST(ReliefKind, a_deep_image_takes_no_size_and_a_parallel_one_no_depth) {
  std::mt19937 rng(2);
  LayeredDepthImage layers = random_layers(rng, 20, 20);
  for (const Projection projection : {Projection::parallel, Projection::perspective}) {
    layers.camera.projection = projection;
    DeepImageSource source("deep", {layers});
    for (const std::string name : {"size", "max-depth"}) {
      OptionValues values(layered_relief_kind().bake_options);
      EXPECT_TRUE(layered_relief_kind().bake({source, {}}, values, {}).ok());
      ASSERT_TRUE(values.set(name, "64").ok());
      const Result<Baked> baked = layered_relief_kind().bake({source, {}}, values, {});
      ASSERT_EQ(baked.ok(), projection == Projection::perspective && name == "max-depth") << name;
      if (!baked) {
        EXPECT_EQ(baked.error().where, "--" + name);
      }
    }
  }
}

}  // namespace
}  // namespace rilievo
