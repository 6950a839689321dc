#include <gtest/gtest.h>

#include <bit>

#include "rilievo/layered_relief/prewarp.h"
#include "rilievo/layered_relief/prewarp_runs.h"
#include "rilievo/layered_relief/relief_test_helpers.h"
#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

LayeredRelief tiled_relief(std::mt19937& rng, int width, int height, int tile_size = 8) {
  return *build_layered_relief(random_layers(rng, width, height),
                               {.tile_size = tile_size, .merge = 1e-3});
}

TEST(LayeredRelief, its_four_streams_hold_the_same_samples_each_in_its_order) {
  std::mt19937 rng(1);
  for (const int tile_size : {1, 4, 32, 128}) {
    const LayeredRelief relief = tiled_relief(rng, 37, 29, tile_size);
    ASSERT_TRUE(validate(relief));
    for (unsigned order = 0; order < 4; ++order)
      for (std::size_t t = 0; t + 1 < relief.first.size(); ++t) {
        std::vector<std::uint64_t> mine, ascending;
        for (std::uint32_t i = relief.first[t]; i < relief.first[t + 1]; ++i) {
          const ReliefSample& s = relief.streams[order][i];
          mine.push_back(std::bit_cast<std::uint64_t>(s));
          ascending.push_back(std::bit_cast<std::uint64_t>(relief.streams[0][i]));
          if (i == relief.first[t]) continue;
          const ReliefSample& before = relief.streams[order][i - 1];
          const int sign_u = order & kDescendingU ? -1 : 1, sign_v = order & kDescendingV ? -1 : 1;
          const auto key = [&](const ReliefSample& x) {
            return std::tuple(sign_v * int(x.v()), sign_u * int(x.u()), -int(x.code()));
          };
          EXPECT_LE(key(before), key(s));
        }
        std::sort(mine.begin(), mine.end());
        std::sort(ascending.begin(), ascending.end());
        EXPECT_EQ(mine, ascending);
      }
  }
}

TEST(LayeredRelief, sheets_meet_at_the_epipole_and_run_towards_it) {
  std::mt19937 rng(2);
  const LayeredRelief relief = tiled_relief(rng, 20, 10);
  // k3 = 0.1 puts an eye 10 m in front of texel (k1, k2) * 10.
  const auto sheets_at = [&](double u, double v) {
    return sheets_of(relief, {0.1 * u, 0.1 * v, 0.1});
  };
  const std::vector<Sheet> inside = sheets_at(7.2, 4.6);
  ASSERT_EQ(inside.size(), 4u);
  for (const Sheet& sheet : inside) {
    const bool right = sheet.order & kDescendingU, lower = sheet.order & kDescendingV;
    EXPECT_EQ(sheet.u_from, right ? 7 : 0);  // texel 6's centre lies left of 7.2, 7's right
    EXPECT_EQ(sheet.u_to, right ? 20 : 7);
    EXPECT_EQ(sheet.v_from, lower ? 5 : 0);  // 4.5 is above 4.6
    EXPECT_EQ(sheet.v_to, lower ? 10 : 5);
  }
  const std::vector<Sheet> outside = sheets_at(-3, 25);
  ASSERT_EQ(outside.size(), 1u);
  EXPECT_EQ(outside[0].order, unsigned(kDescendingU));
  EXPECT_EQ(sheets_at(5, -1).size(), 2u);
}

TEST(LayeredRelief, runs_draw_what_hides_something_after_it_and_everything_once) {
  std::mt19937 rng(3);
  for (int i = 0; i < 40; ++i) {
    LayeredRelief relief = tiled_relief(rng, 30, 26, i % 2 ? 4 : 16);
    const std::vector<PlacedSample> samples = label_samples(relief);
    const auto warp = relief_warp(relief.frame(), random_eye(rng, relief));
    const glm::dvec2 epipole = warp->epipole();
    std::vector<PrewarpRun> runs;
    find_runs(relief, *warp, sheets_of(relief, *warp),
              {.min = glm::dvec2(-1e9), .max = glm::dvec2(1e9), .half_splat = 0.5}, runs);
    std::vector<std::uint32_t> drawn;
    for (const PrewarpRun& run : runs)
      for (std::uint32_t k = 0; k < run.count; ++k)
        if (const std::uint32_t u = run.samples[k].u();
            run.all_columns || (u >= run.u_from && u < run.u_to))
          drawn.push_back(run.samples[k].color);
    ASSERT_EQ(drawn.size(), samples.size());
    std::vector<std::uint32_t> sorted = drawn;
    std::sort(sorted.begin(), sorted.end());
    for (std::uint32_t k = 0; k < sorted.size(); ++k) ASSERT_EQ(sorted[k], k);

    // Of two samples in one sheet, the one that lies nearer to the epipole in both u and v comes
    // later; in one texel, the nearer one.
    std::vector<std::size_t> rank(samples.size());
    for (std::size_t k = 0; k < drawn.size(); ++k) rank[drawn[k]] = k;
    std::uniform_int_distribution<std::size_t> pick(0, samples.size() - 1);
    for (int pair = 0; pair < 20000; ++pair) {
      const std::size_t a = pick(rng), b = pick(rng);
      const glm::dvec2 to_a = glm::dvec2(samples[a].u + 0.5, samples[a].v + 0.5) - epipole;
      const glm::dvec2 to_b = glm::dvec2(samples[b].u + 0.5, samples[b].v + 0.5) - epipole;
      if (a == b || to_a.x * to_b.x <= 0 || to_a.y * to_b.y <= 0) continue;
      const bool same_texel = to_a == to_b;
      const bool nearer =
          same_texel ? samples[a].code < samples[b].code
                     : std::abs(to_a.x) <= std::abs(to_b.x) && std::abs(to_a.y) <= std::abs(to_b.y);
      if (nearer) {
        ASSERT_GT(rank[a], rank[b]);
      }
    }
  }
}

// One sample near the middle of a tile, on the source plane, seen with slopes t and s along both
// axes: its splat is sqrt(1 + t^2) and sqrt(1 + s^2) times as wide as it would be.
TEST(Prewarp, splats_that_face_the_eye_are_wider_where_the_plane_is_slanted) {
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  constexpr int kTexels = 64, kResolution = 16;
  constexpr double kSplatSize = 1.5;
  for (int i = 0; i < 40; ++i) {
    LayeredDepthImage layers;
    layers.camera = random_parallel_camera(rng, kTexels, kTexels);
    layers.first.push_back(0);
    for (int t = 0; t < kTexels * kTexels; ++t) {
      if (t == 16 * kTexels + 16) layers.samples.push_back({glm::vec4(1), 3.5f, 3.5f});
      layers.first.push_back(layers.samples.size());
    }
    const LayeredRelief relief = *build_layered_relief(layers, {.tile_size = 32});
    const ReliefFrame frame = relief.frame();
    const double height = 1.5;
    const glm::dvec2 slope(2 * unit(rng), 2 * unit(rng)),
        aside = height * slope / glm::dvec2(glm::length(frame.a), glm::length(frame.b));
    const glm::dvec3 eye = frame.world(16 - aside.x, 16 - aside.y, -height);
    const glm::dvec2 stretch = glm::sqrt(1.0 + slope * slope);
    for (const bool faces : {false, true}) {
      Prewarped result;
      ASSERT_TRUE(
          Prewarp(relief,
                  {.splat_size = kSplatSize, .splats_face_eye = faces, .resolution = kResolution})
              .warp(eye, nullptr, result));
      glm::ivec2 low(1 << 20), high(-1);
      for (int y = 0; y < result.height(); ++y)
        for (int x = 0; x < result.width(); ++x)
          if (result.delta[std::size_t(y) * std::size_t(result.width()) + std::size_t(x)] !=
              kEmptyCode)
            low = glm::min(low, {x, y}), high = glm::max(high, {x, y});
      const glm::dvec2 size(high - low + 1),
          expected = kResolution * kSplatSize * (faces ? stretch : glm::dvec2(1));
      // Texels whose centres it holds: one more or less. The slope is that at the tile's middle,
      // half a texel off.
      EXPECT_NEAR(size.x, expected.x, 1.5) << i;
      EXPECT_NEAR(size.y, expected.y, 1.5) << i;
    }
  }
}

// Against the loop for splats of any size.
TEST(Prewarp, splats_of_at_most_two_three_or_four_texels_cover_what_splats_of_any_size_do) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<float> unit(0, 1);
  constexpr int kSide = 40, kPitch = 48, kMissed = kSide * kPitch;
  for (int i = 0; i < 300; ++i) {
    const int most = 2 + i % 3;
    std::vector<ReliefSample> samples(64 + 300);
    for (ReliefSample& sample : samples)
      sample = {std::uint32_t(rng() % 32 | rng() % 32 << 8), std::uint32_t(rng())};
    PrewarpCoefficients k;
    k.scale = 0.5f + unit(rng), k.x_0 = 8 * unit(rng) - 4, k.y_0 = 8 * unit(rng) - 4;
    PrewarpRun run;
    run.samples = samples.data(), run.count = 1 + rng() % 300;
    run.u = 20 * unit(rng) - 10, run.v = 20 * unit(rng) - 10;
    run.half_x = 0.499f * float(most) / k.scale * unit(rng);
    run.half_y = 0.499f * float(most) / k.scale * unit(rng);
    run.u_from = 3, run.u_to = 30, run.all_columns = i % 2;
    const auto drawn = [&](SplatReach reach) {
      run.reach = reach;
      std::vector<ReliefSample> texels(kMissed + 1, ReliefSample{~0u, ~0u});
      const std::size_t count =
          prewarp_tile(k, {&run, 1}, {texels.data(), kMissed, 0, 0, kSide, kSide, kPitch});
      texels.pop_back();  // what misses
      return std::pair(texels, count);
    };
    const auto any = drawn(SplatReach::many);
    for_each_instruction_set(
        [&](const char* set) { EXPECT_EQ(drawn(SplatReach::few), any) << set; });
  }
}

// Its memory was used for pictures of other sizes.
TEST(Prewarp, what_was_warped_before_leaves_no_trace) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const Splat splat : {Splat::nearest, Splat::rectangle}) {
    const LayeredRelief relief = tiled_relief(rng, 60, 50);
    const PrewarpOptions options{.splat = splat, .tile_size = 32};
    Prewarp used(relief, options);
    for (int i = 0; i < 40; ++i) {
      const glm::dvec3 eye = random_eye(rng, relief);
      const glm::dvec3 target = relief.frame().world(30 + 40 * unit(rng), 25 + 40 * unit(rng), 0);
      const Camera view = look_at(eye, target, {0, 1, 0}, 0.8, 64, 48, 0.01, 100);
      Prewarped expected, got;
      ASSERT_TRUE(Prewarp(relief, options).warp(eye, i % 2 ? &view : nullptr, expected));
      ASSERT_TRUE(used.warp(eye, i % 2 ? &view : nullptr, got));
      ASSERT_EQ(expected.color, got.color);
      ASSERT_EQ(expected.delta, got.delta);
    }
  }
}

TEST(Prewarp, what_is_in_view_is_the_same_whether_the_rest_is_clipped_or_not) {
  std::mt19937 rng(6);
  std::uniform_real_distribution<double> unit(-1, 1);
  int clipped = 0;
  for (int i = 0; i < 40; ++i) {
    LayeredRelief relief = tiled_relief(rng, 60, 50);
    label_samples(relief);
    const glm::dvec3 eye = random_eye(rng, relief);
    const glm::dvec3 target = relief.frame().world(30 + 40 * unit(rng), 25 + 40 * unit(rng), 0);
    const Camera view = look_at(eye, target, {0, 1, 0}, 0.4, 64, 48, 0.01, 100);
    Prewarped whole, part;
    Prewarp prewarp(relief, {.tile_size = 16});
    const auto all = prewarp.warp(eye, nullptr, whole);
    const auto some = prewarp.warp(eye, &view, part);
    ASSERT_TRUE(all && some);
    clipped += some->tiles < all->tiles;
    const glm::ivec2 from = grid_origin(relief, whole, all->resolution);
    const glm::ivec2 shift =
        some->tiles == 0 ? glm::ivec2(0) : grid_origin(relief, part, some->resolution) - from;
    for (int y = 0; y < whole.height(); ++y)
      for (int x = 0; x < whole.width(); ++x) {
        const glm::dvec2 at = (glm::dvec2(from) + glm::dvec2(x, y) + 0.5) / all->resolution;
        const glm::dvec3 seen = raster_from_world(view, relief.frame().world(at.x, at.y, 0));
        if (!(seen.z > 0 && seen.x > 0 && seen.y > 0 && seen.x < 64 && seen.y < 48)) continue;
        const glm::ivec2 in_part = glm::ivec2(x, y) - shift;
        ASSERT_TRUE(some->tiles > 0 && in_part.x >= 0 && in_part.y >= 0 &&
                    in_part.x < part.width() && in_part.y < part.height());
        const auto index = [](const Prewarped& p, int u, int v) {
          return std::size_t(v) * std::size_t(p.width()) + std::size_t(u);
        };
        ASSERT_EQ(whole.color[index(whole, x, y)], part.color[index(part, in_part.x, in_part.y)]);
        ASSERT_EQ(whole.delta[index(whole, x, y)], part.delta[index(part, in_part.x, in_part.y)]);
      }
  }
  EXPECT_GT(clipped, 10);
}

}  // namespace
}  // namespace rilievo
