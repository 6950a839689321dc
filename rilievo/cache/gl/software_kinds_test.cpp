// Do processors draw what stands for objects as OpenGL does: every kind, what blends, outlines?
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "rilievo/cache/gl/software_test_helpers.h"
#include "rilievo/cache/software/blended_scene_test_helpers.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/method/objects.h"
#include "rilievo/nailboard/software/software_boards.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/rays/ray_visibility.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/kinds.h"
#include "rilievo/representation/software/software_factories.h"

namespace rilievo {
namespace {

class SoftwareKindsTest : public AlikeTest {
 protected:
  // Bakes a representation of the scene; its instance is drawn by both.
  std::unique_ptr<Representation> bake(const Kind& kind, const OptionValues& options,
                                       Box eyes = {}) {
    OpenGLSource source(*renderer);
    auto baked = kind.bake({source, {}, eyes}, options, {});
    EXPECT_TRUE(baked.ok()) << baked.error().message();
    return std::move(baked->representation);
  }

  // Draws `kind` by both backends, seen by each camera. `make` makes the same representation twice.
  void expect_kind_same(const char* name,
                        const std::function<std::unique_ptr<Representation>()>& make,
                        const OptionValues& draw_options, std::span<const Camera> cameras,
                        double least_alike = kLeastAlike) {
    auto by_gl = make_factory(drawable_rows(), name);
    auto by_tiles = make_factory(software_drawable_rows(), name);
    ASSERT_TRUE(by_gl.ok() && by_tiles.ok());
    std::unique_ptr<Representation> first = make();
    const Instance instance{glm::dmat4(1.0), 0, first->only_object()};
    auto a = (*by_gl)->make_drawable(std::move(first), draw_options);
    auto b = (*by_tiles)->make_drawable(make(), draw_options);
    ASSERT_TRUE(a.ok() && b.ok());
    OpenGLFrames opengl = opengl_stored(*renderer, std::move(*a), {instance}, false);
    TestSource software = software_stored(builtin.scene, 4, std::move(*b), {instance}, false);
    least_alike_ = least_alike;
    for (const Camera& camera : cameras) expect_same(opengl, software, camera, 0.2);
    least_alike_ = kLeastAlike;
  }
};

// Cameras around the scene.
std::vector<Camera> cameras_around(const Scene& scene, int count, std::uint64_t seed) {
  Random random(seed);
  const Box bounds = world_bounds(scene);
  const glm::dvec3 center(bounds.center());
  const double radius = double(bounds.radius());
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 to(random.between(-1, 1), random.between(0.1f, 0.6f), random.between(-1, 1));
    cameras.push_back(look_at(center + 3.0 * radius * glm::normalize(to), center, {0, 1, 0}, 0.7,
                              kWidth, kHeight, 0.05 * radius, 30 * radius));
  }
  return cameras;
}

TEST_F(SoftwareKindsTest, layered_reliefs) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:fish?triangles=8000"));
  const Kind& kind = *find_kind(kinds(), "layered-relief");
  OptionValues options(kind.bake_options);
  ASSERT_TRUE(options.set("textures", "6").ok() && options.set("size", "256").ok());
  expect_kind_same(
      "layered-relief", [&] { return bake(kind, options); }, OptionValues(kind.draw_options),
      cameras_around(builtin.scene, 4, 1));
}

TEST_F(SoftwareKindsTest, layered_impostors) {
  // Along silhouettes OpenGL looks at the samples of other pixels, and asks more pictures for those
  // of a pixel whose centre shows something (40.5 dB at least).
  least_db_ = 39;
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=20000"));
  const Kind& kind = *find_kind(kinds(), "layered-impostor");
  OptionValues options(kind.bake_options);
  ASSERT_TRUE(options.set("no-fills", "on").ok());
  ASSERT_TRUE(options.set("views", "12").ok() && options.set("size", "96").ok());
  expect_kind_same(
      "layered-impostor", [&] { return bake(kind, options); }, OptionValues(kind.draw_options),
      cameras_around(builtin.scene, 4, 3));
}

TEST_F(SoftwareKindsTest, slices_of_layered_impostors) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=20000"));
  const Kind& kind = *find_kind(kinds(), "layered-impostor");
  OptionValues bake_options(kind.bake_options), draw_options(kind.draw_options);
  ASSERT_TRUE(bake_options.set("views", "12").ok() && bake_options.set("size", "96").ok());
  ASSERT_TRUE(draw_options.set("warp", "slices").ok());
  expect_kind_same(
      "layered-impostor", [&] { return bake(kind, bake_options); }, draw_options,
      cameras_around(builtin.scene, 4, 3));
}

TEST_F(SoftwareKindsTest, environment_nodes) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:stonehenge?triangles=30000"));
  const Kind& kind = *find_kind(kinds(), "environment-nodes");
  OptionValues options(kind.bake_options);
  ASSERT_TRUE(options.set("face", "128").ok());
  const Camera start = camera_at(builtin.path, 0, kWidth, kHeight);
  const glm::vec3 eye(start.position());
  const Box eyes{eye - 2.0f, eye + 2.0f};
  std::vector<Camera> cameras;
  for (const int frame : {0, 4, 8}) {
    const double time = frame_time(builtin.path, frame);
    cameras.push_back(camera_at(builtin.path, time, kWidth, kHeight));
  }
  const std::unique_ptr<Representation> baked = bake(kind, options, eyes);
  const auto& nodes = dynamic_cast<const EnvironmentRepresentation&>(*baked).nodes;
  const auto copy = [&] { return std::make_unique<EnvironmentRepresentation>(nodes); };
  for (const auto& [merge, gaps] : {std::pair{"positional", false},
                                    {"positional", true},
                                    {"layering", false},
                                    {"layering", true},
                                    {"binary", false},
                                    {"weighted", true},
                                    {"first", true}}) {
    SCOPED_TRACE(std::string(merge) + (gaps ? ", gaps" : ""));
    OptionValues draw(kind.draw_options);
    ASSERT_TRUE(draw.set("merge", merge).ok());
    // Of a third node software draws only what is needed, OpenGL all.
    ASSERT_TRUE(draw.set("more", "0").ok());
    if (gaps) {
      ASSERT_TRUE(draw.set("gaps", "on").ok());
    }
    // Where the surfaces of two nodes are one, rounding decides which is in front, a few pixels at
    // a time: where one is drawn over the other, 0.1 % of them. Silhouettes of merged nodes OpenGL
    // finds by edges of the meshes, software by samples (36.6 dB at least, 128 texels a face).
    const bool merged = std::string_view(merge) != "layering";
    least_db_ = merged ? 36 : kLeastDb;
    expect_kind_same("environment-nodes", copy, draw, cameras, merged ? kLeastAlike : 0.9985);
  }
}

TEST_F(SoftwareKindsTest, relief_impostors) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=20000"));
  const auto content = [&] { return make_impostor_content(builtin.scene, 0.0, {}); };
  ImpostorFramesOptions options;
  options.workers.size = 256;
  auto first = content();
  ASSERT_TRUE(first.ok());
  auto opengl = opengl_impostors(*renderer, std::move(*first), options);
  auto software = software_chosen(
      builtin.scene, 4, [&](const PlacedScene& placed) -> Result<std::unique_ptr<FrameChooser>> {
        auto second = content();
        if (!second) return second.error();
        return {std::make_unique<ImpostorChooser>(placed, std::make_unique<SoftwareBoards>(),
                                                  std::move(*second), options)};
      });
  ASSERT_TRUE(opengl.ok() && software.ok());
  int shown = 0;
  for (const Camera& camera : cameras_around(builtin.scene, 3, 4)) {
    expect_same(*opengl, **software, camera, 0.2);
    shown += (*software)->stats().count(kReliefImpostorName);
  }
  EXPECT_GT(shown, 0);
}

// Objects baked one by one, chosen by the same code.
TEST_F(SoftwareKindsTest, baked_objects_of_a_scene) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=20000"));
  const Kind& kind = *find_kind(kinds(), "layered-impostor");
  ObjectFramesOptions options;
  options.objects.bake = OptionValues(kind.bake_options);
  options.objects.draw = OptionValues(kind.draw_options);
  ASSERT_TRUE(options.objects.bake.set("views", "12").ok());
  ASSERT_TRUE(options.objects.bake.set("size", "32").ok());
  options.max_texel_px = 1e9;
  const auto rays = RayScene::create(builtin.scene);
  ASSERT_TRUE(rays.ok());
  RaySource source(*rays);
  const auto chooser = [&](const PlacedScene& placed, std::span<const DrawableRow> rows) {
    auto factory = make_factory(rows, kind.name);
    EXPECT_TRUE(factory.ok());
    auto made = ObjectChooser::create(placed, source, kind, std::move(*factory), options);
    EXPECT_TRUE(made.ok());
    return std::unique_ptr<FrameChooser>(std::move(*made));
  };
  OpenGLFrames opengl(*renderer, chooser(renderer->placed(), drawable_rows()));
  auto software = software_chosen(
      builtin.scene, 4, [&](const PlacedScene& placed) -> Result<std::unique_ptr<FrameChooser>> {
        return chooser(placed, software_drawable_rows());
      });
  ASSERT_TRUE(software.ok());
  // Along silhouettes they differ: see layered_impostors.
  least_db_ = 42;
  for (const Camera& camera : cameras_around(builtin.scene, 3, 6))
    expect_same(opengl, **software, camera, 0.2);
  EXPECT_GT((*software)->stats().count(kind.name), 0);
}

TEST_F(SoftwareKindsTest, what_blends) {
  ASSERT_NO_FATAL_FAILURE(load(blended_scene()));
  OpenGLFrames direct = opengl_direct(*renderer);
  TestSource software = software_direct(builtin.scene, 4);
  std::vector<Camera> cameras = cameras_around(builtin.scene, 4, 2);
  // Among them: some reach behind the eye.
  const Box bounds = world_bounds(builtin.scene);
  cameras.push_back(look_at(glm::dvec3(bounds.center()) + glm::dvec3(0, 0.1, 0),
                            glm::dvec3(bounds.center()) + glm::dvec3(1, 0, 0.4), {0, 1, 0}, 0.9,
                            kWidth, kHeight, 0.05, 100));
  for (const Camera& camera : cameras) expect_same(direct, software, camera, 0.1);
}

TEST_F(SoftwareKindsTest, polygons_by_rays) {
  for (const bool blended : {false, true}) {
    SCOPED_TRACE(blended);
    if (blended)
      ASSERT_NO_FATAL_FAILURE(load(blended_scene()));
    else
      ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=20000"));
    OpenGLFrames direct = opengl_direct(*renderer);
    auto rays = RayVisibility::create(builtin.scene);
    ASSERT_TRUE(rays.ok());
    TestSource software = software_direct(builtin.scene, 4, std::move(*rays));
    for (const Camera& camera : cameras_around(builtin.scene, 4, 5))
      expect_same(direct, software, camera, 0.1);
  }
}

TEST_F(SoftwareKindsTest, outlines) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:forest?triangles=200000"));
  ImageCacheOptions options;
  options.capture_by = CaptureBy::rasterizer;
  options.machine = costs_of_both();
  options.learn = false;  // OpenGL does not
  options.outlines = true;
  auto opengl = opengl_cache(*renderer, options);
  auto memory = software_cache(builtin.scene, options);
  ASSERT_TRUE(opengl.ok() && memory.ok());
  int yellow = 0, both = 0;
  for (int frame = 0; frame < 3; ++frame) {
    const Rgba8Image truth = frame_of(*opengl, frame);
    const Rgba8Image drawn = software_frame_of(**memory, builtin, frame);
    for (std::size_t i = 0; i < truth.texels().size(); ++i) {
      const auto is_line = [](const glm::u8vec4& c) { return c.r > 200 && c.g > 180 && c.b < 90; };
      if (!is_line(truth.texels()[i])) continue;
      ++yellow;
      both += is_line(drawn.texels()[i]);
    }
    EXPECT_GT(psnr_db(truth, drawn), kLeastDb);
  }
  EXPECT_GT(yellow, 300);
  // The others are at ends of lines, or where a picture is about as near as its line.
  EXPECT_GT(both, 0.98 * yellow);
}

}  // namespace
}  // namespace rilievo
