#include "rilievo/layered_impostor/see_through.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rilievo/layered_impostor/jug_test_helpers.h"
#include "rilievo/layered_impostor/lawn_test_helpers.h"
#include "rilievo/layered_impostor/warp.h"

namespace rilievo {
namespace {

using test_shapes::impostor_of_scene;
using test_shapes::lawn;

TEST(SeeThrough, pictures_along_a_one_sided_lawn_do_those_above_it_do_not) {
  const LayeredImpostor impostor = impostor_of_scene(lawn(false), 96);
  int along = 0;
  for (std::size_t i = 0; i < impostor.pictures.size(); ++i) {
    const double up = impostor.views.directions[i].y;
    if (up > 0.3) {
      EXPECT_TRUE(impostor.complete[i] && !impostor.sees_through[i]) << i;
    }
    if (std::abs(up) > 0.01) continue;
    ++along;
    EXPECT_TRUE(!impostor.complete[i] && impostor.sees_through[i]) << i;
  }
  EXPECT_EQ(along, 8);
}

TEST(SeeThrough, no_picture_does_where_all_surfaces_are_seen_from_both_sides) {
  for (const Scene& scene : {lawn(true), test_shapes::jug()})
    for (int size : {32, 96})
      for (const bool sees : impostor_of_scene(scene, size).sees_through) EXPECT_FALSE(sees);
}

// What has lost its middle is not one-sided: it lacks what it should see from in front.
TEST(SeeThrough, a_picture_that_shows_nothing_does_not) {
  std::vector<DepthImage> pictures =
      test_shapes::cast_views(test_shapes::jug(), make_view_set({}), {.size = 64});
  pictures[5].depth = Image<float>(64, 64, kNoDepth);
  pictures[5].color = ColorImage(64, 64);
  const Result<LayeredImpostor> impostor = make_layered_impostor(pictures, {});
  ASSERT_TRUE(impostor);
  for (const bool sees : impostor->sees_through) EXPECT_FALSE(sees);
}

// Before pictures along the lawn were known to see through it, they outvoted those that see it.
TEST(SeeThrough, a_lawn_has_all_of_its_corners_from_above_and_is_not_there_from_below) {
  const Scene scene = lawn(false);
  const Result<RayScene> rays = RayScene::create(scene);
  const LayeredImpostor impostor = impostor_of_scene(scene, 128);
  const Box bounds = world_bounds(scene);
  std::mt19937 rng(4);
  for (int i = 0; i < 32; ++i) {
    const bool above = i % 4 < 3;
    const glm::dvec3 towards = test_shapes::grazing_direction(rng, above);
    Camera camera = *tight_camera(Projection::perspective,
                                  glm::dvec3(bounds.center()) + 4.0 * bounds.radius() * towards,
                                  {0, 1, 0}, bounds);
    camera.width = camera.height = 96;
    const DepthImage truth = cast_picture(*rays, camera), frame = warp_surfaces(impostor, camera);
    int there = 0, missing = 0, too_many = 0;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        there += truth.covered(x, y);
        missing += truth.covered(x, y) && !frame.covered(x, y);
        too_many += !truth.covered(x, y) && frame.covered(x, y);
      }
    // Along the outline one pixel more or less.
    if (above) {
      EXPECT_GT(there, 500);
      EXPECT_LT(missing, there / 25) << i << ' ' << towards.y;
      EXPECT_LT(too_many, there / 25) << i << ' ' << towards.y;
    } else {
      // A sixtieth of the frame: of the pictures along the rays some look from above.
      EXPECT_LT(too_many, 96 * 96 / 60) << i << ' ' << towards.y;
    }
  }
}

}  // namespace
}  // namespace rilievo
