// Is what was hidden at capture missed for longer than the gap's limit allows? What the cache draws
// is compared with direct drawing, pixel by pixel.
#include <gtest/gtest.h>

#include "rilievo/cache/gl/scene_test_helpers.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"

namespace rilievo {
namespace {

constexpr int kFrames = 80;

// One object: a grey plate, and some metres behind it a red bar that it hides from the first eye.
// Of enough triangles to be worth a picture.
BuiltinScene plate_before_bar() {
  BuiltinScene made;
  Mesh plate = test_shapes::box({1, 1, 0.03f});
  const Mesh face = plate;
  for (int i = 0; i < 400; ++i) {  // small ones inside of it
    const auto first = std::uint32_t(plate.positions.size());
    for (const glm::vec3& p : face.positions) plate.positions.push_back(0.01f * p);
    for (const std::uint32_t index : face.indices) plate.indices.push_back(first + index);
  }
  Material grey, red;
  grey.base_color = {0.3f, 0.3f, 0.3f, 1}, red.base_color = {1, 0, 0, 1};
  grey.unlit = red.unlit = true;
  made.scene.materials = {grey, red};
  plate.material = 0;
  Mesh bar = test_shapes::box({0.12f, 0.8f, 0.05f});
  bar.material = 1;
  made.scene.meshes = {plate, bar};
  Model model;
  model.parts.push_back({0, glm::mat4(1)});
  model.parts.push_back({1, glm::translate(glm::mat4(1), glm::vec3(1.0f, 0, -3))});
  made.scene.models.push_back(model);
  made.scene.objects.emplace_back();
  finish(made.scene);
  return made;
}

bool is_red(const glm::u8vec4& c) { return c.r > 150 && c.g < 60; }

// The longest run in a row of pixels that are red in `truth` and not in `seen`.
int widest_missing(const Rgba8Image& truth, const Rgba8Image& seen) {
  int widest = 0;
  for (int y = 0; y < truth.height(); ++y) {
    int run = 0;
    for (int x = 0; x < truth.width(); ++x) {
      run = is_red(truth(x, y)) && !is_red(seen(x, y)) ? run + 1 : 0;
      widest = std::max(widest, run);
    }
  }
  return widest;
}

class HiddenTest : public SceneTest {
 protected:
  struct Walk {
    int widest = 0, captures = 0, red_frames = 0, pictures = 0;
    double bound = 0;
  };
  // Sideways, past the plate, the eye on it.
  Walk walk(CaptureBy by, double gap_px) {
    load(plate_before_bar());
    ImageCacheOptions options;
    options.capture_by = by;
    options.gap_px = gap_px;
    options.fade_frames = 1;
    auto cache = opengl_cache(*renderer, options);
    EXPECT_TRUE(cache.ok());
    OpenGLFrames direct = opengl_direct(*renderer);
    Walk walk;
    for (int f = 0; f < kFrames && cache.ok(); ++f) {
      const glm::dvec3 eye(0.03 * f, 0.2, 10);
      const Camera camera = look_at(eye, {0, 0, -1}, {0, 1, 0}, 0.35, 320, 180, 0.5, 50);
      const Rgba8Image seen = frame_of(*cache, camera);
      walk.captures += cache->stats().captures;
      walk.pictures += cache->stats().count("nailboard");
      walk.bound = std::max(walk.bound, cache->stats().gap_px);
      const Rgba8Image truth = frame_of(direct, camera);
      int red = 0;
      for (const glm::u8vec4& c : truth.texels()) red += is_red(c);
      walk.red_frames += red > 0;
      walk.widest = std::max(walk.widest, widest_missing(truth, seen));
    }
    return walk;
  }
};

TEST_F(HiddenTest, what_a_plate_hid_at_capture_is_missed_by_no_wider_strip_than_allowed) {
  for (const CaptureBy by : {CaptureBy::opengl, CaptureBy::rasterizer}) {
    const Walk bounded = walk(by, 0);
    EXPECT_GT(bounded.red_frames, kFrames / 4);
    EXPECT_GT(bounded.pictures, kFrames / 2);
    EXPECT_LE(bounded.bound, 2.0);
    // Half a pixel at either end of the strip, and one by which the picture itself may be off.
    EXPECT_LE(bounded.widest, 3);
    const Walk open = walk(by, std::numeric_limits<double>::infinity());
    EXPECT_GT(open.widest, 5);
    EXPECT_GT(bounded.captures, open.captures);
  }
}

}  // namespace
}  // namespace rilievo
