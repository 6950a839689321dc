// Levels of detail of `auto` are those of the method lod, with a share of the error.
#include "rilievo/method/auto_levels.h"

#include <gtest/gtest.h>

#include <numeric>

#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/method.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class AutoLevelsTest : public ::testing::Test {
 protected:
  static constexpr double kErrorPx = 8;

  void SetUp() override {
    auto built = make_builtin("builtin:teapots?triangles=60000");
    ASSERT_TRUE(built.ok());
    scene_ = std::move(built->scene);
    shown_.camera = shown_.before = camera_at(built->path, 0, 320, 180);
    backend_ = std::make_unique<SoftwareBackend>(scene_, 4);
    levels_ = prepare_levels(*backend_, scene_, 320 * 180, kErrorPx);
    ASSERT_NE(levels_.frames, nullptr);
    shown_.in_view.resize(scene_.objects.size());
    std::iota(shown_.in_view.begin(), shown_.in_view.end(), 0);
  }
  Rgba8Image drawn() {
    EXPECT_TRUE(levels_.frames->draw(shown_.camera, 0).ok());
    return levels_.frames->software_target()->color();
  }
  Rgba8Image lod(double error_px) {
    SoftwareBackend backend(scene_, 4);
    MethodOptions options;
    options.error_px = error_px;
    const Result<Method> made = make_method("lod", options, backend);
    EXPECT_TRUE(made.ok() && made->frames->draw(shown_.camera, 0).ok());
    return made->frames->software_target()->color();
  }

  Scene scene_;
  ShownFrame shown_;
  std::unique_ptr<SoftwareBackend> backend_;
  AutoLevels levels_;
};

TEST_F(AutoLevelsTest, they_begin_with_half_of_the_error) {
  EXPECT_TRUE(drawn() == lod(kErrorPx / 2));
  EXPECT_FALSE(drawn() == lod(kErrorPx));
}

TEST_F(AutoLevelsTest, what_was_made_follows_a_changed_error) {
  follow_error(2 * kErrorPx, levels_);
  EXPECT_TRUE(drawn() == lod(kErrorPx));
  ASSERT_TRUE(make_finer(2 * kErrorPx, 0.1, levels_));
  EXPECT_TRUE(drawn() == lod(0.7 * kErrorPx));
  follow_error(kErrorPx, levels_);
  EXPECT_TRUE(drawn() == lod(0.35 * kErrorPx));
}

TEST_F(AutoLevelsTest, they_become_finer_down_to_an_eighth) {
  for (const double share : {0.35, 0.245, 0.1715, 0.125}) {
    ASSERT_TRUE(make_finer(kErrorPx, 0.1, levels_));
    EXPECT_DOUBLE_EQ(levels_.share, share);
  }
  EXPECT_FALSE(make_finer(kErrorPx, 0.1, levels_));
  EXPECT_TRUE(drawn() == lod(kErrorPx / 8));
}

TEST_F(AutoLevelsTest, they_become_much_finer_where_they_lose_much_more) {
  ASSERT_TRUE(make_finer(kErrorPx, 2, levels_));
  EXPECT_DOUBLE_EQ(levels_.share, 0.25);
}

TEST_F(AutoLevelsTest, an_audition_takes_all_of_the_error_where_that_is_good_enough) {
  shown_.color = lod(0);
  for (const double allowed_db : {1000.0, 0.0}) {
    const Audition found = audition_levels(shown_, kErrorPx, allowed_db, nullptr, levels_);
    ASSERT_TRUE(found.loss_db);
    EXPECT_GT(found.processor_ms, 0);
    EXPECT_EQ(levels_.share, allowed_db > 0 ? 1 : 0.5);
    EXPECT_TRUE(drawn() == lod(levels_.share * kErrorPx));
  }
}

}  // namespace
}  // namespace rilievo
