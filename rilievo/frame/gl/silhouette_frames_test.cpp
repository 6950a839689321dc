// Silhouettes are antialiased, whichever method draws them by OpenGL.
#include <memory>

#include "rilievo/frame/gl/opengl_backend.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/method/silhouette_methods_test_helpers.h"

namespace rilievo {
namespace {

class SilhouetteFrames : public gl::ContextTest, public testing::WithParamInterface<const char*> {};

TEST_P(SilhouetteFrames, pixels_along_a_silhouette_are_mixed) {
  const test_silhouette::SilhouetteFigures figures =
      test_silhouette::silhouettes(GetParam(), [](const Scene& scene) {
        auto made = OpenGLBackend::create(scene, 4);
        EXPECT_TRUE(made.ok());
        return std::unique_ptr<Backend>(std::move(*made));
      });
  test_silhouette::expect_mixed(figures);
}

INSTANTIATE_TEST_SUITE_P(All, SilhouetteFrames,
                         testing::Values("direct", "environment-nodes", "layered-impostor",
                                         "layered-relief", "nailboard", "relief-impostor"));

}  // namespace
}  // namespace rilievo
