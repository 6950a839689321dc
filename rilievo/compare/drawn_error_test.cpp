// What is drawn elsewhere by a known amount is found to be, by colours that tell positions.
#include "rilievo/compare/drawn_error.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>

#include "rilievo/frame/gl/opengl_target.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/position_colors.h"

namespace rilievo {
namespace {

constexpr int kErrorWidth = 320, kErrorHeight = 180;

Scene balls() {
  Scene scene;
  Mesh ball;
  add_blob(ball, 16, [](const glm::vec3& direction) { return BuiltVertex{direction}; });
  scene.meshes.push_back(std::move(ball));
  scene.models.emplace_back().parts.push_back({0, glm::mat4(1)});
  for (const auto& [x, radius] : {std::pair(-1.4f, 1.0f), {0.6f, 0.8f}, {2.3f, 1.2f}}) {
    Object object;
    object.placement =
        glm::scale(glm::translate(glm::mat4(1), {x, 0.2f * x, 0}), glm::vec3(radius));
    scene.objects.push_back(object);
  }
  finish(scene);
  return scene;
}

Camera eye_at(double x) {
  return look_at({x, 0.3, 9}, {x, 0, 0}, {0, 1, 0}, 0.5, kErrorWidth, kErrorHeight, 0.5, 40);
}

// Draws as another camera sees it.
class Shifted final : public FrameSource {
 public:
  Shifted(FrameSource& from, const glm::dvec2& by_px) : from_(&from), by_px_(by_px) {}
  Result<> draw(const Camera& camera, double time) override {
    Camera other = camera;
    const glm::dvec2 texel((camera.window.right - camera.window.left) / camera.width,
                           (camera.window.top - camera.window.bottom) / camera.height);
    other.window.left -= by_px_.x * texel.x, other.window.right -= by_px_.x * texel.x;
    other.window.bottom -= by_px_.y * texel.y, other.window.top -= by_px_.y * texel.y;
    return from_->draw(other, time);
  }
  Result<> draw_objects() override { return from_->draw_objects(); }
  [[nodiscard]] const FrameStats& stats() const override { return from_->stats(); }

 private:
  FrameSource* from_;
  glm::dvec2 by_px_;
};

// Draws what another one does, and claims these bounds.
class Bounded final : public FrameSource {
 public:
  Bounded(FrameSource& from, double bound_px, double gap_px) : from_(&from) {
    stats_.bound_px = bound_px, stats_.gap_px = gap_px;
  }
  Result<> draw(const Camera& camera, double time) override { return from_->draw(camera, time); }
  Result<> draw_objects() override { return from_->draw_objects(); }
  [[nodiscard]] const FrameStats& stats() const override { return stats_; }

 private:
  FrameSource* from_;
  FrameStats stats_;
};

class DrawnErrorTest : public gl::ContextTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(ContextTest::SetUp());
    options.width = kErrorWidth, options.height = kErrorHeight;
    options.frames = 1;
  }

  // A renderer of what shows positions.
  void code(const Scene& scene, const std::function<WalkFrame(int)>& walk) {
    Result<SceneRenderer> plain = SceneRenderer::create(scene);
    ASSERT_TRUE(plain.ok());
    OpenGLFrames truth = opengl_direct(*plain);
    Result<std::vector<double>> chosen = choose_half_periods(scene, truth, walk, options);
    ASSERT_TRUE(chosen.ok());
    half_periods = std::move(*chosen);
    coded = with_position_colors(scene, half_periods);
    Result<SceneRenderer> made = SceneRenderer::create(coded);
    ASSERT_TRUE(made.ok());
    renderer.emplace(std::move(*made));
    direct = std::make_unique<OpenGLFrames>(*renderer, std::make_unique<DirectChooser>());
  }

  ErrorPx measure(FrameSource& source, const std::function<WalkFrame(int)>& walk) {
    Report report;
    report.methods.resize(1);
    report.methods[0].name = "it";
    const ComparedSource sources[] = {{"direct", direct.get()}, {"it", &source}};
    const Result<> done = measure_drawn_errors(coded, half_periods, sources, walk, options, report);
    EXPECT_TRUE(done.ok());
    return report.methods[0].error_px.value();
  }

  CompareOptions options;
  std::vector<double> half_periods;
  Scene coded;
  std::optional<SceneRenderer> renderer;
  std::unique_ptr<FrameSource> direct;
};

TEST_F(DrawnErrorTest, the_truth_lies_where_it_lies_as_closely_as_is_resolved) {
  options.frames = 4;
  for (const char* spec : {"builtin:bridge?triangles=100000", "builtin:forest?triangles=100000"}) {
    SCOPED_TRACE(spec);
    const Result<BuiltinScene> made = make_builtin(spec);
    const auto walk = [&](int frame) {
      const double time = frame_time(made->path, 12 * frame);
      return WalkFrame{camera_at(made->path, time, kErrorWidth, kErrorHeight), time};
    };
    ASSERT_NO_FATAL_FAILURE(code(made->scene, walk));
    TestSource software = software_direct(coded, options.samples);
    FrameSource* const all[] = {direct.get(), &software};
    for (FrameSource* source : all) {
      const ErrorPx error = measure(*source, walk);
      if (source == direct.get()) {
        EXPECT_LT(error.max, error.resolution);
      }
      // Without OpenGL, samples of what is narrower than a pixel lie elsewhere.
      EXPECT_LT(error.p99, 0.5 * error.resolution);
      EXPECT_LT(error.p50, 0.3 * error.resolution);
      EXPECT_GT(error.measured, 0.1);
      // What is not measured is told.
      EXPECT_NEAR(error.measured + error.boundary + error.mixed + error.unresolved, 1, 1e-9);
    }
  }
}

TEST_F(DrawnErrorTest, a_shifted_frame_is_off_by_the_shift) {
  const Scene scene = balls();
  const auto walk = [](int) { return WalkFrame{eye_at(0), 0}; };
  ASSERT_NO_FATAL_FAILURE(code(scene, walk));
  for (const glm::dvec2 by : {glm::dvec2(0.5, 0), {0, -1}, {1.25, 0.75}, {-3, 2}}) {
    Shifted shifted(*direct, by);
    const ErrorPx error = measure(shifted, walk);
    const double wanted = glm::length(by);
    EXPECT_NEAR(error.p50, wanted, 0.5 * error.resolution);
    EXPECT_NEAR(error.p99, wanted, error.resolution);
    EXPECT_LT(error.max, wanted + error.resolution);
    EXPECT_GT(error.measured, 0.5);
  }
}

// As a picture taken from one eye that lies too far away, and as a warp with too large a Delta:
// all is scaled about that eye, which sees no difference, while others see parallax.
TEST_F(DrawnErrorTest, a_stale_picture_is_off_by_its_parallax) {
  const Scene scene = balls();
  const auto walk = [](int frame) { return WalkFrame{eye_at(0.25 * frame), 0}; };
  ASSERT_NO_FATAL_FAILURE(code(scene, walk));
  const glm::dvec3 eye = eye_at(0).position();
  for (const double scale : {1.05, 1.1, 0.9}) {
    Scene moved = coded;
    for (Object& object : moved.objects)
      object.placement = glm::mat4(
          glm::translate(glm::dmat4(1), eye) * glm::scale(glm::dmat4(1), glm::dvec3(scale)) *
          glm::translate(glm::dmat4(1), -eye) * glm::dmat4(object.placement));
    finish(moved);
    Result<SceneRenderer> stale_renderer = SceneRenderer::create(moved);
    ASSERT_TRUE(stale_renderer.ok());
    OpenGLFrames stale = opengl_direct(*stale_renderer);
    for (const int at : {0, 1, 2}) {
      const WalkFrame frame = walk(at);
      const ErrorPx error = measure(stale, [&](int) { return frame; });
      // Brute force: where each pixel's surface belongs.
      Result<OpenGLTarget> target =
          OpenGLTarget::create(kErrorWidth, kErrorHeight, options.samples);
      ASSERT_TRUE(target.ok());
      const Result<DrawnFrame> drawn = draw_frame(stale, *target, frame);
      const Result<DrawnFrame> truth = draw_frame(*direct, *target, frame);
      ASSERT_TRUE(drawn.ok() && truth.ok());
      std::vector<double> wanted;
      for (int y = 0; y < kErrorHeight; ++y)
        for (int x = 0; x < kErrorWidth; ++x) {
          if (drawn->objects(x, y) == 0 || drawn->objects(x, y) != truth->objects(x, y)) continue;
          const glm::dvec2 raster(x + 0.5, y + 0.5);
          const glm::dvec3 place =
              world_from_raster(frame.camera, raster, double(drawn->eye_z(x, y)));
          wanted.push_back(glm::distance(
              glm::dvec2(raster_from_world(frame.camera, eye + (place - eye) / scale)), raster));
        }
      const Summary all = summarize(wanted);
      EXPECT_NEAR(error.p50, all.p50, 0.5 * error.resolution + 0.05 * all.p50)
          << scale << " " << at;
      EXPECT_LT(error.max, all.max + error.resolution);
      EXPECT_GT(error.max, all.p50);
      if (at == 0) {
        EXPECT_LT(all.max, 1e-3);  // floats
      }
      if (at == 2) {
        EXPECT_GT(all.p50, 0.5);
      }
    }
  }
}

TEST_F(DrawnErrorTest, an_error_above_the_bound_is_counted) {
  const Scene scene = balls();
  const auto walk = [](int) { return WalkFrame{eye_at(0), 0}; };
  ASSERT_NO_FATAL_FAILURE(code(scene, walk));
  Shifted shifted(*direct, {2, 0});
  Bounded kept(shifted, 2, 0), broken(shifted, 1, 0);
  EXPECT_EQ(measure(kept, walk).over_bound, 0);
  EXPECT_EQ(measure(kept, walk).violations, 0);
  // Near a fold of one of the waves the error looks smaller: 2 px of 26 on either side.
  EXPECT_GT(measure(broken, walk).over_bound, 0.85);
  EXPECT_GT(measure(broken, walk).violations, 0);
}

// A plate in front of another one, of one object; with a slit of `width` metres in the front one.
Scene plates(float width) {
  Scene scene;
  Mesh mesh;
  const auto add = [&](float x0, float x1, float z) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (const glm::vec2 at : {glm::vec2(x0, -2), {x1, -2}, {x1, 2}, {x0, 2}})
      mesh.positions.emplace_back(at, z), mesh.normals.emplace_back(0, 0, 1);
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + i);
  };
  add(-3, 3, -4);
  add(-3, -width, 0);
  add(width, 3, 0);
  scene.meshes.push_back(std::move(mesh));
  scene.models.emplace_back().parts.push_back({0, glm::mat4(1)});
  scene.objects.emplace_back();
  finish(scene);
  return scene;
}

// Colours of both plates mix beside the slit, and tell nothing; what shows in it is not off.
TEST_F(DrawnErrorTest, what_lies_behind_a_gap_is_counted_by_the_bound_of_gaps) {
  const auto walk = [](int) { return WalkFrame{eye_at(0), 0}; };
  ASSERT_NO_FATAL_FAILURE(code(plates(0), walk));
  const double pixel = 9 * 2 * std::tan(0.25) / kErrorHeight;
  for (const double wide_px : {2.3, 5.3}) {
    const Scene slit = with_position_colors(plates(float(0.5 * wide_px * pixel)), half_periods);
    Result<SceneRenderer> torn = SceneRenderer::create(slit);
    ASSERT_TRUE(torn.ok());
    OpenGLFrames frames = opengl_direct(*torn);
    Bounded narrow(frames, 0.25, 0.5), wide(frames, 0.25, 6), none(frames, 0.25, 0);
    EXPECT_GT(measure(none, walk).violations, 100);
    EXPECT_EQ(measure(none, walk).in_gaps, 0);
    EXPECT_EQ(measure(wide, walk).violations, 0);
    EXPECT_EQ(measure(wide, walk).in_gaps, measure(none, walk).violations);
    // The middle of what is wider than the bound is a violation, if it is measured at all.
    EXPECT_EQ(measure(narrow, walk).violations + measure(narrow, walk).in_gaps,
              measure(none, walk).violations);
  }
}

// Captures, narrowing, fades and all: what the cache says holds for what it draws.
TEST_F(DrawnErrorTest, a_second_walk_of_the_cache_does_as_the_first) {
  options.frames = 12;
  const Result<BuiltinScene> made = make_builtin("builtin:bridge?triangles=100000");
  const auto walk = [&](int frame) {
    const double time = frame_time(made->path, frame);
    return WalkFrame{camera_at(made->path, time, kErrorWidth, kErrorHeight), time};
  };
  ASSERT_NO_FATAL_FAILURE(code(made->scene, walk));
  Result<SceneRenderer> plain = SceneRenderer::create(made->scene);
  Result<TestSource> one = opengl_cache(*plain, {}), two = opengl_cache(*renderer, {});
  ASSERT_TRUE(one.ok() && two.ok());
  Result<OpenGLTarget> target = OpenGLTarget::create(kErrorWidth, kErrorHeight, options.samples);
  ASSERT_TRUE(target.ok());
  for (int frame = 0; frame < options.frames; ++frame) {
    const Result<DrawnFrame> a = draw_frame(*one, *target, walk(frame));
    const Result<DrawnFrame> b = draw_frame(*two, *target, walk(frame));
    ASSERT_TRUE(a.ok() && b.ok());
    EXPECT_EQ(a->objects, b->objects);
    EXPECT_EQ(a->eye_z, b->eye_z);
    EXPECT_EQ(a->stats.captures, b->stats.captures);
    EXPECT_EQ(a->stats.by_kind, b->stats.by_kind);
    EXPECT_EQ(a->stats.bound_px, b->stats.bound_px);
  }
}

}  // namespace
}  // namespace rilievo
