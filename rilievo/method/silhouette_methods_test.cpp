// Silhouettes are antialiased, whichever method draws them by software.
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/silhouette_methods_test_helpers.h"

namespace rilievo {
namespace {

class SilhouetteMethods : public testing::TestWithParam<const char*> {};

TEST_P(SilhouetteMethods, pixels_along_a_silhouette_are_mixed) {
  const test_silhouette::SilhouetteFigures figures =
      test_silhouette::silhouettes(GetParam(), [](const Scene& scene) {
        return std::unique_ptr<Backend>(std::make_unique<SoftwareBackend>(scene, 4));
      });
  test_silhouette::expect_mixed(figures);
}

INSTANTIATE_TEST_SUITE_P(All, SilhouetteMethods,
                         testing::Values("direct", "environment-nodes", "layered-impostor",
                                         "layered-relief", "nailboard", "relief-impostor"));

}  // namespace
}  // namespace rilievo
