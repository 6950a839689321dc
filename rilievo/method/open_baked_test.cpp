// A file that is opened and drawn says the bound of its error in each frame.
#include "rilievo/method/open_baked.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/method.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/representation/kinds.h"
#include "rilievo/representation/load_representation.h"

namespace rilievo {
namespace {

constexpr int kBakedWidth = 96, kBakedHeight = 72;

Scene ball_and_box() {
  Scene scene;
  test_shapes::add(scene, test_shapes::sphere(0.6), {0.8f, 0.5f, 0.2f});
  test_shapes::add(scene, test_shapes::box(glm::vec3(0.4f)), {0.2f, 0.5f, 0.9f},
                   glm::translate(glm::mat4(1), glm::vec3(1.1f, -0.2f, 0.1f)));
  finish(scene);
  return scene;
}

// Bakes `scene` as `kind` into `file`; nodes see it from the origin.
void bake(const Scene& scene, const Kind& kind, const std::filesystem::path& file) {
  SoftwareBackend backend(scene, 1);
  Result<std::unique_ptr<CaptureSource>> source = backend.make_capture_source();
  ASSERT_TRUE(source.ok());
  OptionValues options(kind.bake_options);
  for (const auto& [option, value] : {std::pair{"views", "12"},
                                      {"size", "64"},
                                      {"textures", "6"},
                                      {"face", "64"},
                                      {"at", "0,0,2.5"}})
    if (find_option(kind.bake_options, option)) {
      ASSERT_TRUE(options.set(option, value).ok());
    }
  Result<Baked> baked = kind.bake({**source, {}}, options, {});
  ASSERT_TRUE(baked.ok()) << baked.error().message();
  ASSERT_TRUE(kind.save(*baked->representation, file).ok());
}

// The definition: the bound of a drawable of the file's content that nothing else uses.
double bound_of_file(const std::filesystem::path& file, const Camera& camera) {
  Result<LoadedRepresentation> loaded = load_representation(file);
  EXPECT_TRUE(loaded.ok());
  const Scene nothing;
  SoftwareBackend backend(nothing, 1);
  Result<std::unique_ptr<DrawableFactory>> factory =
      make_factory(backend.drawables(), loaded->kind->name);
  EXPECT_TRUE(factory.ok());
  Result<std::unique_ptr<Drawable>> drawable = (*factory)->make_drawable(
      std::move(loaded->representation), OptionValues(loaded->kind->draw_options));
  EXPECT_TRUE(drawable.ok());
  return (*drawable)->error_model(0).bound_px(glm::dmat4(1), camera);
}

class OpenBaked : public ::testing::TestWithParam<const char*> {};

TEST_P(OpenBaked, frames_have_the_bound_of_the_file_or_none) {
  const Kind& kind = *find_kind(kinds(), GetParam());
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "baked.exr";
  bake(ball_and_box(), kind, file);
  const Scene nothing;
  SoftwareBackend backend(nothing, 1);
  Result<BakedFrames> baked = open_baked(file, backend);
  ASSERT_TRUE(baked.ok()) << baked.error().message();
  EXPECT_FALSE(baked->frames->stats().bound_px);  // nothing is drawn yet
  int bounded = 0, unbounded = 0;
  for (const double away : {0.0, 0.3, 2.6, 4.0, 9.0}) {
    const Camera camera = look_at({0.1 * away, 0.05, away}, {0.5, 0, -5}, {0, 1, 0}, 0.8,
                                  kBakedWidth, kBakedHeight, 0.05, 50);
    ASSERT_TRUE(baked->frames->draw(camera, 0).ok());
    const double truth = bound_of_file(file, camera);
    const std::optional<double> said = baked->frames->stats().bound_px;
    EXPECT_EQ(said.has_value(), std::isfinite(truth)) << away;
    if (!said) {
      ++unbounded;
      continue;
    }
    EXPECT_EQ(*said, truth) << away;
    EXPECT_GT(*said, 0) << away;
    ++bounded;
  }
  EXPECT_GE(bounded, 2);
  if (kind.stands_for != StandsFor::surroundings) {
    EXPECT_GE(unbounded, 1);  // from within
  }
}

INSTANTIATE_TEST_SUITE_P(All, OpenBaked,
                         ::testing::Values("layered-impostor", "environment-nodes",
                                           "layered-relief"),
                         [](const auto& info) {
                           std::string name = info.param;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

TEST(Bounds, are_absent_where_a_method_has_none_and_nothing_where_frames_are_exact) {
  const Scene scene = ball_and_box();
  const Camera camera =
      look_at({0, 0.4, 5}, {0, 0, 0}, {0, 1, 0}, 0.6, kBakedWidth, kBakedHeight, 0.1, 50);
  for (const auto& [name, bound_px] : {std::pair<const char*, std::optional<double>>{"direct", 0.0},
                                       {"direct-raster", 0.0},
                                       {"direct-rays", 0.0},
                                       {"nailboard", std::nullopt}}) {
    SCOPED_TRACE(name);
    SoftwareBackend backend(scene, 1);
    Result<Method> method = make_method(name, {}, backend);
    ASSERT_TRUE(method.ok()) << method.error().message();
    ASSERT_TRUE(method->frames->draw(camera, 0).ok());
    EXPECT_EQ(method->frames->stats().bound_px, bound_px);
  }
}

}  // namespace
}  // namespace rilievo
