// Captures beside the frames, without OpenGL.
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <thread>
#include <vector>

#include "rilievo/capture/picture_camera.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/nailboard/raster_gaps.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// What comes is what would have been captured when it was ordered, whatever has moved since.
TEST(CapturesBeside, make_what_a_capture_at_once_would) {
  const auto made = make_builtin("builtin:bridge?triangles=100000");
  ASSERT_TRUE(made.ok());
  PlacedScene placed(made->scene), then(made->scene);
  PlacedRaster source(placed), twin(then);
  std::mt19937 rng(2);
  CapturesBeside beside(source, 4);
  struct Expected {
    std::uint32_t slot;
    RasterPicture picture;
    GapTable gaps;
  };
  std::vector<Expected> expected;
  std::size_t came = 0;
  const auto take = [&] {
    while (const OrderedCapture* one = beside.take()) {
      ASSERT_LT(came, expected.size());
      const Expected& as = expected[came++];
      EXPECT_EQ(one->capture.slot, as.slot);
      EXPECT_EQ(one->picture.color, as.picture.color);
      EXPECT_EQ(one->picture.depth, as.picture.depth);
      EXPECT_EQ(one->gaps.code, as.gaps.code);
      EXPECT_EQ(one->gaps.w_front, as.gaps.w_front);
    }
  };
  for (int i = 0; i < 60; ++i) {
    const double time = 0.3 * i;
    placed.set_time(time), then.set_time(time);
    std::vector<std::uint32_t> objects;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t object = rng() % std::uint32_t(made->scene.objects.size());
      if (placed.has_opaque_parts(object)) objects.push_back(object);
    }
    if (objects.empty()) continue;
    const Box box = placed.opaque_bounds(objects);
    const glm::dvec3 middle(box.center());
    const Camera frame = look_at(middle + glm::dvec3(3, 2, 4) * double(box.radius()), middle,
                                 {0, 1, 0}, 0.8, 96, 64, 0.1, 5000);
    const auto camera = picture_camera(frame, box, {1, 128, 0.25});
    ASSERT_TRUE(camera.has_value());
    Capture capture;
    capture.slot = std::uint32_t(i);
    capture.geometry.capture = *camera;
    const bool with_gaps = i % 3 != 0;
    beside.order(capture, objects, with_gaps);
    RasterPicture picture = twin.draw(*camera, objects, 4);
    expected.push_back({capture.slot, picture,
                        with_gaps
                            ? raster_gaps(picture, twin.draw_farthest(*camera, objects), *camera)
                            : GapTable{}});
    if (i % 7 == 0) take();
  }
  beside.finish();
  take();
  EXPECT_EQ(came, expected.size());
  EXPECT_GT(came, 50u);
}

struct Frames {
  std::unique_ptr<TestSource> cache;
  const BuiltinScene& made;

  Frames(const BuiltinScene& made_, const ImageCacheOptions& options) : made(made_) {
    auto created = software_cache(made.scene, options);
    EXPECT_TRUE(created.ok());
    cache = std::move(*created);
  }
  const FrameStats& draw(double time) {
    EXPECT_TRUE(cache->draw(camera_at(made.path, time, 160, 90), time).ok());
    return cache->stats();
  }
};

// No time suffices to capture in the first frame, and it does not wait: what needs pictures is
// coarse in it. While the eye stands they come, until all is as fine as the bound asks for.
TEST(SoftwareCacheBeside, frames_do_not_wait_and_become_fine) {
  const auto made = make_builtin("builtin:forest?triangles=400000");
  ASSERT_TRUE(made.ok());
  ImageCacheOptions options;
  options.capture_ms = 20;
  options.machine = builtin_software_costs();
  options.machine->draw_software.triangle_ns *= 50;  // pictures pay
  Frames frames(*made, options);
  const FrameStats& first = frames.draw(0);
  EXPECT_EQ(first.captures, 1);  // the coarse picture
  EXPECT_EQ(first.groups + first.count("nailboard"), 1);
  int captures = 0, quiet = 0;
  // As many frames as it takes: hundreds where a machine is busy.
  for (int frame = 0; frame < 2000 && quiet < 20; ++frame) {
    const int made_now = frames.draw(0).captures;
    captures += made_now;
    quiet = made_now == 0 ? quiet + 1 : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(quiet, 20);
  EXPECT_LE(frames.cache->stats().bound_px, options.error_px);
  EXPECT_GT(captures, 5);
  EXPECT_GT(frames.cache->stats().groups + frames.cache->stats().count("nailboard"), 5);

  // It shows what the cache without a budget does, by other pictures.
  options.capture_ms = 0;
  Frames at_once(*made, options);
  for (int k = 0; k < 20; ++k) at_once.draw(0);
  // Of an eye that stands, texels lie on pixels, whichever pictures they belong to: all but a few
  // are equal (94 dB measured).
  EXPECT_GT(
      psnr_db(frames.cache->software_target()->color(), at_once.cache->software_target()->color()),
      60);
}

// Things move, change and are looked up, and levels are shown, while captures are on their way.
TEST(SoftwareCacheBeside, captures_go_on_while_things_change) {
  auto made = make_builtin("builtin:bridge?triangles=100000");
  ASSERT_TRUE(made.ok());
  for (const bool levels : {false, true}) {
    ImageCacheOptions options;
    options.capture_ms = 4;
    options.levels = levels;
    options.machine = builtin_software_costs();
    options.machine->draw_software.triangle_ns *= 50;
    Frames frames(*made, options);
    int captures = 0;
    for (int frame = 0; frame < 60; ++frame) {
      const FrameStats& stats = frames.draw(frame_time(made->path, frame));
      captures += stats.captures;
      // Pictures that are late, with the errors of levels; the coarse one has texels of two pixels.
      EXPECT_LE(stats.bound_px, SpikePolicy{}.late * options.error_px * (1 + 1e-6));
      EXPECT_LE(stats.picture_bytes, options.max_bytes);
      if (frame % 9 == 8) {
        EXPECT_TRUE(frames.cache->draw_objects().ok());
      }
      if (frame % 11 == 10) frames.cache->cache().invalidate_object(std::uint32_t(frame));
      if (frame == 30) {
        frames.cache->cache().finish_captures();
        for (Light& light : made->scene.lights) light.intensity *= 0.5f;
        frames.cache->cache().invalidate();
      }
      // Captured in the frame again, while others are on their way; and back.
      frames.cache->cache().options().capture_ms = frame % 20 < 15 ? 4 : 0;
      if (frame % 3) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_GT(captures, 20);
  }  // ends with captures on their way
}

}  // namespace
}  // namespace rilievo
