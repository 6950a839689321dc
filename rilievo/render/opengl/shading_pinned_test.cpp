// OpenGL, the rasteriser and rays draw the same, feature by feature.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "rilievo/capture/gl/capture_picture.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/render/raster/raster_picture.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/shading/shading_scenes_test_helpers.h"

namespace rilievo {
namespace {

// Mesa's software driver saves on the levels of textures unless it is asked not to; set before the
// first context of the program.
const int exact =
    setenv("GALLIVM_PERF", "no_rho_approx,no_brilinear,no_quad_lod,no_aos_sampling", 1);

class ShadingPinned : public gl::ContextTest {};

// Rows from the bottom.
std::vector<glm::u8vec4> by_opengl(SceneRenderer& renderer, const Camera& camera, int samples) {
  auto target = FrameTarget::create(camera.width, camera.height, samples);
  EXPECT_TRUE(target.ok());
  target->begin();
  const std::uint32_t all[] = {0};
  renderer.draw_opaque(camera, all, OutputEncoding::srgb);
  target->resolve();
  const Rgba8Image frame = target->read();
  std::vector<glm::u8vec4> rows;
  for (int y = frame.height() - 1; y >= 0; --y)
    rows.insert(rows.end(), frame.row(y).begin(), frame.row(y).end());
  return rows;
}

struct Difference {
  int compared = 0;
  double rms = 0;        // of bytes
  double other = 0;      // the share of texels that differ by more than 4
  glm::dvec3 mean{0.0};  // of a - b
};

// Where `b` is covered in full, and so are its neighbours; or, with its edges, where anything is.
Difference compare(const std::vector<glm::u8vec4>& a, const std::vector<glm::u8vec4>& b, int width,
                   bool edges_too) {
  Difference d;
  const int height = int(a.size()) / width;
  for (int y = 1; y < height - 1; ++y)
    for (int x = 1; x < width - 1; ++x) {
      const int i = y * width + x;
      bool inside = true, empty = true;
      for (const int k : {i, i - 1, i + 1, i - width, i + width}) {
        inside &= b[std::size_t(k)].a == 255;
        empty &= b[std::size_t(k)].a == 0;
      }
      if (empty || !(inside || edges_too)) continue;
      ++d.compared;
      const glm::ivec3 c = glm::ivec3(a[std::size_t(i)]) - glm::ivec3(b[std::size_t(i)]);
      d.mean += glm::dvec3(c);
      d.rms += double(c.x * c.x + c.y * c.y + c.z * c.z) / 3;
      d.other += std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}) > 4;
    }
  const double count = std::max(1, d.compared);
  d.rms = std::sqrt(d.rms / count), d.other /= count, d.mean /= count;
  return d;
}

// sRGB bytes of pictures as they are captured.
void compare_pictures(const ShadingScene& shown, SceneRenderer& renderer, const RayScene& rays) {
  const bool masked = shown.scene.materials[0].alpha_mode == AlphaMode::mask;
  for (const int samples : {1, 4}) {
    SCOPED_TRACE(samples);
    PictureRasterizer rasterizer(shown.scene);
    PictureCaster caster(rays);
    RasterPicture rasterized, cast;
    const std::uint32_t all[] = {0};
    rasterizer.draw(shown.camera, all, rays.poses(), samples, rasterized);
    caster.draw(shown.camera, {}, samples, cast);
    const std::vector<glm::u8vec4> opengl = by_opengl(renderer, shown.camera, samples);

    const int width = shown.camera.width;
    // Samples on an edge of a triangle or of a hole go to either side; else the same numbers but
    // for rounding.
    const Difference between = compare(rasterized.color, cast.color, width, masked);
    EXPECT_GT(between.compared, 500);
    EXPECT_LE(between.other, 0.002);
    // A sample of four that goes to the other side of a hole's edge changes a texel by up to 64.
    EXPECT_LE(between.rms, masked ? 0.7 : 0.5);
    const Difference against = compare(opengl, rasterized.color, width, masked);
    // Levels of textures are rounded to bytes in a way of the driver's own.
    double most_rms = 1.0, most_other = 0.001;
    // With several samples both shade the middle of those that a triangle covers; OpenGL's also of
    // those that another triangle hides.
    if (samples > 1) most_rms = 1.3, most_other = 0.002;
    // A texel whose alpha is the cutoff, nearly, is there or not.
    if (masked) most_rms = 5, most_other = 0.002;
    // OpenGL takes as many samples as the alpha in the texel's middle says, ours each by its own:
    // on the edges of holes one in four may differ, as often one more as one less.
    if (masked && samples > 1) most_rms = 10, most_other = 0.12;
    EXPECT_LE(against.rms, most_rms);
    EXPECT_LE(against.other, most_other);
    for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(against.mean[k]), masked ? 0.5 : 0.25);
  }
}

// One sample a texel, in linear light, of every kind of camera.
void compare_projections(const ShadingScene& shown, SceneRenderer& renderer, const RayScene& rays) {
  // Where alpha is cut, a texel is there or not.
  if (shown.scene.materials[0].alpha_mode == AlphaMode::mask) return;
  for (const Projection kind : {Projection::back_perspective, Projection::parallel}) {
    auto camera = tight_camera(kind, {0.5, 0.8, 4.2}, {0, 1, 0}, world_bounds(shown.scene));
    ASSERT_TRUE(camera.ok());
    camera->width = camera->height = 48;
    const auto drawn = capture_picture(renderer, *camera, {.samples = 1});
    ASSERT_TRUE(drawn.ok());
    const DepthImage cast = cast_picture(rays, *camera);
    int compared = 0, other = 0;
    double sum = 0;
    for (int y = 1; y < 47; ++y)
      for (int x = 1; x < 47; ++x) {
        bool inside = true;
        for (const glm::ivec2 d : {glm::ivec2(0, 0), {1, 0}, {-1, 0}, {0, 1}, {0, -1}})
          inside &= cast.covered(x + d.x, y + d.y) && drawn->covered(x + d.x, y + d.y);
        if (!inside) continue;
        ++compared;
        const glm::vec3 difference =
            glm::abs(glm::vec3(cast.color(x, y)) - glm::vec3(drawn->color(x, y)));
        const float most = std::max({difference.x, difference.y, difference.z});
        other += most > 0.02f;
        sum += double(most) * double(most);
      }
    if (compared < 100) continue;  // a square is not seen from its back
    // Half floats, levels of textures.
    EXPECT_LE(other, compared / 50) << int(kind);
    EXPECT_LE(std::sqrt(sum / compared), 0.006) << int(kind);
  }
}

TEST_F(ShadingPinned, opengl_the_rasterizer_and_rays_draw_the_same) {
  ASSERT_EQ(exact, 0);
  for (const ShadingScene& shown : shading_scenes()) {
    SCOPED_TRACE(shown.name);
    auto renderer = SceneRenderer::create(shown.scene);
    ASSERT_TRUE(renderer.ok()) << renderer.error().message();
    const auto rays = RayScene::create(shown.scene);
    ASSERT_TRUE(rays.ok());
    compare_pictures(shown, *renderer, *rays);
    ASSERT_NO_FATAL_FAILURE(compare_projections(shown, *renderer, *rays));
  }
}

}  // namespace
}  // namespace rilievo
