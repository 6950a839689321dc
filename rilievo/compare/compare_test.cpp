#include "rilievo/compare/compare.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <memory>

#include "rilievo/gl/context_test_helpers.h"

namespace rilievo {
namespace {

constexpr int kWidth = 64, kHeight = 32;

// Object 1 in the columns left of `edge`, object 2 from there on.
class TwoHalves : public FrameSource {
 public:
  explicit TwoHalves(int edge, bool hole = false, float right_z = 0.5f)
      : edge_(edge), hole_(hole), right_z_(right_z) {}

  Result<> draw(const Camera&, double) override {
    edge_ += step_;
    step_ = -step_;
    fill(0, edge_, [](int) {
      const float red[] = {1, 0, 0, 1};
      glClearBufferfv(GL_COLOR, 0, red);
    });
    fill(edge_, kWidth, [](int) {
      const float blue[] = {0, 0, 1, 1};
      glClearBufferfv(GL_COLOR, 0, blue);
    });
    ++drawn_;
    return Done{};
  }

  Result<> draw_objects() override {
    const auto object = [](GLuint id, float window_z) {
      return [=](int) {
        const GLuint ids[] = {id, 0, 0, 0};
        glClearBufferuiv(GL_COLOR, 0, ids);
        glClearBufferfv(GL_DEPTH, 0, &window_z);
      };
    };
    fill(0, edge_, object(1, 0.25f));
    if (!hole_) fill(edge_, kWidth, object(2, right_z_));
    return Done{};
  }

  // Every second frame has its edge elsewhere.
  void blink(int by) { step_ = by; }

  [[nodiscard]] const FrameStats& stats() const override {
    stats_.captures = drawn_ == 1 ? 7 : 1;
    stats_.picture_bytes = std::size_t(100 * drawn_);
    stats_.by_kind = {{"nailboard", 2}};
    stats_.bound_px = drawn_ == 3 ? 0.75 : 0.5;
    return stats_;
  }

 private:
  template <class Clear>
  void fill(int left, int right, const Clear& clear) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(left, 0, right - left, kHeight);
    clear(0);
    glDisable(GL_SCISSOR_TEST);
  }

  mutable FrameStats stats_;
  int edge_ = 0;
  bool hole_ = false;
  float right_z_ = 0.5f;
  int drawn_ = 0, step_ = 0;
};

class CompareTest : public gl::ContextTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(ContextTest::SetUp());
    options.width = kWidth;
    options.height = kHeight;
    options.frames = 5;
    options.shown_frames = 3;
  }

  static WalkFrame still(int) {
    return {look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.9, kWidth, kHeight, 1, 10), 0};
  }

  CompareOptions options;
};

TEST_F(CompareTest, the_truth_agrees_with_itself) {
  TwoHalves truth(32), same(32);
  const ComparedSource sources[] = {{"direct", &truth}, {"same", &same}};
  const Result<Report> report = compare(sources, still, options);
  ASSERT_TRUE(report.ok()) << report.error().message();
  ASSERT_EQ(report->methods.size(), 2u);
  for (const MethodResult& method : report->methods) {
    ASSERT_EQ(method.frames.size(), 5u);
    for (const FrameResult& frame : method.frames) {
      EXPECT_TRUE(std::isinf(frame.psnr_db));
      EXPECT_EQ(frame.ssim, 1);
      EXPECT_EQ(frame.flip, 0);
      EXPECT_EQ(frame.wrong_visibility, 0);
      EXPECT_EQ(frame.uncovered, 0);
      EXPECT_GT(frame.frame_ms, 0);
    }
    EXPECT_EQ(method.depth_error_p99, 0);
  }
}

TEST_F(CompareTest, a_moved_edge_is_wrong_where_it_has_been) {
  TwoHalves truth(32), moved(42);
  const ComparedSource sources[] = {{"direct", &truth}, {"moved", &moved}};
  const Result<Report> report = compare(sources, still, options);
  ASSERT_TRUE(report.ok()) << report.error().message();
  for (const FrameResult& frame : report->methods[1].frames) {
    // Columns 31 and 32 touch the true edge and do not count; of the ten wrong ones nine are left.
    EXPECT_DOUBLE_EQ(frame.wrong_visibility, 9.0 / 62.0);
    EXPECT_EQ(frame.uncovered, 0);
    // In ten columns of 64, red and blue are off by 255 each, green is right.
    EXPECT_NEAR(frame.psnr_db, -10 * std::log10(10.0 / 64 * 2 / 3), 1e-9);
    EXPECT_LT(frame.ssim, 1);
    EXPECT_GT(frame.flip, 0);
  }
}

TEST_F(CompareTest, frames_that_were_read_measure_as_those_that_were_drawn) {
  TwoHalves truth(32), moved(42);
  const auto read = [](bool with_objects) {
    return [=](int) -> Result<DrawnFrame> {
      DrawnFrame frame;
      frame.color = Rgba8Image(kWidth, kHeight);
      if (with_objects) frame.objects = Image<std::uint32_t>(kWidth, kHeight);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          frame.color(x, y) = x < 42 ? glm::u8vec4(255, 0, 0, 255) : glm::u8vec4(0, 0, 255, 255);
          if (with_objects) frame.objects(x, y) = x < 42 ? 1 : 2;
        }
      return frame;
    };
  };
  const ComparedSource sources[] = {{"direct", &truth},
                                    {"moved", &moved},
                                    {"read", nullptr, read(true)},
                                    {"colours", nullptr, read(false)}};
  const Result<Report> report = compare(sources, still, options);
  ASSERT_TRUE(report.ok()) << report.error().message();
  ASSERT_EQ(report->methods.size(), 4u);
  const FrameResult& drawn = report->methods[1].frames[0];
  for (const std::size_t method : {2u, 3u}) {
    ASSERT_EQ(report->methods[method].frames.size(), 5u);
    const FrameResult& frame = report->methods[method].frames[0];
    EXPECT_EQ(frame.psnr_db, drawn.psnr_db);
    EXPECT_EQ(frame.ssim, drawn.ssim);
    EXPECT_EQ(frame.flip, drawn.flip);
    EXPECT_EQ(frame.wrong_visibility, method == 2u ? drawn.wrong_visibility : 0);
  }
}

TEST_F(CompareTest, what_is_not_drawn_is_uncovered) {
  TwoHalves truth(32), holed(32, true);
  const ComparedSource sources[] = {{"direct", &truth}, {"holed", &holed}};
  const Result<Report> report = compare(sources, still, options);
  ASSERT_TRUE(report.ok()) << report.error().message();
  EXPECT_DOUBLE_EQ(report->methods[1].frames[0].uncovered, 31.0 / 62.0);
  EXPECT_DOUBLE_EQ(report->methods[1].frames[0].wrong_visibility, 31.0 / 62.0);
}

TEST_F(CompareTest, depths_are_compared_as_distances_from_the_eye) {
  TwoHalves truth(32), deeper(32, false, 0.6f);
  const ComparedSource sources[] = {{"direct", &truth}, {"deeper", &deeper}};
  const Result<Report> report = compare(sources, still, options);
  ASSERT_TRUE(report.ok()) << report.error().message();
  // Half of the pixels are right; the eye, at 1 ... 10 m, sees the others at 1 / (1 - 0.9 z).
  const double error = (1 - 0.9 * 0.5) / (1 - 0.9 * 0.6) - 1;
  EXPECT_EQ(report->methods[1].depth_error_p50, 0);
  // A histogram's bin is 1 / 64 wide.
  EXPECT_NEAR(report->methods[1].depth_error_p99, error, error / 64);
}

TEST_F(CompareTest, counts_what_the_warm_up_captured) {
  TwoHalves truth(32);
  const ComparedSource sources[] = {{"direct", &truth}};
  const Result<Report> report = compare(sources, still, options);
  ASSERT_TRUE(report.ok()) << report.error().message();
  const MethodResult& method = report->methods[0];
  EXPECT_EQ(method.captures, 7 + 5);
  EXPECT_EQ(method.picture_bytes, 600u);
  EXPECT_EQ(method.bound_px_max, 0.75);
  const std::vector<std::pair<std::string, std::int64_t>> drawn{
      {"polygons", 0}, {"nailboard", 10}, {"hierarchy", 0}};
  EXPECT_EQ(method.drawn_as, drawn);
}

TEST_F(CompareTest, popping_is_a_change_that_the_true_frames_do_not_have) {
  options.pop = true;
  TwoHalves still_truth(32), still_one(42), blinking(32), all_blink(32);
  blinking.blink(10);
  all_blink.blink(10);
  const ComparedSource calm[] = {
      {"direct", &still_truth}, {"off", &still_one}, {"pops", &blinking}};
  Result<Report> report = compare(calm, still, options);
  ASSERT_TRUE(report.ok()) << report.error().message();
  EXPECT_EQ(report->methods[0].pop_max, 0.0);
  EXPECT_EQ(report->methods[1].pop_max, 0.0);  // wrong, but always alike
  EXPECT_GT(report->methods[2].pop_max, 0.01);
  // What the truth does is no pop.
  const ComparedSource wild[] = {{"direct", &all_blink}, {"still", &still_one}};
  report = compare(wild, still, options);
  ASSERT_TRUE(report.ok()) << report.error().message();
  EXPECT_EQ(report->methods[0].pop_max, 0.0);
  EXPECT_EQ(report->methods[1].pop_max, 0.0);
}

TEST_F(CompareTest, little_memory_changes_nothing_but_the_order) {
  for (const std::size_t bytes : {std::size_t(1), std::size_t(1) << 30}) {
    options.max_bytes = bytes;
    TwoHalves truth(32), moved(42);
    const ComparedSource sources[] = {{"direct", &truth}, {"moved", &moved}};
    int last = 0;
    options.progress = [&](int done, int total) {
      EXPECT_EQ(done, last + 1);
      EXPECT_EQ(total, 5);
      last = done;
    };
    const Result<Report> report = compare(sources, still, options);
    ASSERT_TRUE(report.ok()) << report.error().message();
    EXPECT_EQ(last, 5);
    EXPECT_EQ(report->shown, (std::vector<int>{0, 2, 4}));
    EXPECT_EQ(report->true_pictures.size(), 3u);
    for (const MethodResult& method : report->methods) {
      EXPECT_EQ(method.frames.size(), 5u);
      EXPECT_EQ(method.pictures.size(), 3u);
      EXPECT_EQ(method.differences.size(), 3u);
    }
    EXPECT_DOUBLE_EQ(report->methods[1].frames[4].wrong_visibility, 9.0 / 62.0);
  }
}

}  // namespace
}  // namespace rilievo
