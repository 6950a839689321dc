#include "bench/relief_objects.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "rilievo/layered_relief/relief_set.h"

namespace rilievo::bench {
namespace {

class PaperObject : public testing::TestWithParam<const char*> {};

// The paper's have 140 000 (fish, cube) and 250 000 (fern). A cube covers between
// 1 / (3 * 1.11^2) (face on) and 1 / (sqrt(3) * 1.11^2) (corner on) of its frame, twice: 141 800
// and 245 700.
TEST_P(PaperObject, has_140000_to_250000_samples_from_every_side) {
  const Result<ReliefObject> object = relief_object(GetParam());
  ASSERT_TRUE(object);
  const Result<std::vector<glm::dvec3>> six = relief_directions(6);
  ASSERT_TRUE(six);
  // `rilievo bench relief-run`, and `rilievo bake` with its larger distance of merging.
  for (const double merge : {0.01, 0.5}) {
    ReliefBakeOptions options;
    options.ball = paper_ball(*object);
    options.merge_texels = merge;
    const Result<ReliefSet> set = bake_reliefs(*object->rays, *six, options);
    ASSERT_TRUE(set) << set.error().message();
    for (const LayeredRelief& relief : set->reliefs) {
      EXPECT_GE(relief.samples(), 140'000u) << merge;
      EXPECT_LE(relief.samples(), 250'000u) << merge;
    }
  }
  // Of the other benches.
  std::vector<glm::dvec3> others{{0.3, 0.35, 1}, {0, 0.26, 0.97}};
  if (paper_ball(*object) > 0) others.emplace_back(1, 1, 1);
  for (const glm::dvec3& direction : others) {
    const auto layers = relief_layers(*object, 512, glm::normalize(direction));
    ASSERT_TRUE(layers) << layers.error().message();
    EXPECT_GE(layers->samples.size(), 140'000u) << direction.y;
    EXPECT_LE(layers->samples.size(), 250'000u) << direction.y;
  }
}

INSTANTIATE_TEST_SUITE_P(Builtin, PaperObject, testing::Values("fern", "fish", "cube"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace rilievo::bench
