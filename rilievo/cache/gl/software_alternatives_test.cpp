// Does the cache without OpenGL choose what was baked as the one with OpenGL does, and draw it the
// same?
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rilievo/cache/gl/software_test_helpers.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/representation/bake_objects.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/kinds.h"
#include "rilievo/representation/software/software_factories.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

struct BakeSetting {
  const char *name, *value;
};

class SoftwareAlternativesTest : public SceneTest {
 protected:
  // Bakes each object for one of the two caches, or all of them as one: by rays for both, so that
  // both have the same.
  void add_baked(TestSource& source_of, std::span<const DrawableRow> rows, const char* kind_name,
                 std::span<const BakeSetting> settings, bool together = false) {
    const Kind& kind = *find_kind(kinds(), kind_name);
    ObjectDrawablesOptions options{.bake = OptionValues(kind.bake_options),
                                   .draw = OptionValues(kind.draw_options),
                                   .progress = {}};
    for (const auto& [name, value] : settings) ASSERT_TRUE(options.bake.set(name, value).ok());
    const auto rays = RayScene::create(builtin.scene);
    ASSERT_TRUE(rays.ok());
    RaySource source(*rays);
    auto factory = make_factory(rows, kind.name);
    ASSERT_TRUE(factory.ok());
    if (together) {
      auto one = bake_together_drawable(renderer->placed(), source, kind, **factory, options);
      ASSERT_TRUE(one.ok()) << one.error().message();
      source_of.cache().add_surroundings(std::move(one->drawable), std::move(*factory),
                                         std::move(one->objects));
      return;
    }
    auto made = bake_object_drawables(renderer->placed(), source, kind, **factory, options);
    ASSERT_TRUE(made.ok()) << made.error().message();
    ASSERT_FALSE(made->empty());
    source_of.cache().add_alternatives(std::move(*made), std::move(*factory));
  }

  // Around the scene at `distance` times its radius, by 0.1 radians a frame: a flat picture of
  // something deep lasts no frame.
  [[nodiscard]] Camera camera_of(int frame, double distance) const {
    const Box box = world_bounds(builtin.scene);
    const glm::dvec3 center(box.center());
    const double radius = double(box.radius()), angle = 0.5 + 0.1 * frame;
    return look_at(center + distance * radius *
                                glm::normalize(glm::dvec3(std::sin(angle), 0.25, std::cos(angle))),
                   center, {0, 1, 0}, 0.7, kWidth, kHeight, 0.05 * radius, 20 * radius);
  }

  void expect_same_frames(const char* kind, std::span<const BakeSetting> settings,
                          const ImageCacheOptions& options, double distance,
                          bool together = false) {
    auto opengl = opengl_cache(*renderer, options);
    auto memory = software_cache(builtin.scene, options);
    ASSERT_TRUE(opengl.ok() && memory.ok());
    ASSERT_NO_FATAL_FAILURE(add_baked(*opengl, drawable_rows(), kind, settings, together));
    ASSERT_NO_FATAL_FAILURE(
        add_baked(**memory, software_drawable_rows(), kind, settings, together));
    int chosen = 0;
    for (int frame = 0; frame < 10; ++frame) {
      SCOPED_TRACE(frame);
      const Camera camera = camera_of(frame, distance);
      const Rgba8Image truth = frame_of(*opengl, camera);
      ASSERT_TRUE((*memory)->draw(camera, 0).ok());
      const FrameStats &a = opengl->stats(), &b = (*memory)->stats();
      const int shown = together ? b.groups : b.count(kind);
      EXPECT_EQ(together ? a.groups : a.count(kind), shown);
      EXPECT_EQ(a.captures, b.captures);
      EXPECT_EQ(a.polygons, b.polygons);
      EXPECT_EQ(a.count("nailboard"), b.count("nailboard"));
      EXPECT_DOUBLE_EQ(a.bound_px.value(), b.bound_px.value());
      EXPECT_LE(b.bound_px, options.error_px);
      if (shown == 0 || b.captures > 0) continue;
      ++chosen;
      EXPECT_GT(b.bound_px, 0);
      const auto objects = objects_of(*opengl);
      const Rgba8Image drawn = (*memory)->software_target()->color();
      const Alike same = compare_frames(truth, drawn, objects);
      EXPECT_GT(same.inner, 0.2);
      // As for every kind (software_kinds_test.cpp).
      EXPECT_GE(same.alike, 0.999);
      EXPECT_GT(psnr_db(truth, drawn), 45);
      ASSERT_TRUE((*memory)->draw_objects().ok());
      EXPECT_LE(wrong_inside(objects, (*memory)->software_target()->objects()),
                kWidth * kHeight / 1000);
    }
    EXPECT_GE(chosen, 3);  // others are captured for, at the costs of both
  }
};

TEST_F(SoftwareAlternativesTest, a_layered_relief_stands_for_a_deep_object_near_the_eye) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:fern?triangles=400000"));
  ImageCacheOptions options;
  options.error_px = 4;
  options.capture_by = CaptureBy::rasterizer;
  options.machine = costs_of_both();
  options.learn = false;  // OpenGL does not
  const BakeSetting settings[] = {{"textures", "6"}, {"size", "320"}};
  expect_same_frames("layered-relief", settings, options, 2.2);
}

TEST_F(SoftwareAlternativesTest, one_relief_stands_for_a_thing_of_many_parts) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=1000000"));
  ASSERT_GT(builtin.scene.objects.size(), 3u);
  ImageCacheOptions options;
  options.error_px = 6;
  options.capture_by = CaptureBy::rasterizer;
  options.machine = costs_of_both();
  options.learn = false;  // OpenGL does not
  const BakeSetting settings[] = {{"textures", "6"}, {"size", "320"}};
  expect_same_frames("layered-relief", settings, options, 2.2, true);
}

TEST_F(SoftwareAlternativesTest, a_layered_impostor_stands_for_a_heavy_object) {
  BuiltinScene ring;
  test_shapes::add(ring.scene, test_shapes::torus(1.0, 0.3, 1000, 700), {0.8f, 0.5f, 0.2f});
  finish(ring.scene);
  ASSERT_NO_FATAL_FAILURE(load(std::move(ring)));
  ImageCacheOptions options;
  options.error_px = 4;
  options.capture_by = CaptureBy::rasterizer;
  options.machine = costs_of_both();
  options.learn = false;  // OpenGL does not
  const BakeSetting settings[] = {{"views", "12"}, {"size", "128"}, {"no-fills", "on"}};
  expect_same_frames("layered-impostor", settings, options, 3);
}

TEST_F(SoftwareAlternativesTest, frames_without_one_stay_the_same_byte_for_byte) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:fern?triangles=100000"));
  const ImageCacheOptions options;
  const auto make = [&] { return std::move(*software_cache(builtin.scene, options)); };
  const auto none = make(), empty = make(), coarse = make(), dropped = make();
  auto factory = make_factory(software_drawable_rows(), "layered-relief");
  ASSERT_TRUE(factory.ok());
  empty->cache().add_alternatives({}, std::move(*factory));
  // Texels of a tenth of the object: never within a pixel.
  const BakeSetting settings[] = {{"textures", "6"}, {"size", "10"}};
  for (TestSource* cache : {coarse.get(), dropped.get()}) {
    ASSERT_NO_FATAL_FAILURE(
        add_baked(*cache, software_drawable_rows(), "layered-relief", settings));
  }
  EXPECT_EQ(none->stats().picture_bytes, 0u);
  dropped->cache().invalidate();
  for (int frame = 0; frame < 5; ++frame) {
    const Camera camera = camera_of(frame, 2.2);
    ASSERT_TRUE(none->draw(camera, 0).ok());
    for (TestSource* cache : {empty.get(), coarse.get(), dropped.get()}) {
      ASSERT_TRUE(cache->draw(camera, 0).ok());
      EXPECT_EQ(cache->stats().count("layered-relief"), 0);
      EXPECT_EQ(cache->stats().bound_px, none->stats().bound_px);
      EXPECT_TRUE(cache->software_target()->color() == none->software_target()->color());
      EXPECT_TRUE(cache->software_target()->inverse_z() == none->software_target()->inverse_z());
    }
    EXPECT_GT(coarse->stats().picture_bytes, none->stats().picture_bytes);
    EXPECT_EQ(dropped->stats().picture_bytes, none->stats().picture_bytes);
  }
}

}  // namespace
}  // namespace rilievo
