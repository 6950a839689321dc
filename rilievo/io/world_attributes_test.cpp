#include "rilievo/io/world_attributes.h"

#include <gtest/gtest.h>

#include <random>

namespace rilievo {
namespace {

TEST(WorldAttributes, come_back_exactly) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(-1e7, 1e7);
  for (int i = 0; i < 300; ++i) {
    WorldSpace world{{u(rng), u(rng), u(rng)}, UpAxis(i % 3), i % 2 ? 1.0 : 0.0254};
    if (i % 5 == 0) world.origin = glm::dvec3(0);
    Attributes file;
    store_world(world, file);
    const Result<WorldSpace> read = world_from(file);
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(*read, world);
  }
  Attributes nothing;
  store_world({}, nothing);
  EXPECT_TRUE(nothing.empty());
}

TEST(WorldAttributes, what_is_broken_is_refused) {
  for (const char* text :
       {"", "1 2 3", "1 2 3 up", "1 2 x up y unit 1", "1 2 inf up y unit 1", "1 2 1e13 up y unit 1",
        "1 2 3 up w unit 1", "1 2 3 up xy unit 1", "1 2 3 up y unit 0", "1 2 3 up y unit -1",
        "1 2 3 up y unit nan", "1 2 3 up y unit 1 more", "1 2 3 down y unit 1"})
    EXPECT_FALSE(world_from({{"world", text}}).ok()) << text;
}

}  // namespace
}  // namespace rilievo
