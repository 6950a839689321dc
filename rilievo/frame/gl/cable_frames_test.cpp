// A cable of half a texel stays in one piece, whichever method draws it by OpenGL.
#include <memory>
#include <string>

#include "rilievo/frame/gl/opengl_backend.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/method/cable_methods_test_helpers.h"

namespace rilievo {
namespace {

class CableFrames : public gl::ContextTest, public testing::WithParamInterface<const char*> {};

TEST_P(CableFrames, no_gap_along_a_cable_of_half_a_texel_is_wider_than_a_pixel) {
  const double gap = test_cable::widest_gap_px(GetParam(), [](const Scene& scene) {
    auto made = OpenGLBackend::create(scene, 4);
    EXPECT_TRUE(made.ok());
    return std::unique_ptr<Backend>(std::move(*made));
  });
  RecordProperty("widest_gap_px", std::to_string(gap));
  EXPECT_LE(gap, test_cable::kMostGapPx);
}

INSTANTIATE_TEST_SUITE_P(All, CableFrames,
                         testing::Values("direct", "environment-nodes", "layered-impostor",
                                         "layered-relief", "nailboard", "relief-impostor"));

}  // namespace
}  // namespace rilievo
