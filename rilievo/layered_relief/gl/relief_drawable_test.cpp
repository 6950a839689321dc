// What is drawn of layered reliefs, through the whole way: warped, averaged, cut to pieces, drawn.
#include "rilievo/layered_relief/relief_drawable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/io/png.h"
#include "rilievo/layered_relief/relief_bound.h"
#include "rilievo/layered_relief/relief_test_helpers.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/nailboard/gl/atlas_boards.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class ReliefDrawableTest : public gl::ContextTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(ContextTest::SetUp());
    auto made = AtlasBoards::create();
    ASSERT_TRUE(made) << made.error().message();
    boards = *std::move(made);
  }
  void TearDown() override {
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    boards.reset();
    ContextTest::TearDown();
  }
  std::unique_ptr<PrewarpedBoards> boards;
};

struct Probed {
  Image<std::uint32_t> object;
  Image<float> depth;
};

Probed probe(Drawable& drawable, const Camera& camera, std::span<const Instance> instances,
             SceneRenderer* renderer = nullptr, std::span<const std::uint32_t> polygons = {}) {
  auto target = ProbeTarget::create(camera.width, camera.height);
  EXPECT_TRUE(target.ok());
  target->begin();
  if (renderer) renderer->draw_objects(camera, polygons);
  drawable.draw(camera, instances, Output::object_id);
  return {target->read_objects(), target->read_eye_z(camera)};
}

// Each sample is an object of its own: the frame says which samples it shows, and where.
TEST_F(ReliefDrawableTest, no_sample_is_drawn_farther_from_its_place_than_the_bound) {
  std::mt19937 rng(21);
  std::uniform_real_distribution<double> unit(-1, 1);
  double tightest = 0;
  int pixels = 0, averaged = 0;
  for (int i = 0; i < 10; ++i) {
    ReliefPictures pictures;
    pictures.pictures.push_back({random_layers(rng, 60, 52), 0.002, 0});
    LayeredDepthImage& layers = pictures.pictures[0].layers;
    for (std::size_t s = 0; s < layers.samples.size(); ++s)
      layers.samples[s].object = std::uint32_t(s) + 1;
    pictures.bounds = bounds_of(pictures);
    const auto set = make_relief_set(pictures);
    ASSERT_TRUE(set);
    const ReliefFrame frame = set->reliefs[0].frame();
    PrewarpOptions options;
    options.splat_size = i % 2 ? 1.0 : 1.5;
    options.resolution = i % 3 == 2 ? 0.6 : 1.0;
    options.max_size = 2048;
    auto drawable = make_relief_drawable(pictures, *boards, options);
    ASSERT_TRUE(drawable) << drawable.error().message();
    std::vector<glm::dvec3> places;  // by object - 1
    for (std::size_t t = 0; t + 1 < layers.first.size(); ++t)
      for (std::uint64_t s = layers.first[t]; s < layers.first[t + 1]; ++s)
        places.push_back(world_from_raster(layers.camera,
                                           {double(t % 60) + 0.5, double(t / 60) + 0.5},
                                           double(layers.samples[s].depth)));
    for (int e = 0; e < 10; ++e) {
      // Some from so far that texels are averaged.
      glm::dvec3 eye = random_eye(rng, set->reliefs[0]);
      if (e % 3 == 0) eye -= (4 + 6 * std::abs(unit(rng))) * frame.f;
      glm::dmat4 motion(1.0);
      if (e % 2) {
        const double scale = std::exp(0.5 * unit(rng));
        motion = look_at({0, 0, 0}, {unit(rng), unit(rng), 1.5}, {0, 1, 0}, 1, 8, 8, 1, 2)
                     .world_from_eye;
        for (int k = 0; k < 3; ++k) motion[k] *= scale;
        motion[3] = glm::dvec4(unit(rng), unit(rng), unit(rng), 1);
      }
      const auto moved = [&](const glm::dvec3& p) { return glm::dvec3(motion * glm::dvec4(p, 1)); };
      const Camera camera =
          look_at(moved(eye), moved(frame.world(30 + 20 * unit(rng), 26 + 20 * unit(rng), 0)),
                  {0.05, 1, 0.1}, 0.7, 200, 150, 0.01, 100);
      const ErrorModel model = (*drawable)->error_model(0);
      const double bound = model.bound_px(motion, camera);
      const Instance instance{motion, 0, kNoObject};
      const Probed drawn = probe(**drawable, camera, {&instance, 1});
      averaged += e % 3 == 0;
      for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
          const std::uint32_t object = drawn.object(x, y);
          if (object == kNoObject) continue;
          ASSERT_LE(object, places.size());
          const glm::dvec3 is = raster_from_world(camera, moved(places[object - 1]));
          const double error = glm::distance(glm::dvec2(is), glm::dvec2(x + 0.5, y + 0.5));
          if (!std::isfinite(bound)) continue;
          ASSERT_LE(error, bound + std::sqrt(0.5)) << i << " " << e;
          tightest = std::max(tightest, error / (bound + std::sqrt(0.5)));
          ++pixels;
        }
    }
  }
  EXPECT_GT(pixels, 50'000);
  EXPECT_GT(averaged, 20);
  EXPECT_GT(tightest, 0.25);  // and it is no idle promise
}

Scene fish_and_plane() {
  auto built = make_builtin("builtin:fish?triangles=8000");
  Scene scene = std::move(built->scene);
  // Through the fish, across the line of sight but turned.
  Mesh mesh;
  const Box box = world_bounds(scene);
  const glm::vec3 c = box.center();
  const float r = 1.2f * box.radius();
  mesh.positions = {c + glm::vec3(-r, -r, 0.4f * r), c + glm::vec3(r, -r, -0.4f * r),
                    c + glm::vec3(r, r, -0.4f * r), c + glm::vec3(-r, r, 0.4f * r)};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.material = int(scene.materials.size());
  Material material;
  material.base_color = {0.8f, 0.2f, 0.8f, 1};
  material.double_sided = true;
  scene.materials.push_back(material);
  scene.meshes.push_back(mesh);
  Model model;
  model.parts.push_back({int(scene.meshes.size()) - 1, glm::mat4(1)});
  scene.models.push_back(model);
  Object object;
  object.model = int(scene.models.size()) - 1;
  scene.objects.push_back(object);
  finish(scene);
  return scene;
}

TEST_F(ReliefDrawableTest, a_polygon_cuts_it_where_it_would_cut_the_object) {
  const Scene scene = fish_and_plane();
  ASSERT_EQ(scene.objects.size(), 2u);
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  OpenGLSource source(*renderer);
  const std::uint32_t fish[] = {0}, plane[] = {1}, both[] = {0, 1};
  const auto pictures = capture_relief_pictures(source, fish, {.textures = 6, .size = 320});
  ASSERT_TRUE(pictures) << pictures.error().message();
  auto drawable = make_relief_drawable(*pictures, *boards, {.splat_size = 1.5, .max_size = 2048});
  ASSERT_TRUE(drawable) << drawable.error().message();
  const glm::dvec3 center(pictures->bounds.center());
  const double radius = double(pictures->bounds.radius());
  std::mt19937 rng(4);
  std::normal_distribution<double> normal;
  int compared = 0, wrong = 0, cracks = 0, wrong_depth = 0, cut = 0;
  for (int e = 0; e < 12; ++e) {
    const glm::dvec3 towards = glm::normalize(glm::dvec3(normal(rng), normal(rng), normal(rng)));
    const Camera camera = look_at(center + 3.2 * radius * towards, center, {0, 1, 0.03}, 0.7, 200,
                                  160, 0.1 * radius, 20 * radius);
    const Instance instance{glm::dmat4(1.0), 0, 1};
    const double bound = (*drawable)->error_model(0).bound_px(glm::dmat4(1.0), camera);
    ASSERT_LT(bound, 4);
    const Probed drawn = probe(**drawable, camera, {&instance, 1}, &*renderer, plane);
    auto target = ProbeTarget::create(camera.width, camera.height);
    target->begin();
    renderer->draw_objects(camera, both);
    const Image<std::uint32_t> object = target->read_objects();
    const Image<float> depth = target->read_eye_z(camera);
    if (const char* folder = std::getenv("RILIEVO_SHOW")) {
      // The true frame, and what is drawn.
      Rgba8Image both_frames(2 * camera.width, camera.height);
      const auto color = [](std::uint32_t o) {
        return glm::u8vec4(o == 1 ? 230 : 40, o == 2 ? 200 : 60, o == 0 ? 90 : 60, 255);
      };
      for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
          both_frames(x, y) = color(object(x, y));
          both_frames(x + camera.width, y) = color(drawn.object(x, y));
        }
      EXPECT_TRUE(
          save_png(std::string(folder) + "/cut_" + std::to_string(e) + ".png", both_frames));
    }
    const int reach = int(std::ceil(bound + std::sqrt(0.5)));
    for (int y = reach; y < camera.height - reach; ++y)
      for (int x = reach; x < camera.width - reach; ++x) {
        // Somewhere within the bound the true frame shows the same, as near.
        const std::uint32_t shown = drawn.object(x, y);
        bool same = false;
        float low = 1e30f, high = -1e30f;
        for (int v = y - reach; v <= y + reach; ++v)
          for (int u = x - reach; u <= x + reach; ++u)
            if (object(u, v) == shown) {
              same = true;
              low = std::min(low, depth(u, v)), high = std::max(high, depth(u, v));
            }
        if (object(x, y) == kNoObject && shown == kNoObject) continue;
        ++compared;
        cut += object(x, y) == 1;
        (shown == 1 ? wrong : cracks) += !same;
        // A texel deeper or nearer than the neighbourhood's: where it is steep.
        const float slack = 0.02f * float(radius);
        if (same && shown != kNoObject)
          wrong_depth += drawn.depth(x, y) < low - slack || drawn.depth(x, y) > high + slack;
      }
  }
  EXPECT_GT(compared, 30'000);
  EXPECT_GT(cut, 4'000);
  EXPECT_LE(wrong, compared / 1000);
  // In what is steep in all textures and turns towards the eye: the fish's sides before its head.
  EXPECT_LE(cracks, compared / 60);
  EXPECT_LE(wrong_depth, compared / 200);
}

TEST_F(ReliefDrawableTest, it_looks_like_the_object_near_and_far) {
  const auto built = make_builtin("builtin:fish?triangles=8000");
  ASSERT_TRUE(built);
  auto renderer = SceneRenderer::create(built->scene);
  ASSERT_TRUE(renderer.ok());
  OpenGLSource source(*renderer);
  const auto pictures = capture_relief_pictures(source, {}, {.textures = 6, .size = 256});
  ASSERT_TRUE(pictures);
  auto drawable = make_relief_drawable(*pictures, *boards, {.splat_size = 1.5, .max_size = 2048});
  ASSERT_TRUE(drawable);
  const glm::dvec3 center(pictures->bounds.center());
  const double radius = double(pictures->bounds.radius());
  for (const double distance : {2.5, 8.0, 40.0}) {
    // Together as large on the screen, or smaller.
    const Camera camera =
        look_at(center + distance * radius * glm::normalize(glm::dvec3(0.35, 0.3, 1)), center,
                {0, 1, 0}, 2 * std::asin(1 / 2.5), 180, 140, 0.1 * radius, 60 * radius);
    std::vector<std::uint32_t> visible;
    renderer->cull(camera, visible);
    const auto frame = [&](auto&& draw) {
      auto target = FrameTarget::create(camera.width, camera.height, 4);
      target->begin();
      draw();
      renderer->draw_sky(camera, OutputEncoding::srgb);
      target->resolve();
      return target->read();
    };
    const Rgba8Image direct =
        frame([&] { renderer->draw_opaque(camera, visible, OutputEncoding::srgb); });
    const Instance instance{glm::dmat4(1.0), 0, 1};
    const Rgba8Image shown = frame([&] {
      (*drawable)->draw(camera, {&instance, 1}, Output::color);
    });
    EXPECT_GT(psnr_db(direct, shown), 27) << distance;
    // The same again from what is still on the GPU.
    const Rgba8Image again = frame([&] {
      (*drawable)->draw(camera, {&instance, 1}, Output::color);
    });
    EXPECT_TRUE(std::equal(again.texels().begin(), again.texels().end(), shown.texels().begin()));
  }
}

TEST_F(ReliefDrawableTest, an_instance_without_an_identifier_has_that_of_the_only_object) {
  std::mt19937 rng(3);
  ReliefPictures pictures;
  pictures.pictures.push_back({random_layers(rng, 40, 40), 0, 0});
  pictures.bounds = bounds_of(pictures);
  const ReliefFrame frame = make_relief_set(pictures)->reliefs[0].frame();
  const Camera camera =
      look_at(frame.world(20, 20, 0) - 4.0 * double(pictures.bounds.radius()) * frame.f,
              frame.world(20, 20, 0), {0.05, 1, 0.1}, 0.7, 100, 100, 0.01, 100);
  // Pictures that name no object have the instance's alone.
  for (const auto& [captured, named] : {std::pair(7u, kNoObject), {7u, 3u}, {kNoObject, 3u}}) {
    for (LayerSample& sample : pictures.pictures[0].layers.samples) sample.object = captured;
    auto drawable = make_relief_drawable(pictures, *boards, {});
    ASSERT_TRUE(drawable) << drawable.error().message();
    const Instance instance{glm::dmat4(1.0), 0, named};
    const Probed drawn = probe(**drawable, camera, {&instance, 1});
    int shown = 0;
    for (const std::uint32_t object : drawn.object.texels()) {
      if (object == kNoObject) continue;
      ++shown;
      EXPECT_EQ(object, named == kNoObject ? captured : named);
    }
    EXPECT_GT(shown, 100);
  }
}

// More than there is room for at once: some are drawn, then others in their place.
TEST_F(ReliefDrawableTest, many_instances_stand_where_they_are_placed) {
  const auto built = make_builtin("builtin:cube");
  ASSERT_TRUE(built);
  auto renderer = SceneRenderer::create(built->scene);
  ASSERT_TRUE(renderer.ok());
  OpenGLSource source(*renderer);
  const auto pictures = capture_relief_pictures(source, {}, {.textures = 6, .size = 400});
  ASSERT_TRUE(pictures);
  auto drawable = make_relief_drawable(*pictures, *boards, {.resolution = 2.2, .max_size = 2048});
  ASSERT_TRUE(drawable);
  const double radius = double(pictures->bounds.radius());
  std::vector<Instance> instances;
  for (int i = 0; i < 12; ++i) {
    Instance instance{glm::dmat4(1.0), 0, std::uint32_t(i) + 1};
    instance.world_from_capture[3] =
        glm::dvec4((i % 4 - 1.5) * 3 * radius, (i / 4 - 1) * 3 * radius, -0.3 * i * radius, 1);
    instances.push_back(instance);
  }
  const Camera camera = look_at({0.5 * radius, 0.3 * radius, 16 * radius}, {0, 0, 0}, {0, 1, 0},
                                0.7, 1600, 1200, 0.1 * radius, 60 * radius);
  const Probed drawn = probe(**drawable, camera, instances);
  for (const Instance& instance : instances) {
    const glm::dvec3 at =
        raster_from_world(camera, glm::dvec3(instance.world_from_capture *
                                             glm::dvec4(glm::dvec3(pictures->bounds.center()), 1)));
    EXPECT_EQ(drawn.object(int(at.x), int(at.y)), instance.object);
  }
}

}  // namespace
}  // namespace rilievo
