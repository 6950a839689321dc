// Does each kind look the same to the byte, whatever the number of threads and the instruction set?
//
// All that is drawn without OpenGL, from the bake on: what one run draws, runs with 1, 2 and 3
// threads and with every instruction set draw. tools/check_threads looks for races in it.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "rilievo/cache/software/blended_scene_test_helpers.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/environment_nodes/node_test_helpers.h"
#include "rilievo/method/objects.h"
#include "rilievo/method/relief_impostors.h"
#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/nailboard/software/software_boards.h"
#include "rilievo/nailboard/software/software_pictures.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/rays/ray_visibility.h"
#include "rilievo/render/shading/simd_test_helpers.h"
#include "rilievo/representation/bake_objects.h"
#include "rilievo/representation/kinds.h"
#include "rilievo/representation/software/software_factories.h"

namespace rilievo {
namespace {

constexpr int kSameWidth = 160, kSameHeight = 90;

// What frames look like, and how many instances of a kind they show.
struct DrawnFrames {
  std::vector<Rgba8Image> colors;
  std::vector<Image<float>> depths;
  std::vector<Image<std::uint32_t>> objects;
  int instances = 0;

  friend bool operator==(const DrawnFrames&, const DrawnFrames&) = default;
};

// Makes what draws, drawn from the start in each run.
using MakeFrames = std::function<std::unique_ptr<FrameSource>()>;

DrawnFrames draw_frames(const MakeFrames& make, std::span<const Camera> cameras,
                        std::string_view kind) {
  DrawnFrames drawn;
  const std::unique_ptr<FrameSource> frames = make();
  if (!frames) return drawn;
  for (const Camera& camera : cameras) {
    EXPECT_TRUE(frames->draw(camera, 0).ok());
    drawn.colors.push_back(frames->software_target()->color());
    drawn.depths.push_back(frames->software_target()->inverse_z());
    EXPECT_TRUE(frames->draw_objects().ok());
    drawn.objects.push_back(frames->software_target()->objects());
    drawn.instances += frames->stats().count(kind);
  }
  return drawn;
}

// `kind` is among what is drawn; empty: polygons alone.
void expect_same_everywhere(const MakeFrames& make, std::span<const Camera> cameras,
                            std::string_view kind) {
  const DrawnFrames truth = draw_frames(make, cameras, kind);
  ASSERT_EQ(truth.colors.size(), cameras.size());
  EXPECT_EQ(truth.instances > 0, !kind.empty());
  // It shows something: another frame is another picture.
  EXPECT_NE(truth.colors.front(), truth.colors.back());
  for (const int threads : {1, 2, 3}) {
    SCOPED_TRACE(threads);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(threads));
    tbb::task_arena(threads).execute(
        [&] { EXPECT_TRUE(draw_frames(make, cameras, kind) == truth); });
  }
  for_each_instruction_set([&](const char* name) {
    SCOPED_TRACE(name);
    EXPECT_TRUE(draw_frames(make, cameras, kind) == truth);
  });
}

// From around the scene, nearer and nearer.
std::vector<Camera> eyes_around(const Scene& scene, int count = 3) {
  const Box box = world_bounds(scene);
  const glm::dvec3 center(box.center());
  const double radius = double(box.radius());
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i) {
    const double angle = 0.5 + 0.4 * i;
    const glm::dvec3 to(std::sin(angle), 0.3, std::cos(angle));
    cameras.push_back(look_at(center + (3.0 - 0.5 * i) * radius * glm::normalize(to), center,
                              {0, 1, 0}, 0.7, kSameWidth, kSameHeight, 0.05 * radius, 30 * radius));
  }
  return cameras;
}

struct Setting {
  const char *name, *value;
};

class SoftwareSame : public testing::Test {
 protected:
  void load(const char* spec) {
    auto made = make_builtin(spec);
    ASSERT_TRUE(made.ok());
    load(std::move(*made));
  }
  void load(BuiltinScene scene) {
    builtin = std::move(scene);
    auto cast = RayScene::create(builtin.scene);
    ASSERT_TRUE(cast.ok());
    rays.emplace(std::move(*cast));
  }
  // Each object baked as this kind, by rays. Settings are of baking or drawing.
  [[nodiscard]] MakeFrames baked(const char* name, std::span<const Setting> settings,
                                 bool outlines = false) {
    return [=, this, settings = std::vector<Setting>(settings.begin(), settings.end())] {
      const Kind& kind = *find_kind(kinds(), name);
      ObjectFramesOptions options{
          {OptionValues(kind.bake_options), OptionValues(kind.draw_options)}, 1e9, outlines};
      for (const auto& [option, value] : settings) {
        OptionValues& values =
            options.objects.bake.has(option) ? options.objects.bake : options.objects.draw;
        EXPECT_TRUE(values.set(option, value).ok());
      }
      auto factory = make_factory(software_drawable_rows(), name);
      RaySource source(*rays);
      auto frames =
          software_chosen(builtin.scene, 4,
                          [&](const PlacedScene& placed) -> Result<std::unique_ptr<FrameChooser>> {
                            auto chooser = ObjectChooser::create(placed, source, kind,
                                                                 std::move(*factory), options);
                            if (!chooser) return chooser.error();
                            return {std::move(*chooser)};
                          });
      EXPECT_TRUE(frames.ok()) << frames.error().message();
      return std::unique_ptr<FrameSource>(frames.ok() ? std::move(*frames) : nullptr);
    };
  }

  BuiltinScene builtin;
  std::optional<RayScene> rays;
};

TEST_F(SoftwareSame, layered_reliefs) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:fish?triangles=8000"));
  const Setting settings[] = {{"textures", "6"}, {"size", "64"}};
  expect_same_everywhere(baked("layered-relief", settings), eyes_around(builtin.scene),
                         "layered-relief");
}

BuiltinScene ring() {
  BuiltinScene made;
  test_shapes::add(made.scene, test_shapes::torus(1.0, 0.3, 60, 30), {0.8f, 0.5f, 0.2f});
  finish(made.scene);
  return made;
}

TEST_F(SoftwareSame, layered_impostors_with_outlines) {
  ASSERT_NO_FATAL_FAILURE(load(ring()));
  const Setting settings[] = {{"views", "12"}, {"size", "32"}};
  expect_same_everywhere(baked("layered-impostor", settings, true), eyes_around(builtin.scene),
                         "layered-impostor");
}

TEST_F(SoftwareSame, slices_of_layered_impostors) {
  ASSERT_NO_FATAL_FAILURE(load(ring()));
  const Setting settings[] = {{"ring", "5"}, {"size", "32"}, {"warp", "slices"}};
  expect_same_everywhere(baked("layered-impostor", settings), eyes_around(builtin.scene),
                         "layered-impostor");
}

TEST_F(SoftwareSame, environment_nodes) {
  // A hall with a pillar, seen from two nodes; the hall has no ceiling.
  std::vector<DepthImage> pictures;
  for (const glm::dvec3& eye : {glm::dvec3(-1, 0, 0), glm::dvec3(1, 0, 0.2)}) {
    const DistanceAlong walls = box_around(glm::dvec3(-3, -1, -2) - eye, glm::dvec3(3, 9, 2) - eye);
    const DistanceAlong pillar = ball(glm::dvec3(0, 0, -1) - eye, 0.4);
    const EnvironmentMap map = make_node(
        48,
        [&](const glm::dvec3& d) {
          const double nearest = std::min(walls(d), pillar(d));
          return nearest * d.y > 4 ? INFINITY : nearest;
        },
        [&](const glm::dvec3& d, double distance) {
          if (!std::isfinite(distance)) return glm::vec4(0.1f, 0.3f, 0.9f, 1);
          const glm::dvec3 at = eye + distance * d;
          return glm::vec4(glm::fract(glm::vec3(at)) * 0.8f + 0.1f, 1);
        },
        eye);
    pictures.insert(pictures.end(), map.faces.begin(), map.faces.end());
  }
  const auto nodes = make_environment_nodes(std::move(pictures), {});
  ASSERT_TRUE(nodes.ok()) << nodes.error().message();
  std::vector<Camera> cameras;
  for (const double x : {-0.9, 0.0, 0.8})
    cameras.push_back(look_at({x, 0.1, 0.4}, {0.3 * x, 0.1, -1}, {0, 1, 0}, 1.2, kSameWidth,
                              kSameHeight, 0.05, 50));
  const Kind& kind = environment_nodes_kind();
  for (const char* merge : {"positional", "layering", "weighted"}) {
    SCOPED_TRACE(merge);
    OptionValues draw(kind.draw_options);
    ASSERT_TRUE(draw.set("merge", merge).ok() && draw.set("gaps", "on").ok());
    expect_same_everywhere(
        [&] {
          auto factory = make_factory(software_drawable_rows(), kind.name);
          auto drawable =
              (*factory)->make_drawable(std::make_unique<EnvironmentRepresentation>(*nodes), draw);
          EXPECT_TRUE(drawable.ok());
          return std::make_unique<TestSource>(
              software_stored(builtin.scene, 4, std::move(*drawable), {{glm::dmat4(1.0), 0, 1}},
                              false, std::move(*factory)));
        },
        cameras, kind.name);
  }
}

TEST_F(SoftwareSame, relief_impostors) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=10000"));
  ImpostorFramesOptions options;
  options.workers.size = 64;
  expect_same_everywhere(
      [&]() -> std::unique_ptr<FrameSource> {
        auto frames = software_chosen(
            builtin.scene, 4,
            [&](const PlacedScene& placed) -> Result<std::unique_ptr<FrameChooser>> {
              auto content = make_impostor_content(builtin.scene, 0.0, {});
              if (!content) return content.error();
              return {std::make_unique<ImpostorChooser>(placed, std::make_unique<SoftwareBoards>(),
                                                        std::move(*content), options)};
            });
        EXPECT_TRUE(frames.ok());
        return std::move(*frames);
      },
      eyes_around(builtin.scene, 2), kReliefImpostorName);
}

TEST_F(SoftwareSame, polygons_the_sky_and_what_blends) {
  builtin = blended_scene();
  for (const int samples : {1, 4}) {
    SCOPED_TRACE(samples);
    expect_same_everywhere(
        [&] { return std::make_unique<TestSource>(software_direct(builtin.scene, samples)); },
        eyes_around(builtin.scene), "");
  }
}

TEST_F(SoftwareSame, polygons_by_rays) {
  builtin = blended_scene();
  expect_same_everywhere(
      [&] {
        auto rays = RayVisibility::create(builtin.scene);
        EXPECT_TRUE(rays.ok());
        return std::make_unique<TestSource>(software_direct(builtin.scene, 4, std::move(*rays)));
      },
      eyes_around(builtin.scene), "");
}

// Captures, cross-fades, outlines, and polygons between them.
TEST_F(SoftwareSame, the_cache) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:bridge?triangles=100000"));
  std::vector<Camera> cameras;
  for (int frame = 0; frame < 4; ++frame)
    cameras.push_back(
        camera_at(builtin.path, frame_time(builtin.path, frame), kSameWidth, kSameHeight));
  ImageCacheOptions options;
  options.outlines = true;
  expect_same_everywhere(
      [&]() -> std::unique_ptr<FrameSource> {
        auto cache = software_cache(builtin.scene, options);
        EXPECT_TRUE(cache.ok());
        return std::move(*cache);
      },
      cameras, "nailboard");
}

TEST_F(SoftwareSame, the_cache_with_what_was_baked) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:fern?triangles=100000"));
  const Kind& kind = *find_kind(kinds(), "layered-relief");
  ObjectDrawablesOptions objects{OptionValues(kind.bake_options), OptionValues(kind.draw_options)};
  ASSERT_TRUE(objects.bake.set("textures", "6").ok() && objects.bake.set("size", "128").ok());
  ImageCacheOptions options;
  options.error_px = 4;
  // Of a machine that captures slowly.
  options.machine.emplace();
  options.machine->draw_software = {2000, 1, 500, 300, 10};
  options.machine->capture_rasterizer = {1e8, 1e5, 1e4};
  options.machine->ray_texel_ns = 200;
  expect_same_everywhere(
      [&]() -> std::unique_ptr<FrameSource> {
        auto cache = software_cache(builtin.scene, options);
        EXPECT_TRUE(cache.ok());
        auto factory = make_factory(software_drawable_rows(), kind.name);
        RaySource source(*rays);
        const PlacedScene placed(builtin.scene);
        auto made = bake_object_drawables(placed, source, kind, **factory, objects);
        EXPECT_TRUE(made.ok()) << made.error().message();
        (*cache)->cache().add_alternatives(std::move(*made), std::move(*factory));
        return std::move(*cache);
      },
      eyes_around(builtin.scene), kind.name);
}

// Captured again by an angle.
TEST_F(SoftwareSame, pictures_of_each_object) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=10000"));
  std::vector<Camera> cameras;
  for (const int frame : {0, 1, 30})
    cameras.push_back(
        camera_at(builtin.path, frame_time(builtin.path, frame), kSameWidth, kSameHeight));
  for (const DepthMode mode : {DepthMode::exact, DepthMode::flat}) {
    SCOPED_TRACE(int(mode));
    PictureFramesOptions options;
    options.mode = mode;
    expect_same_everywhere(
        [&]() -> std::unique_ptr<FrameSource> {
          auto frames = software_pictures(builtin.scene, options);
          EXPECT_TRUE(frames.ok());
          return std::move(*frames);
        },
        cameras, "nailboard");
  }
}

TEST_F(SoftwareSame, pictures_as_nailboards_with_each_depth) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=10000"));
  const PlacedScene placed(builtin.scene);
  PictureRasterizer rasterizer(builtin.scene);
  std::vector<std::uint32_t> objects(builtin.scene.objects.size());
  for (std::uint32_t i = 0; i < objects.size(); ++i) objects[i] = i;
  std::vector<DepthImage> pictures;
  for (Camera camera : eyes_around(builtin.scene, 2)) {
    camera.width = 120, camera.height = 68;
    pictures.push_back(rasterizer.capture(camera, objects, placed.poses(), 4));
  }
  for (const DepthMode mode : {DepthMode::exact, DepthMode::linear, DepthMode::flat}) {
    SCOPED_TRACE(int(mode));
    expect_same_everywhere(
        [&] {
          auto made = make_software_pictures(pictures, mode, 8);
          EXPECT_TRUE(made.ok());
          return std::make_unique<TestSource>(software_stored(
              builtin.scene, 4, std::move(made->drawable), std::move(made->instances), true));
        },
        eyes_around(builtin.scene), "nailboard");
  }
}

}  // namespace
}  // namespace rilievo
