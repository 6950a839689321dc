// A cable of half a texel stays in one piece, whichever method draws it by software.
#include <string>

#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/cable_methods_test_helpers.h"

namespace rilievo {
namespace {

class CableMethods : public testing::TestWithParam<const char*> {};

TEST_P(CableMethods, no_gap_along_a_cable_of_half_a_texel_is_wider_than_a_pixel) {
  const double gap = test_cable::widest_gap_px(GetParam(), [](const Scene& scene) {
    return std::unique_ptr<Backend>(std::make_unique<SoftwareBackend>(scene, 4));
  });
  RecordProperty("widest_gap_px", std::to_string(gap));
  EXPECT_LE(gap, test_cable::kMostGapPx);
}

INSTANTIATE_TEST_SUITE_P(All, CableMethods,
                         testing::Values("direct", "environment-nodes", "layered-impostor",
                                         "layered-relief", "nailboard", "relief-impostor"));

}  // namespace
}  // namespace rilievo
