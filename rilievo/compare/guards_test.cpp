// Small walks whose figures must stay as good as they are. Deterministic: the eye moves from frame
// to frame, not by the clock. A limit is what was measured, with the margin that is said beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>

#include "rilievo/compare/compare.h"
#include "rilievo/compare/drawn_error.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/position_colors.h"

namespace rilievo {
namespace {

struct Guard {
  const char* scene;
  int step;          // frames of the scene's walk from one frame drawn to the next
  double psnr_db;    // the mean, at least: a decibel or two below what was measured
  double wrong;      // the largest share of wrong visibility: a few times what was measured
  double uncovered;  // the same
};

class GuardTest : public gl::ContextTest {};

TEST_F(GuardTest, the_cache_is_as_right_as_it_was_and_within_its_bounds) {
  constexpr int kFrames = 6, kAcross = 192, kDown = 108;
  for (const Guard& guard : {Guard{"builtin:bridge?triangles=100000", 6, 31, 0.001, 0.001},
                             Guard{"builtin:forest?triangles=100000", 4, 33, 0.001, 0.001}}) {
    const Result<BuiltinScene> made = make_builtin(guard.scene);
    ASSERT_TRUE(made.ok());
    Result<SceneRenderer> renderer = SceneRenderer::create(made->scene);
    ASSERT_TRUE(renderer.ok());
    OpenGLFrames direct = opengl_direct(*renderer);
    ImageCacheOptions cache_options;
    Result<TestSource> cache = opengl_cache(*renderer, cache_options);
    ASSERT_TRUE(cache.ok());
    const ComparedSource sources[] = {{"direct", &direct}, {"cache", &*cache}};
    CompareOptions options;
    options.width = kAcross, options.height = kDown, options.frames = kFrames;
    const auto walk = [&](int frame) {
      const double time = frame_time(made->path, guard.step * frame);
      return WalkFrame{camera_at(made->path, time, kAcross, kDown), time};
    };
    Result<Report> report = compare(sources, walk, options);
    ASSERT_TRUE(report.ok());
    // Again, with colours that tell positions.
    const Result<std::vector<double>> half_periods =
        choose_half_periods(made->scene, direct, walk, options);
    ASSERT_TRUE(half_periods.ok());
    const Scene coded = with_position_colors(made->scene, *half_periods);
    Result<SceneRenderer> coded_renderer = SceneRenderer::create(coded);
    ASSERT_TRUE(coded_renderer.ok());
    OpenGLFrames coded_direct = opengl_direct(*coded_renderer);
    Result<TestSource> coded_cache = opengl_cache(*coded_renderer, cache_options);
    ASSERT_TRUE(coded_cache.ok());
    const ComparedSource coded_sources[] = {{"direct", &coded_direct}, {"cache", &*coded_cache}};
    ASSERT_TRUE(
        measure_drawn_errors(coded, *half_periods, coded_sources, walk, options, *report).ok());
    EXPECT_TRUE(report->notes.empty());  // the second walk did as the first one
    const MethodResult& method = report->methods[1];
    double psnr_db = 0, wrong = 0, uncovered = 0;
    for (const FrameResult& frame : method.frames) {
      psnr_db += std::min(frame.psnr_db, kMaxPsnrDb) / kFrames;
      wrong = std::max(wrong, frame.wrong_visibility);
      uncovered = std::max(uncovered, frame.uncovered);
    }
    SCOPED_TRACE(guard.scene);
    RecordProperty(std::string(made->scene.name) + "_psnr_db", std::to_string(psnr_db));
    RecordProperty(std::string(made->scene.name) + "_wrong", std::to_string(wrong));
    EXPECT_GT(psnr_db, guard.psnr_db);
    EXPECT_LE(wrong, guard.wrong);
    EXPECT_LE(uncovered, guard.uncovered);
    // The bounds hold in every frame, and for what is drawn.
    EXPECT_EQ(method.over_bound_share.value_or(1), 0.0);
    EXPECT_LE(method.bound_px_max.value_or(0), cache_options.error_px * 1.0001);
    EXPECT_LE(method.gap_bound_px_max.value_or(0), 2 * cache_options.error_px * 1.0001);
    ASSERT_TRUE(method.error_px);
    RecordProperty(std::string(made->scene.name) + "_error_p99",
                   std::to_string(method.error_px->p99));
    RecordProperty(std::string(made->scene.name) + "_error_max",
                   std::to_string(method.error_px->max));
    EXPECT_EQ(method.error_px->violations, 0);
    EXPECT_LE(method.error_px->max,
              method.bound_px_max.value_or(0) * 1.001 + method.error_px->resolution);
    EXPECT_GT(method.error_px->measured, 0.05);  // leaves at this size are edges, most of them
    // Pictures are drawn at all.
    EXPECT_GT(method.captures, 10);
  }
}

}  // namespace
}  // namespace rilievo
