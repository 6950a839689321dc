#include "rilievo/compare/reference_frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "rilievo/compare/compare.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/png.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// No multiple of 2 or 3 or 4: parts reach beyond the frame.
constexpr int kReferenceWidth = 89, kReferenceHeight = 61;

struct Walked {
  BuiltinScene made;
  WalkFrame frame;

  Walked() : made(*make_builtin("builtin:stonehenge?triangles=20000")) {
    frame = {camera_at(made.path, 0.1, kReferenceWidth, kReferenceHeight), 0.1};
  }
};

TEST(ReferenceFrames, a_frame_is_the_mean_of_one_that_is_drawn_larger) {
  const Walked walked;
  TestSource source = software_direct(walked.made.scene, 4);
  ReferenceFrames reference(source, 4, {.samples = 36});
  const Result<Rgba8Image> frame = reference.frame(walked.frame);
  ASSERT_TRUE(frame);
  // The slow way: all of it at three times the size.
  TestSource large = software_direct(walked.made.scene, 4);
  Camera camera = walked.frame.camera;
  camera.width *= 3, camera.height *= 3;
  ASSERT_TRUE(large.draw(camera, walked.frame.time));
  const Rgba8Image& all = large.software_target()->color();
  int apart = 0;
  for (int y = 0; y < kReferenceHeight; ++y)
    for (int x = 0; x < kReferenceWidth; ++x)
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int i = 0; i < 9; ++i) sum += all(3 * x + i % 3, 3 * y + i / 3)[c];
        apart += std::abs(int((*frame)(x, y)[c]) - (sum + 4) / 9) > 1;
      }
  // A part's samples lie where the whole frame's do but for rounding: now and then one falls on the
  // other side of an edge.
  EXPECT_LE(apart, kReferenceWidth * kReferenceHeight * 3 / 500);
}

TEST(ReferenceFrames, more_samples_come_nearer_to_the_most) {
  const Walked walked;
  TestSource source = software_direct(walked.made.scene, 4);
  const auto with = [&](int samples) {
    return *ReferenceFrames(source, 4, {.samples = samples}).frame(walked.frame);
  };
  const Rgba8Image most = with(64);
  const double few = psnr_db(with(4), most), more = psnr_db(with(16), most);
  // Four times the samples halve the error, or nearly: 6 dB.
  EXPECT_GT(more, few + 3);
}

TEST(ReferenceFrames, frames_are_kept_by_scene_eye_and_size) {
  const Walked walked;
  const TemporaryFolder folder;
  TestSource source = software_direct(walked.made.scene, 4);
  ReferenceOptions options{.samples = 16, .folder = folder / "kept", .scene = "a"};
  ReferenceFrames first(source, 4, options), again(source, 4, options);
  const Rgba8Image made = *first.frame(walked.frame);
  EXPECT_EQ(first.drawn(), 1);
  EXPECT_EQ(*again.frame(walked.frame), made);
  EXPECT_EQ(again.drawn(), 0);
  WalkFrame other = walked.frame;
  other.camera.world_from_eye[3].x += 1e-9;
  ASSERT_TRUE(again.frame(other));
  other = walked.frame, other.camera.height -= 1;
  ASSERT_TRUE(again.frame(other));
  EXPECT_EQ(again.drawn(), 2);
  options.scene = "b";
  ReferenceFrames of_other(source, 4, options);
  ASSERT_TRUE(of_other.frame(walked.frame));
  EXPECT_EQ(of_other.drawn(), 1);
  // A file that is damaged is made again.
  for (const auto& entry : std::filesystem::directory_iterator(folder / "kept"))
    std::ofstream(entry.path()) << "no picture";
  EXPECT_EQ(*again.frame(walked.frame), made);
  EXPECT_EQ(again.drawn(), 3);
  EXPECT_EQ(*again.frame(walked.frame), made);
  EXPECT_EQ(again.drawn(), 3);
}

TEST(ReferenceFrames, a_frame_that_cannot_be_kept_is_an_error) {
  const Walked walked;
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "no folder";
  TestSource source = software_direct(walked.made.scene, 4);
  ReferenceFrames reference(source, 4, {.samples = 4, .folder = folder / "file"});
  EXPECT_FALSE(reference.frame(walked.frame));
}

TEST(ReferenceFrames, methods_and_direct_drawing_are_compared_with_them) {
  const Walked walked;
  TestSource source = software_direct(walked.made.scene, 4),
             of_few(software_direct(walked.made.scene, 1)),
             drawn = software_direct(walked.made.scene, 4);
  ReferenceFrames reference(source, 4, {.samples = 36});
  const ComparedSource sources[] = {{"direct-raster", &drawn}, {"one sample", &of_few}};
  CompareOptions options;
  options.width = kReferenceWidth, options.height = kReferenceHeight, options.frames = 2;
  options.reference = &reference;
  const Result<Report> report = compare(
      sources, [&](int) { return walked.frame; }, options);
  ASSERT_TRUE(report);
  const double expected = psnr_db(*reference.frame(walked.frame), drawn.software_target()->color());
  for (const FrameResult& frame : report->methods[0].frames) {
    EXPECT_DOUBLE_EQ(frame.psnr_db, expected);
    EXPECT_TRUE(frame.pictures);
    EXPECT_EQ(frame.wrong_visibility, 0);
  }
  EXPECT_LT(report->methods[1].frames[1].psnr_db, expected);
  // Two frames of one eye: nothing changes, in either.
  EXPECT_EQ(report->methods[0].flicker[0], 0);
}

TEST(ReferenceFrames, samples_are_those_of_the_source_times_a_square) {
  for (const int samples : {4, 16, 36, 64}) EXPECT_TRUE(can_reference(samples, 4));
  for (const int samples : {1, 4, 9, 16}) EXPECT_TRUE(can_reference(samples, 1));
  for (const int samples : {1, 8, 63, 100}) EXPECT_FALSE(can_reference(samples, 4));
}

}  // namespace
}  // namespace rilievo
