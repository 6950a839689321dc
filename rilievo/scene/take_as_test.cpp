#include "rilievo/scene/take_as.h"

#include <gtest/gtest.h>

#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// Bounds of a few metres round to 1e-6; the teapots' extend over 20.
constexpr double kRounding = 2e-5;

TEST(TakeAs, up_points_up_and_hands_stay_right) {
  EXPECT_EQ(upright_from(UpAxis::z) * glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0));
  EXPECT_EQ(upright_from(UpAxis::z) * glm::dvec3(1, 2, 3), glm::dvec3(1, 3, -2));
  EXPECT_EQ(upright_from(UpAxis::x) * glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0));
  EXPECT_EQ(upright_from(UpAxis::x) * glm::dvec3(1, 2, 3), glm::dvec3(-2, 1, 3));
  for (const UpAxis up : {UpAxis::x, UpAxis::y, UpAxis::z})
    EXPECT_EQ(glm::determinant(upright_from(up)), 1);
}

TEST(TakeAs, a_scene_in_metres_with_y_up_stays_as_it_is) {
  Result<BuiltinScene> made = make_builtin("builtin:teapots?triangles=20000");
  ASSERT_TRUE(made.ok());
  const std::size_t nodes = made->scene.nodes.size();
  take_as(made->scene, UpAxis::y, 1);
  EXPECT_EQ(made->scene.nodes.size(), nodes);
  EXPECT_EQ(made->scene.world, WorldSpace{});
}

// The teapots have standing and moving objects: every one is, at every time, where the map takes
// it.
TEST(TakeAs, every_object_is_turned_and_scaled_about_the_worlds_origin) {
  const Result<BuiltinScene> made = make_builtin("builtin:teapots?triangles=20000");
  ASSERT_TRUE(made.ok());
  for (const UpAxis up : {UpAxis::x, UpAxis::z}) {
    Scene scene = made->scene;
    scene.world.origin = {100, 200, 300};
    scene.cameras.push_back({});
    scene.lights = {{Light::Kind::point, {1, 2, 3}}};
    const double scale = 0.0254;
    const glm::dmat3 linear = scale * upright_from(up);
    take_as(scene, up, scale);
    EXPECT_EQ(validate(scene).ok(), true);
    EXPECT_EQ(scene.world.up, up);
    EXPECT_EQ(scene.world.metres_per_unit, scale);
    EXPECT_LT(glm::distance(scene.world.origin, linear * glm::dvec3(100, 200, 300)), 1e-12);
    EXPECT_LT(glm::distance(glm::dvec3(scene.lights[0].position), linear * glm::dvec3(1, 2, 3)),
              1e-7);
    for (double time = 0; time < 2; time += 0.3) {
      std::vector<glm::mat4> before, after;
      pose(made->scene, time, before);
      pose(scene, time, after);
      ASSERT_EQ(before.size(), after.size());
      for (std::size_t i = 0; i < before.size(); ++i)
        for (const glm::vec4& p : {glm::vec4(0, 0, 0, 1), glm::vec4(1, 2, 3, 1)})
          EXPECT_LT(glm::distance(glm::dvec3(after[i] * p), linear * glm::dvec3(before[i] * p)),
                    kRounding);
    }
  }
}

}  // namespace
}  // namespace rilievo
