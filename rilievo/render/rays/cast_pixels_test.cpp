#include "rilievo/render/rays/cast_pixels.h"

#include <gtest/gtest.h>

#include <vector>

#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

TEST(PixelCaster, SamplesAreThoseOfWholePictures) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  const Result<RayScene> rays = RayScene::create(made.scene);
  ASSERT_TRUE(rays);
  const Camera camera = camera_at(made.path, 0, 90, 60);
  std::vector<FramePixel> pixels;
  for (int i = 0; i < 90 * 60; i += 7)
    pixels.push_back({std::uint16_t(i % 90), std::uint16_t(i / 90)});
  std::vector<std::uint32_t> objects(made.scene.objects.size());
  for (std::uint32_t i = 0; i < objects.size(); ++i) objects[i] = i;
  PictureCaster whole(*rays);
  PixelCaster caster(*rays);
  for (const int samples : {1, 4}) {
    whole.cast(camera, samples);
    caster.cast(camera, samples, pixels, objects);
    const double near = 1 / camera.z_near, range = near - 1 / camera.z_far;
    std::size_t at = 0;
    int shown = 0;
    for (const FramePixel pixel : pixels)
      for (int s = 0; s < samples; ++s, ++at) {
        const std::size_t of = whole.seen().row(59 - pixel.y) +
                               std::size_t(pixel.x) * std::size_t(samples) + std::size_t(s);
        const float depth = whole.seen().depth[of];
        ASSERT_EQ(depth<1, caster.inverse_z()[at]> 0);
        if (!(depth < 1)) continue;
        ++shown;
        EXPECT_EQ(whole.seen().triangle[of], caster.triangles()[at]);
        // window_z has 24 bits.
        EXPECT_NEAR(caster.inverse_z()[at], near - double(depth) * range, near * 1e-6);
      }
    EXPECT_GT(shown, 100);
  }
  // Only the objects that are named.
  caster.cast(camera, 1, pixels, std::span(objects).first(1));
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (caster.inverse_z()[i] > 0) {
      EXPECT_EQ(caster.object_of(caster.triangles()[i]), 0u);
    }
}

}  // namespace
}  // namespace rilievo
