// What is drawn of layered reliefs, against the objects themselves.

#include <gtest/gtest.h>

#include <bit>
#include <string>

#include "rilievo/capture/deep_image_source.h"
#include "rilievo/layered_relief/merge_layers.h"
#include "rilievo/layered_relief/relief_error.h"
#include "rilievo/layered_relief/relief_kind.h"
#include "rilievo/layered_relief/relief_set.h"
#include "rilievo/layered_relief/relief_test_helpers.h"
#include "rilievo/layered_relief/resample_layers.h"
#include "rilievo/layered_relief/splat_layers.h"
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

TEST(ResampleLayers, samples_stay_where_their_surfaces_were_seen) {
  const Result<BuiltinScene> built = make_builtin("builtin:fish?triangles=5000");
  ASSERT_TRUE(built);
  const Result<RayScene> rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  const Camera camera = look_at({0.5, 0.4, 3}, {0, 0, 0}, {0, 1, 0}, 0.8, 120, 90, 1, 10);
  const LayeredDepthImage given = cast_layers(*rays, camera);
  const Result<ResampledLayers> resampled = resample_layers(given, {.size = 128});
  ASSERT_TRUE(resampled);
  const LayeredDepthImage& layers = resampled->layers;
  ASSERT_TRUE(validate(layers));
  EXPECT_EQ(std::max(layers.camera.width, layers.camera.height), 128);
  EXPECT_GE(layers.samples.size(), given.samples.size() / 2);
  for (int y = 0; y < layers.camera.height; ++y)
    for (int x = 0; x < layers.camera.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(layers.camera.width) + std::size_t(x);
      for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s) {
        // Put back, it lies within the error of a given line of sight with that depth.
        const LayerSample& sample = layers.samples[s];
        const glm::dvec3 world =
            world_from_raster(layers.camera, {x + 0.5, y + 0.5}, double(sample.depth));
        double nearest = 1e300;
        const glm::dvec3 at = raster_from_world(camera, world);
        for (int v = int(at.y) - 2; v <= int(at.y) + 2; ++v)
          for (int u = int(at.x) - 2; u <= int(at.x) + 2; ++u) {
            if (u < 0 || v < 0 || u >= 120 || v >= 90) continue;
            const std::size_t k = std::size_t(v) * 120 + std::size_t(u);
            for (std::uint64_t g = given.first[k]; g < given.first[k + 1]; ++g)
              if (given.samples[g].depth == sample.depth)
                nearest = std::min(
                    nearest, glm::distance(world, world_from_raster(camera, {u + 0.5, v + 0.5},
                                                                    double(sample.depth))));
          }
        ASSERT_LE(nearest, resampled->error * (1 + 1e-6));
      }
    }
  LayeredDepthImage empty = given;
  empty.samples.clear();
  std::fill(empty.first.begin(), empty.first.end(), 0);
  EXPECT_FALSE(resample_layers(empty));
  EXPECT_TRUE(resample_layers(given, {.size = 128, .max_samples = layers.samples.size()}));
  const auto refused =
      resample_layers(given, {.size = 128, .max_samples = layers.samples.size() - 1});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().reason.find("--size"), std::string::npos);
}

// What an option says and nothing heeds is refused.
TEST(ReliefKind, a_parallel_deep_image_takes_neither_a_size_nor_a_depth) {
  std::mt19937 rng(2);
  LayeredDepthImage layers = random_layers(rng, 20, 20);
  for (const Projection projection : {Projection::parallel, Projection::perspective}) {
    layers.camera.projection = projection;
    DeepImageSource source("deep", {layers});
    for (const char* name : {"size", "max-depth"}) {
      OptionValues values(layered_relief_kind().bake_options);
      EXPECT_TRUE(layered_relief_kind().bake({source, {}}, values, {}).ok());
      ASSERT_TRUE(values.set(name, "64").ok());
      const Result<Baked> baked = layered_relief_kind().bake({source, {}}, values, {});
      ASSERT_EQ(baked.ok(), projection == Projection::perspective) << name;
      if (!baked) {
        EXPECT_EQ(baked.error().where, std::string("--") + name);
      }
    }
  }
}

}  // namespace
}  // namespace rilievo
