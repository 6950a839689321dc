#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/cache/gl/scene_test_helpers.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/kinds.h"

namespace rilievo {
namespace {

// Draws nothing, counts how often it is asked to, and is as wrong as it is told.
class Counted final : public Drawable {
 public:
  Counted(double bound_px, int& drawn) : bound_px_(bound_px), drawn_(drawn) {}
  [[nodiscard]] std::string_view kind() const override { return "counted"; }
  void draw(const Camera&, std::span<const Instance> instances, Output) override {
    for (const Instance& instance : instances) {
      EXPECT_EQ(instance.object, kNoObject);
      ++drawn_;
    }
  }
  void draw_outlines(const Camera&, std::span<const Instance>) override {}
  [[nodiscard]] ErrorModel error_model(std::uint32_t) const override {
    ErrorModel model;
    model.store(bound_px_);
    model.bound = [](const ErrorModel& of, const glm::dmat4&, const Camera&) {
      return of.load<double>();
    };
    return model;
  }
  [[nodiscard]] CostTerms cost_terms(std::uint32_t) const override { return {1, 0}; }
  [[nodiscard]] std::size_t bytes() const override { return 1000; }

 private:
  double bound_px_;
  int& drawn_;
};

// The first teapots where they are, the others sixteen times in a ring far around.
class SurroundingsTest : public SceneTest {
 protected:
  void SetUp() override {
    SceneTest::SetUp();
    auto made = make_builtin("builtin:teapots?triangles=20000");
    ASSERT_TRUE(made.ok());
    Scene& scene = made->scene;
    scene.objects.resize(4);
    const Object one = scene.objects[1];  // the first is the table
    for (int i = 0; i < 16; ++i) {
      const float a = 6.2831853f * float(i) / 16;
      Object object = one;
      object.placement[3] = glm::vec4(400 * std::sin(a), 0, 400 * std::cos(a), 1);
      for (int k = 0; k < 3; ++k) object.placement[k] *= 30.0f;
      far_.push_back(std::uint32_t(scene.objects.size()));
      scene.objects.push_back(object);
    }
    finish(scene);
    load(std::move(*made));
  }
  [[nodiscard]] static Camera frame_at(int i) {
    const double a = 0.4 * i;
    return look_at({0.01 * i, 2, 9}, {0.01 * i + std::sin(a), 2, 9 + std::cos(a)}, {0, 1, 0}, 0.9,
                   kWidth, kHeight, 0.1, 1000);
  }

  std::vector<std::uint32_t> far_;
};

TEST_F(SurroundingsTest, stand_for_all_that_is_far_while_their_bound_allows_it) {
  for (const double bound_px : {0.5, 1.5, std::numeric_limits<double>::infinity()}) {
    auto cache = opengl_cache(*renderer, {});
    ASSERT_TRUE(cache.ok());
    int drawn = 0;
    cache->cache().add_surroundings(std::make_unique<Counted>(bound_px, drawn), nullptr, far_);
    OpenGLFrames direct = opengl_direct(*renderer);
    bool far_seen = false;
    for (int i = 0; i < 12; ++i) {
      const Camera camera = frame_at(i);
      frame_of(direct, camera);
      const Image<std::uint32_t> truth = objects_of(direct);
      drawn = 0;
      frame_of(*cache, camera);
      const bool stands = drawn > 0;
      const Image<std::uint32_t> seen = objects_of(*cache);
      const auto is_far = [](std::uint32_t object) { return object > 4; };
      const bool far_true = std::any_of(truth.texels().begin(), truth.texels().end(), is_far);
      const bool far_drawn = std::any_of(seen.texels().begin(), seen.texels().end(), is_far);
      far_seen = far_seen || far_true;
      if (bound_px <= 1) {
        // What stands for them draws nothing, and nobody else draws them.
        EXPECT_FALSE(far_drawn) << i;
        EXPECT_TRUE(stands || !far_true) << i;
        EXPECT_LE(cache->stats().bound_px, 1);
      } else {
        EXPECT_FALSE(stands);
        EXPECT_EQ(far_drawn, far_true) << i;
        // Edges of pictures may differ by a pixel; inside of objects nothing may.
        EXPECT_EQ(wrong_inside(truth, seen), 0) << i;
      }
    }
    EXPECT_TRUE(far_seen);
    // What stood for them is gone with the first of them that changes.
    cache->cache().invalidate_object(far_[3]);
    drawn = 0;
    frame_of(*cache, frame_at(0));
    EXPECT_EQ(drawn, 0);
  }
}

// By the list of kinds, as the command line has it.
TEST_F(SurroundingsTest, nodes_show_what_is_far_where_the_eye_has_not_gone_too_far_itself) {
  const Kind* kind = find_kind(kinds(), "environment-nodes");
  ASSERT_NE(kind, nullptr);
  OptionValues bake(kind->bake_options), draw(kind->draw_options);
  ASSERT_TRUE(bake.set("at", "0,2,9").ok());
  ASSERT_TRUE(bake.set("face", "192").ok());
  ASSERT_TRUE(draw.set("nodes", "1").ok());
  auto factory = make_factory(drawable_rows(), kind->name);
  ASSERT_TRUE(factory.ok());
  OpenGLSource source(*renderer);
  Result<Baked> baked = kind->bake({source, far_, {}}, bake, {});
  ASSERT_TRUE(baked.ok()) << baked.error().message();
  auto drawable = (*factory)->make_drawable(std::move(baked->representation), draw);
  ASSERT_TRUE(drawable.ok());
  const ErrorModel model = (*drawable)->error_model(0);
  double last = 0;
  for (const double way : {0.0, 0.05, 0.5, 5.0, 100.0}) {
    const Camera camera =
        look_at({way, 2, 9}, {way, 2, 8}, {0, 1, 0}, 0.9, kWidth, kHeight, 0.1, 1000);
    const double bound = model.bound_px(glm::dmat4(1), camera);
    EXPECT_GE(bound, last) << way;
    EXPECT_TRUE(way > 0.1 || bound <= 1) << way << " " << bound;
    EXPECT_TRUE(way < 50 || bound > 1) << way << " " << bound;
    last = bound;
  }
}

}  // namespace
}  // namespace rilievo
