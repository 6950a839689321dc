// Does any object vanish? What the cache draws is compared with what direct drawing shows, object
// by object.
#include <gtest/gtest.h>

#include <set>

#include "rilievo/cache/gl/scene_test_helpers.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"

namespace rilievo {
namespace {

void add_box(BuiltinScene& made, const glm::vec3& half, const glm::vec3& at) {
  const float i = float(made.scene.objects.size());
  test_shapes::add(made.scene, test_shapes::box(half), {0.2f + 0.06f * i, 0.7f - 0.05f * i, 0.5f},
                   glm::translate(glm::mat4(1), at));
}

// Twelve boxes in a row that leads away.
BuiltinScene row() {
  BuiltinScene made;
  for (int i = 0; i < 12; ++i) add_box(made, glm::vec3(0.4f), {0, 0, -10 - 2 * i});
  finish(made.scene);
  return made;
}

// One near, one far and to the left of it.
BuiltinScene two() {
  BuiltinScene made;
  add_box(made, glm::vec3(1), {0, 0, -10});
  add_box(made, glm::vec3(5), {-20, 0, -100});
  finish(made.scene);
  return made;
}

// Those that have a pixel amid their own: an object's border may be off by a pixel.
std::set<std::uint32_t> objects_amid(const Image<std::uint32_t>& ids) {
  std::set<std::uint32_t> found;
  for (int y = 1; y + 1 < ids.height(); ++y)
    for (int x = 1; x + 1 < ids.width(); ++x) {
      bool amid = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) amid &= ids(x + dx, y + dy) == ids(x, y);
      if (amid) found.insert(ids(x, y));
    }
  return found;
}

class PresenceTest : public SceneTest {
 protected:
  // Returns the pictures that were drawn.
  template <class CameraOf>
  int draw_all(BuiltinScene scene, CaptureBy by, int frames, CameraOf camera_of,
               double capture_ms = 0) {
    load(std::move(scene));
    target = std::make_unique<FrameTarget>(std::move(*FrameTarget::create(640, 360, 4)));
    probe = std::make_unique<ProbeTarget>(std::move(*ProbeTarget::create(640, 360)));
    ImageCacheOptions options;
    options.capture_by = by;
    options.capture_ms = capture_ms;
    auto cache = opengl_cache(*renderer, options);
    EXPECT_TRUE(cache.ok());
    OpenGLFrames direct = opengl_direct(*renderer);
    int pictures = 0;
    double bound_px = 0;
    for (int f = 0; f < frames && cache.ok(); ++f) {
      const Camera camera = camera_of(f);
      frame_of(*cache, camera);
      bound_px = cache->stats().bound_px.value();
      const auto cached = objects_of(*cache);
      const std::set<std::uint32_t> seen(cached.texels().begin(), cached.texels().end());
      pictures += cache->stats().count("nailboard") + cache->stats().groups;
      frame_of(direct, camera);
      for (const std::uint32_t id : objects_amid(objects_of(direct)))
        EXPECT_TRUE(seen.count(id)) << "object " << id << " is missing in frame " << f;
    }
    // The eye stood in the end.
    EXPECT_LE(bound_px, options.error_px);
    return pictures;
  }

  static Camera looking(const glm::dvec3& eye, const glm::dvec3& target) {
    return look_at(eye, target, {0, 1, 0}, 0.6, 640, 360, 0.5, 500);
  }
};

TEST_F(PresenceTest, after_a_cut_no_picture_of_before_stands_for_what_it_would_draw_elsewhere) {
  for (const CaptureBy by : {CaptureBy::opengl, CaptureBy::rasterizer}) {
    const int pictures = draw_all(row(), by, 26, [](int f) {
      return f < 20 ? looking({0, 4, 0}, {0, 0, -14}) : looking({20, 4, -39}, {0, 0, -39});
    });
    EXPECT_GE(pictures, 20);
  }
}

// Where time suffices for nothing, objects are in the coarse picture at first.
TEST_F(PresenceTest, after_a_cut_objects_are_coarse_and_none_is_missing) {
  const int pictures = draw_all(
      row(), CaptureBy::rasterizer, 60,
      [](int f) {
        return f < 30 ? looking({0, 4, 0}, {0, 0, -14}) : looking({20, 4, -39}, {0, 0, -39});
      },
      1e-6);
  EXPECT_GE(pictures, 30);
}

TEST_F(PresenceTest, no_object_vanishes_at_the_frames_edge_during_a_smooth_walk) {
  for (const CaptureBy by : {CaptureBy::opengl, CaptureBy::rasterizer}) {
    const int pictures = draw_all(two(), by, 46, [](int f) {
      const double s = std::max(0, f - 20);
      return looking({0.75 * s, 0, 0}, {-5 - 0.375 * s, 0, -30 - 1.75 * s});
    });
    EXPECT_GT(pictures, 20);
  }
}

}  // namespace
}  // namespace rilievo
