// What a placement flattens is drawn as a sheet by OpenGL: as the same object is that is thin.
#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/gl/context.h"
#include "rilievo/render/flat_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {
namespace {

Rgba8Image drawn_by_opengl(const Scene& scene, double time) {
  Result<SceneRenderer> renderer = SceneRenderer::create(scene);
  EXPECT_TRUE(renderer.ok());
  Result<FrameTarget> target = FrameTarget::create(61, 53, 4);
  EXPECT_TRUE(target.ok());
  target->begin();
  renderer->set_time(time);
  const std::uint32_t cube[] = {0};
  renderer->draw_opaque(test::cube_camera(), cube, OutputEncoding::srgb);
  target->resolve();
  return target->read();
}

TEST(FlatObjectsByOpenGL, are_sheets_lit_as_thin_ones) {
  Result<std::unique_ptr<gl::Context>> context = gl::Context::create();
  ASSERT_TRUE(context.ok());
  const Rgba8Image none = drawn_by_opengl(test::scaled_cube({0, 0, 0}), 0);
  for (const glm::dvec3& scale : test::flat_scales()) {
    const Rgba8Image flat = drawn_by_opengl(test::scaled_cube(scale), 0);
    const Rgba8Image thin = drawn_by_opengl(test::scaled_cube(test::thickened(scale)), 0);
    int differ = 0, shown = 0, dark = 0;
    for (std::size_t i = 0; i < flat.texels().size(); ++i) {
      const glm::ivec4 a(flat.texels()[i]), b(thin.texels()[i]), empty(none.texels()[i]);
      const bool covered = a != empty;
      shown += covered;
      dark += covered && a.r + a.g + a.b < 20;  // a normal that is none
      const glm::ivec4 apart = glm::abs(a - b);
      differ += std::max({apart.r, apart.g, apart.b}) > 1;
    }
    EXPECT_EQ(shown > 250, test::is_sheet(scale)) << shown;
    EXPECT_EQ(dark, 0);
    // Beside an edge, 1e-5 metres of thickness may cover a sample.
    EXPECT_LT(differ, 16);
    EXPECT_TRUE(drawn_by_opengl(test::squashed_cube(glm::vec3(scale)), 1) == flat);
  }
}

}  // namespace
}  // namespace rilievo
