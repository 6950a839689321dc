// Pictures from OpenGL against pictures from rays: the same cameras, the same surfaces.
#include "rilievo/layered_impostor/bake.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/gl/context_test_helpers.h"

namespace rilievo {
namespace {

class BakeLayered : public gl::ContextTest {};

TEST_F(BakeLayered, shows_what_rays_show) {
  const Scene scene = test_shapes::jug();
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  BakeOptions options;
  options.views.spread = ViewSpread::faces_12;
  options.camera.size = 64;
  options.slicing.layers = 24;
  int last = -1, total = 0;
  options.progress = [&](int done, int of) {
    EXPECT_EQ(done, last + 1);
    last = done;
    total = of;
  };
  OpenGLSource source(*renderer);
  const auto baked = bake_layered(source, {}, options);
  ASSERT_TRUE(baked.ok()) << baked.error().message();
  EXPECT_EQ(last, 12);
  EXPECT_EQ(total, 12);
  EXPECT_EQ(baked->views.directions.size(), 12u);
  EXPECT_FALSE(baked->fills.empty());
  // Views that are tight around the object know that nothing is beside it.
  for (std::size_t v = 0; v < baked->pictures.size(); ++v) EXPECT_TRUE(baked->complete[v]) << v;

  const auto cast = test_shapes::cast_views(scene, make_view_set(options.views), options.camera);
  ASSERT_EQ(cast.size(), baked->pictures.size());
  const float radius = float(world_bounds(scene).radius());
  std::size_t texels = 0, other = 0;
  for (std::size_t v = 0; v < cast.size(); ++v) {
    const DepthImage &ours = baked->pictures[v], &theirs = cast[v];
    EXPECT_EQ(ours.camera.width, theirs.camera.width);
    for (std::size_t i = 0; i < theirs.depth.texels().size(); ++i) {
      const float a = ours.depth.texels()[i], b = theirs.depth.texels()[i];
      if (a == kNoDepth && b == kNoDepth) continue;
      ++texels;
      // The rasteriser snaps vertices to 1/256 of a texel: only at edges may that change what the
      // texel shows; within a surface it moves the depth by a small part of a texel's slope.
      const bool same = (a == kNoDepth) == (b == kNoDepth) &&
                        (a == kNoDepth || std::abs(a - b) <= 2e-3f * radius);
      if (!same) ++other;
    }
  }
  EXPECT_GT(texels, 10000u);
  EXPECT_LE(double(other), 0.01 * double(texels));
}

TEST_F(BakeLayered, nothing_to_see_is_an_error) {
  const Scene scene;
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok());
  OpenGLSource source(*renderer);
  const auto baked = bake_layered(source, {});
  ASSERT_FALSE(baked.ok());
  EXPECT_NE(baked.error().message().find("nothing opaque"), std::string::npos);
}

}  // namespace
}  // namespace rilievo
