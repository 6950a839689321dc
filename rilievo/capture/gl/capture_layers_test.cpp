#include "rilievo/capture/gl/capture_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/render/rays/cast_layers.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class CaptureLayers : public gl::ContextTest {};

// A parallel camera from this direction.
Result<Camera> parallel_camera(const Box& box, const glm::dvec3& direction, int size) {
  const glm::dvec3 eye = glm::dvec3(box.center()) + 3.0 * double(box.radius()) * direction;
  Result<Camera> camera = tight_camera(Projection::parallel, eye, {0, 1, 0}, box);
  if (camera) camera->width = camera->height = size;
  return camera;
}

// Does a line of sight of `layers` in the texel or beside it have a sample of this object so deep?
bool has_within_one_texel(const LayeredDepthImage& layers, int x, int y, const LayerSample& sample,
                          double tolerance) {
  const int w = layers.camera.width, h = layers.camera.height;
  for (int v = std::max(0, y - 1); v <= std::min(h - 1, y + 1); ++v)
    for (int u = std::max(0, x - 1); u <= std::min(w - 1, x + 1); ++u) {
      const std::size_t i = std::size_t(v) * std::size_t(w) + std::size_t(u);
      for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s)
        if (layers.samples[s].object == sample.object &&
            std::abs(double(layers.samples[s].depth) - double(sample.depth)) <= tolerance)
          return true;
    }
  return false;
}

// The share of samples of `some` that `others` have nowhere within a texel.
double missing(const LayeredDepthImage& some, const LayeredDepthImage& others, double tolerance) {
  const int w = some.camera.width, h = some.camera.height;
  std::size_t absent = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(w) + std::size_t(x);
      for (std::uint64_t s = some.first[i]; s < some.first[i + 1]; ++s)
        absent += !has_within_one_texel(others, x, y, some.samples[s], tolerance);
    }
  return double(absent) / double(some.samples.size());
}

TEST_F(CaptureLayers, depth_peeling_and_rays_see_the_same_within_one_texel) {
  for (const char* spec : {"builtin:fern?triangles=16000", "builtin:fish?triangles=4000",
                           "builtin:teapot?triangles=4000"}) {
    SCOPED_TRACE(spec);
    const auto built = make_builtin(spec);
    ASSERT_TRUE(built) << built.error().message();
    auto renderer = SceneRenderer::create(built->scene);
    ASSERT_TRUE(renderer.ok()) << renderer.error().message();
    const auto rays = RayScene::create(built->scene);
    ASSERT_TRUE(rays);
    const Box box = world_bounds(built->scene);
    auto camera = parallel_camera(box, glm::normalize(glm::dvec3(0.3, 0.4, 1)), 72);
    ASSERT_TRUE(camera);
    std::vector<std::uint32_t> objects(built->scene.objects.size());
    std::iota(objects.begin(), objects.end(), 0u);
    for (const Projection projection : {Projection::parallel, Projection::perspective}) {
      if (projection == Projection::perspective) {
        auto tight = tight_camera(
            projection,
            glm::dvec3(box.center()) + 3.0 * double(box.radius()) * glm::dvec3(0.2, 0.3, 0.9),
            {0, 1, 0}, box);
        ASSERT_TRUE(tight.ok());
        tight->width = tight->height = 64;
        *camera = *tight;
      }
      const auto peeled = capture_layers(*renderer, *camera, objects);
      ASSERT_TRUE(peeled) << peeled.error().message();
      ASSERT_TRUE(validate(*peeled));
      const LayeredDepthImage cast = cast_layers(*rays, *camera);
      ASSERT_GT(cast.samples.size(), 1000u);
      // A texel of depth along slanted surfaces. What is missing are slivers at outlines, which
      // only one of the two meets.
      const double texel = 2.0 * double(box.radius()) / std::max(camera->width, camera->height);
      EXPECT_LE(missing(*peeled, cast, 2 * texel), 0.002);
      EXPECT_LE(missing(cast, *peeled, 2 * texel), 0.002);
      EXPECT_NEAR(double(peeled->samples.size()), double(cast.samples.size()),
                  0.01 * double(cast.samples.size()));
    }
  }
}

// The mean difference of colours of first samples of the same object, of 255.
double color_difference(const LayeredDepthImage& a, const LayeredDepthImage& b) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i + 1 < a.first.size(); ++i) {
    if (a.first[i] == a.first[i + 1] || b.first[i] == b.first[i + 1]) continue;
    const LayerSample &one = a.samples[a.first[i]], &other = b.samples[b.first[i]];
    if (one.object != other.object) continue;
    for (int c = 0; c < 3; ++c) sum += 255 * std::abs(double(one.color[c] - other.color[c]));
    count += 3;
  }
  return sum / double(count);
}

TEST_F(CaptureLayers, layers_for_eyes_all_around_have_wide_highlights_as_by_rays) {
  const auto built = make_builtin("builtin:teapot?triangles=4000");
  ASSERT_TRUE(built);
  auto renderer = SceneRenderer::create(built->scene);
  ASSERT_TRUE(renderer.ok());
  const auto rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  const auto camera = parallel_camera(world_bounds(built->scene), {0, 0, 1}, 72);
  ASSERT_TRUE(camera);
  std::vector<std::uint32_t> objects(built->scene.objects.size());
  std::iota(objects.begin(), objects.end(), 0u);
  const auto peeled = capture_layers(*renderer, *camera, objects, {.least_roughness = 0.9f});
  ASSERT_TRUE(peeled);
  const LayeredDepthImage rough = cast_layers(*rays, *camera, {.least_roughness = 0.9f}),
                          smooth = cast_layers(*rays, *camera);
  // Centres of texels differ by the backends' rounding, most where a sliver begins.
  EXPECT_LT(color_difference(*peeled, rough), 0.5);
  EXPECT_GT(color_difference(*peeled, smooth), 2.0);
}

TEST_F(CaptureLayers, what_lies_together_is_merged_as_by_rays) {
  const auto built = make_builtin("builtin:fern?triangles=16000");
  ASSERT_TRUE(built);
  auto renderer = SceneRenderer::create(built->scene);
  ASSERT_TRUE(renderer.ok());
  const auto rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  const auto camera = parallel_camera(world_bounds(built->scene), {0, 0, 1}, 48);
  ASSERT_TRUE(camera);
  std::vector<std::uint32_t> objects(built->scene.objects.size());
  std::iota(objects.begin(), objects.end(), 0u);
  const double merge = 4 * texel_angle(*camera);
  const auto all = capture_layers(*renderer, *camera, objects);
  const auto merged = capture_layers(*renderer, *camera, objects, {.merge = merge});
  ASSERT_TRUE(all && merged);
  const LayeredDepthImage cast = cast_layers(*rays, *camera, {.merge = merge});
  EXPECT_LT(merged->samples.size(), all->samples.size());
  EXPECT_NEAR(double(merged->samples.size()), double(cast.samples.size()),
              0.02 * double(cast.samples.size()));
  for (std::size_t i = 0; i + 1 < merged->first.size(); ++i)
    for (std::uint64_t s = merged->first[i] + 1; s < merged->first[i + 1]; ++s)
      EXPECT_GT(double(merged->samples[s].depth) - double(merged->samples[s - 1].depth), merge);
  const auto two = capture_layers(*renderer, *camera, objects, {.max_layers = 2});
  ASSERT_TRUE(two);
  for (std::size_t i = 0; i + 1 < two->first.size(); ++i)
    EXPECT_EQ(two->first[i + 1] - two->first[i],
              std::min<std::uint64_t>(2, all->first[i + 1] - all->first[i]));
}

}  // namespace
}  // namespace rilievo
