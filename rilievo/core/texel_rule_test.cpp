#include "rilievo/core/texel_rule.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <optional>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/random.h"

namespace rilievo {
namespace {

constexpr glm::vec2 kPlaces[] = {
    {-0.125f, -0.375f}, {0.375f, -0.125f}, {-0.375f, 0.125f}, {0.125f, 0.375f}};

// What a ray through a raster position meets.
struct Met {
  double eye_z;
  std::uint32_t object;
};
using Scenery = std::function<std::optional<Met>(const glm::dvec2& raster)>;

Camera square_camera(int size) {
  return look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.5708, size, size, 0.1, 100);
}

TexelSamples seen(const Camera& camera, const Scenery& scenery) {
  TexelSamples texels(camera, kPlaces);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec2 center(x + 0.5, y + 0.5);
      if (const auto met = scenery(center)) {
        texels.center(x, y) = texels.nearness.of_eye_z(met->eye_z);
        texels.center_object(x, y) = met->object;
      }
      for (std::size_t s = 0; s < 4; ++s)
        if (const auto met = scenery(center + glm::dvec2(kPlaces[s]))) {
          texels.sample[texels.first(x, y) + s] = texels.nearness.of_eye_z(met->eye_z);
          texels.sample_object[texels.first(x, y) + s] = met->object;
        }
    }
  return texels;
}

// Planes through points in front of the camera: eye_z of a normal and a distance.
double plane_eye_z(const Camera& camera, const glm::dvec2& raster, const glm::dvec3& normal,
                   double distance) {
  const glm::dvec3 ray = world_from_raster(camera, raster, 1.0);
  return distance / glm::dot(normal, ray);
}

TEST(TexelRule, a_plane_is_one_surface_up_to_its_horizon) {
  const Camera camera = square_camera(64);
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    // The ground, under an eye that rolls.
    const double roll = double(random.between(0, 6.28f));
    const glm::dvec3 normal(std::sin(roll), std::cos(roll), double(random.between(-0.3f, 0.3f)));
    int all = 0, covered = 0;
    const TexelSamples texels = seen(camera, [&](const glm::dvec2& at) -> std::optional<Met> {
      const double z = plane_eye_z(camera, at, normal, 1.0);
      if (!(z > 0) || z > 90) return std::nullopt;
      return Met{z, 1};
    });
    const ShownSamples shown = choose_samples(texels);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        if (texels.center(x, y) == kNoNearness) continue;
        ++covered;
        unsigned there = 0;
        for (std::size_t s = 0; s < 4; ++s)
          there |= unsigned(texels.sample[texels.first(x, y) + s] != kNoNearness) << s;
        all += shown.mask(x, y) == there;
      }
    EXPECT_GT(covered, 500);
    // At the end of a row of texels that grows by one, there is no second step to tell the slope
    // by.
    EXPECT_GE(all, covered - 2);
    EXPECT_LE(shown.thin.size(), 2u);
  }
}

// A half plane before a plane.
TEST(TexelRule, what_is_in_front_does_not_count_behind_an_edge) {
  const Camera camera = square_camera(48);
  Random random(2);
  int mixed = 0;
  for (int round = 0; round < 30; ++round) {
    const double turn = double(random.between(0, 6.28f)), at = double(random.between(-10, 10));
    const std::uint32_t behind = round % 2 ? 1 : 2;  // of one object, or of two
    const auto front = [&](const glm::dvec2& p) {
      return (p.x - 24) * std::cos(turn) + (p.y - 24) * std::sin(turn) < at;
    };
    const Scenery scenery = [&](const glm::dvec2& p) -> std::optional<Met> {
      if (front(p)) return Met{2.0, 1};
      return Met{plane_eye_z(camera, p, {0.3, 0.2, -1}, 4.0), behind};
    };
    const TexelSamples texels = seen(camera, scenery);
    const ShownSamples shown = choose_samples(texels);
    EXPECT_TRUE(shown.thin.empty());
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 48; ++x) {
        const glm::dvec2 center(x + 0.5, y + 0.5);
        unsigned same = 0;
        for (std::size_t s = 0; s < 4; ++s)
          same |= unsigned(front(center) || !front(center + glm::dvec2(kPlaces[s]))) << s;
        if (shown.mask(x, y) == 0) continue;  // only the centre
        ASSERT_EQ(shown.mask(x, y), same) << round << ' ' << x << ' ' << y;
        mixed += same != 15;
      }
  }
  EXPECT_GT(mixed, 500);
}

// A cable of half a texel's width in any direction, before a wall or before nothing.
TEST(TexelRule, a_cable_of_half_a_texel_is_a_chain_without_a_gap) {
  constexpr int kSize = 64;
  const Camera camera = square_camera(kSize);
  Random random(3);
  for (int round = 0; round < 60; ++round) {
    const double turn = double(random.between(0, 6.28f)), at = double(random.between(-4, 4));
    const glm::dvec2 across(std::cos(turn), std::sin(turn));
    const bool wall = round % 2;
    const TexelSamples texels = seen(camera, [&](const glm::dvec2& p) -> std::optional<Met> {
      if (std::abs(glm::dot(p - 32.0, across) - at) < 0.25) return Met{2 + 0.01 * p.x, 1};
      if (wall) return Met{4.0, 1};
      return std::nullopt;
    });
    const ShownSamples shown = choose_samples(texels);
    Image<std::uint8_t> cable(kSize, kSize);
    int count = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        cable(x, y) = texels.center(x, y) > texels.nearness.of_eye_z(3);
      }
    for (const ThinTexel& thin : shown.thin) {
      EXPECT_EQ(thin.object, 1u);
      EXPECT_GT(thin.nearness, texels.nearness.of_eye_z(3));
      EXPECT_NE(shown.mask(thin.x, thin.y), 0);
      cable(thin.x, thin.y) = 1;
    }
    for (const std::uint8_t texel : cable.texels()) count += texel;
    // Along it, every row or column that it crosses more steeply has a texel of it, the next one
    // beside or at a corner of that of the row before.
    const bool by_rows = std::abs(across.x) > std::abs(across.y);
    int last = -1;
    for (int i = 2; i < kSize - 2; ++i) {
      // Where is it in this row?
      const double middle = by_rows ? 32 + (at - across.y * (i + 0.5 - 32)) / across.x
                                    : 32 + (at - across.x * (i + 0.5 - 32)) / across.y;
      if (middle < 3 || middle > kSize - 3) {
        last = -1;
        continue;
      }
      int found = -1;
      for (int k = int(middle) - 1; k <= int(middle) + 1; ++k)
        if (by_rows ? cable(k, i) : cable(i, k)) {
          if (found < 0 || std::abs(k + 0.5 - middle) < std::abs(found + 0.5 - middle)) found = k;
        }
      EXPECT_GE(found, 0) << "a gap at " << i << " of round " << round << ", turned by " << turn;
      if (last >= 0 && found >= 0) {
        EXPECT_LE(std::abs(found - last), 1) << round << ' ' << i;
      }
      last = found;
    }
    // Not much thicker than a texel.
    EXPECT_LT(count, 1.7 * kSize);
  }
}

// A blade that narrows to a blunt end of half a texel, before a wall or before nothing. How far
// from its end is the nearest texel that shows it?
TEST(TexelRule, a_tip_of_half_a_texel_is_not_cut_off) {
  constexpr int kSize = 40, kRounds = 400;
  const Camera camera = square_camera(kSize);
  Random random(8);
  double sum = 0;
  int cut = 0;
  for (int round = 0; round < kRounds; ++round) {
    const double turn = double(random.between(0, 6.28f));
    const glm::dvec2 onwards(std::cos(turn), std::sin(turn)), across(-onwards.y, onwards.x);
    const glm::dvec2 end(double(random.between(19, 21)), double(random.between(19, 21)));
    const double slope = double(random.between(0.02f, 0.15f));  // of half of the width
    const auto in_blade = [&](const glm::dvec2& p) {
      const double before_end = glm::dot(end - p, onwards);
      return before_end >= 0 && before_end < 12 &&
             std::abs(glm::dot(p - end, across)) < 0.25 + slope * before_end;
    };
    const TexelSamples texels = seen(camera, [&](const glm::dvec2& p) -> std::optional<Met> {
      if (in_blade(p)) return Met{2.0, 1};
      return round % 2 ? std::optional(Met{4.0, 1}) : std::nullopt;
    });
    Image<std::uint8_t> blade(kSize, kSize);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) blade(x, y) = in_blade({x + 0.5, y + 0.5});
    for (const ThinTexel& thin : choose_samples(texels).thin) {
      const glm::dvec2 center(thin.x + 0.5, thin.y + 0.5);
      int samples = 0;
      for (const glm::vec2& place : kPlaces) samples += in_blade(center + glm::dvec2(place));
      // The end is not drawn out.
      EXPECT_GE(samples, glm::dot(center - end, onwards) > 0 ? 2 : 1) << round;
      blade(thin.x, thin.y) = 1;
    }
    double lost = 1e300;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        if (blade(x, y)) {
          const glm::dvec2 nearest = glm::clamp(end, glm::dvec2(x, y), glm::dvec2(x + 1, y + 1));
          lost = std::min(lost, glm::distance(end, nearest));
        }
    sum += lost, cut += lost > 1;
  }
  RecordProperty("mean_lost", std::to_string(sum / kRounds));
  RecordProperty("cut", cut);
  // In texels: 0.44, and 69 of them, as long as no texel at an end counted as thin. What is left
  // are slanted tips, beside which a texel's centre shows the blade.
  EXPECT_LT(sum / kRounds, 0.3);
  EXPECT_LE(cut, 28);
}

// What becomes shorter, as a needle seen from ever farther away, shows whole or not at all: no dots
// with a gap between them.
TEST(TexelRule, a_short_piece_shows_whole_or_not_at_all) {
  constexpr int kSize = 16;
  const Camera camera = square_camera(kSize);
  Random random(9);
  int shown = 0;
  for (int round = 0; round < 400; ++round) {
    // Upright or lying, beside the texels' centres, in which half of the samples may be.
    const bool lies = round % 2, wall = round % 4 < 2;
    const double begin = 5 + double(random.between(0, 0.2f)),
                 end = 5 + round % 5 + 1 + double(random.between(0.8f, 1)) - 1,
                 left = 7.51 + double(random.between(0, 0.02f));
    const auto in_piece = [&](const glm::dvec2& p) {
      const double along = lies ? p.x : p.y, across = lies ? p.y : p.x;
      return along >= begin && along < end && across >= left && across < left + 0.5;
    };
    const TexelSamples texels = seen(camera, [&](const glm::dvec2& p) -> std::optional<Met> {
      if (in_piece(p)) return Met{2.0, 1};
      return wall ? std::optional(Met{4.0, 1}) : std::nullopt;
    });
    std::vector<int> along;
    for (const ThinTexel& thin : choose_samples(texels).thin)
      along.push_back(lies ? thin.x : thin.y);
    std::sort(along.begin(), along.end());
    for (std::size_t i = 1; i < along.size(); ++i) EXPECT_EQ(along[i], along[i - 1] + 1) << round;
    shown += !along.empty();
  }
  EXPECT_GT(shown, 40);
}

// An edge is not thin, whatever its direction, nor is a corner.
TEST(TexelRule, what_is_wide_does_not_grow) {
  const Camera camera = square_camera(64);
  Random random(4);
  for (int round = 0; round < 60; ++round) {
    const double turn = double(random.between(0, 6.28f));
    const glm::dvec2 u(std::cos(turn), std::sin(turn)), v(-u.y, u.x);
    const glm::dvec2 at(double(random.between(25, 39)), double(random.between(25, 39)));
    const double width = double(random.between(3, 12)), height = double(random.between(3, 12));
    const TexelSamples texels = seen(camera, [&](const glm::dvec2& p) -> std::optional<Met> {
      const glm::dvec2 from = p - at;
      if (std::abs(glm::dot(from, u)) < width && std::abs(glm::dot(from, v)) < height)
        return Met{2.0, 1};
      return round % 2 ? std::optional(Met{4.0, 1}) : std::nullopt;
    });
    // At each corner a texel may be all that is left between two edges.
    EXPECT_LE(choose_samples(texels).thin.size(), 4u) << round;
  }
}

// Nor is the border of water that is seen at a grazing angle, with its waves.
TEST(TexelRule, what_is_steep_does_not_grow) {
  const Camera camera = square_camera(64);
  Random random(6);
  std::size_t grown = 0, border = 0;
  for (int round = 0; round < 40; ++round) {
    const double turn = double(random.between(0, 6.28f)), slope = double(random.between(2, 12));
    const glm::dvec2 u(std::cos(turn), std::sin(turn)), v(-u.y, u.x);
    const TexelSamples texels = seen(camera, [&](const glm::dvec2& p) -> std::optional<Met> {
      const glm::dvec2 from(glm::dot(p - 32.0, u), glm::dot(p - 32.0, v));
      if (std::abs(from.x) > 14 || std::abs(from.y) > 20) return std::nullopt;
      // 2 / 64 is a texel's width at a metre.
      const double steep = slope * (from.x + 0.3 * std::sin(from.x) * std::cos(0.7 * from.y));
      return Met{4 + 4 * 2 / 64.0 * 0.2 * steep, 1};
    });
    grown += choose_samples(texels).thin.size();
    border += 2 * (28 + 40);
  }
  EXPECT_LT(grown, border / 50);
}

TEST(TexelRule, what_only_the_centre_meets_has_no_sample) {
  const Camera camera = square_camera(8);
  const TexelSamples texels = seen(camera, [](const glm::dvec2& p) -> std::optional<Met> {
    if (glm::length(p - glm::dvec2(4.5)) < 0.1) return Met{2.0, 1};
    return std::nullopt;
  });
  const ShownSamples shown = choose_samples(texels);
  EXPECT_EQ(shown.mask(4, 4), 0);
  EXPECT_TRUE(shown.thin.empty());
}

TEST(Nearness, is_affine_in_window_z_and_comes_back) {
  Random random(5);
  for (const Projection projection :
       {Projection::perspective, Projection::back_perspective, Projection::parallel}) {
    Camera camera = square_camera(16);
    camera.projection = projection;
    const Nearness nearness(camera);
    for (int i = 0; i < 100; ++i) {
      const double z = double(random.between(0.1f, 100));
      const float by_eye_z = nearness.of_eye_z(z);
      EXPECT_NEAR(nearness.eye_z(by_eye_z), z, 1e-6 * z);  // a float
      const double window_z = depth_from_eye_z(DepthKind::window_z, z, camera, {});
      EXPECT_NEAR(nearness.of_window_z(float(window_z)), by_eye_z, nearness.noise);
    }
    EXPECT_EQ(nearness.of_eye_z(double(kNoDepth)), kNoNearness);
  }
}

}  // namespace
}  // namespace rilievo
