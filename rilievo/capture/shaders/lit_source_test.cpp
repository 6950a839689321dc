#include "rilievo/capture/shaders/lit_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "rilievo/capture/callable_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shaders/find_depth_kind.h"
#include "rilievo/capture/shaders/ray_tracer.h"
#include "rilievo/capture/view_set.h"
#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

Mesh lit_square(float half, float y) {
  Mesh mesh;
  mesh.positions = {{-half, y, half}, {half, y, half}, {half, y, -half}, {-half, y, -half}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

// A plate above a floor, in the sun.
Scene shaded_floor() {
  Scene scene;
  Material rough;
  rough.double_sided = true, rough.roughness = 1;
  scene.materials = {rough};
  scene.meshes = {lit_square(4, 0), lit_square(1.1f, 2)};
  for (Mesh& mesh : scene.meshes) mesh.material = 0;
  scene.models = {{"floor", {{0, glm::mat4(1)}}, {}, 0}, {"plate", {{1, glm::mat4(1)}}, {}, 0}};
  scene.objects.resize(2);
  scene.objects[1].model = 1;
  scene.lights = {default_sun()};
  finish(scene);
  return scene;
}

void expect_same_surfaces(const DepthImage& a, const DepthImage& b) {
  EXPECT_TRUE(std::ranges::equal(a.depth.texels(), b.depth.texels()));
  EXPECT_TRUE(std::ranges::equal(a.object.texels(), b.object.texels()));
}

TEST(LitSource, surfaces_are_those_of_rays_and_shadows_lie_where_they_say) {
  const Scene scene = shaded_floor();
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RaySource geometry(*rays);
  // Hard shadows.
  RayTracer light(*rays, {.sun_degrees = 0});
  LitSource lit(geometry, light, {.samples = 16});
  const Camera camera = look_at({1, 5, 4}, {0, 0, 0}, {0, 1, 0}, 1.0, 96, 80, 0.1, 30);
  const auto seen = lit.capture({.camera = camera});
  const auto plain = geometry.capture({.camera = camera});
  ASSERT_TRUE(seen && plain);
  ASSERT_TRUE(validate(seen->picture).ok());
  expect_same_surfaces(seen->picture, plain->picture);
  const glm::vec3 to_sun = -scene.lights[0].direction;
  Image<std::uint8_t> dark(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      if (!seen->picture.covered(x, y)) continue;
      const glm::dvec3 place =
          world_from_raster(camera, {x + 0.5, y + 0.5}, double(seen->picture.depth(x, y)));
      dark(x, y) = rays->occluded(glm::vec3(place) + 1e-3f * to_sun, to_sun, 0, 100);
    }
  int darker = 0, same = 0;
  for (int y = 1; y + 1 < camera.height; ++y)
    for (int x = 1; x + 1 < camera.width; ++x) {
      // Away from edges of shadows and of surfaces.
      bool inner = true;
      for (int k = 0; k < 9; ++k) {
        const int u = x + k % 3 - 1, v = y + k / 3 - 1;
        inner = inner && dark(u, v) == dark(x, y) && seen->picture.covered(u, v) &&
                seen->picture.object(u, v) == seen->picture.object(x, y);
      }
      if (!inner) continue;
      const float with = seen->picture.color(x, y).g, without = plain->picture.color(x, y).g;
      if (dark(x, y)) {
        EXPECT_LT(with, 0.7f * without);
        ++darker;
      } else {
        EXPECT_NEAR(with, without, 1e-4f);  // sums of 16 and of 4 samples
        ++same;
      }
    }
  EXPECT_GT(darker, 100);
  EXPECT_GT(same, 1000);
}

TEST(LitSource, the_sky_stands_behind_the_light) {
  const auto built = make_builtin("builtin:teapots?triangles=10000");
  ASSERT_TRUE(built);
  const auto rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  RaySource geometry(*rays);
  RayTracer light(*rays);
  LitSource lit(geometry, light, {.samples = 4});
  const Camera camera = look_at({0, 3, 12}, {0, 1, 0}, {0, 1, 0}, 1.1, 64, 48, 0.1, 100);
  const auto seen = lit.capture({.camera = camera, .with_sky = true});
  const auto plain = geometry.capture({.camera = camera, .with_sky = true});
  ASSERT_TRUE(seen && plain);
  expect_same_surfaces(seen->picture, plain->picture);
  int open = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      EXPECT_NEAR(seen->picture.color(x, y).a, 1.0f, 1e-6f);
      if (seen->picture.covered(x, y)) continue;
      ++open;
      for (int c = 0; c < 3; ++c)
        // The sky changes over a texel by less.
        EXPECT_NEAR(seen->picture.color(x, y)[c], plain->picture.color(x, y)[c], 2e-3f);
    }
  EXPECT_GT(open, 300);
}

TEST(LitSource, layers_and_back_perspectives_are_the_tracers_own) {
  const auto built = make_builtin("builtin:teapots?triangles=10000");
  ASSERT_TRUE(built);
  const auto rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  RaySource geometry(*rays);
  RayTracer light(*rays);
  LitSource lit(geometry, light, {.samples = 4});
  const auto camera = view_camera(lit.bounds({}), {0, 0.6, 0.8}, {.size = 48});
  ASSERT_TRUE(camera);
  const auto seen = lit.capture({.camera = *camera});
  const auto plain = geometry.capture({.camera = *camera});
  ASSERT_TRUE(seen && plain);
  expect_same_surfaces(seen->picture, plain->picture);
  Camera parallel = look_at({3, 10, 8}, {0, 0, 0}, {0, 1, 0}, 1.0, 40, 40, 0.1, 40);
  parallel.projection = Projection::parallel;
  parallel.window = {-8, 8, -8, 8};
  const auto layers = lit.capture_layers({.camera = parallel, .merge = 1e-3});
  const auto cast = geometry.capture_layers({.camera = parallel, .merge = 1e-3});
  ASSERT_TRUE(layers && cast);
  ASSERT_TRUE(validate(*layers).ok());
  ASSERT_EQ(layers->first, cast->first);
  int darker = 0;
  for (std::size_t i = 0; i < cast->samples.size(); ++i) {
    EXPECT_EQ(layers->samples[i].depth, cast->samples[i].depth);
    EXPECT_EQ(layers->samples[i].object, cast->samples[i].object);
    darker += layers->samples[i].color.g < 0.8f * cast->samples[i].color.g;
  }
  // What lies below the table and within the pots is in the shade.
  EXPECT_GT(darker, int(cast->samples.size() / 5));
}

// A program whose colours are those of places, as far as it is asked what it can.
class PlaceProgram {
 public:
  explicit PlaceProgram(const RayScene& rays) : rays_(rays) {}

  static glm::vec4 color_at(const glm::dvec3& place) {
    return glm::vec4(0.5 + 0.1 * place / (1.0 + glm::length(place)), 1);
  }
  Result<CapturedPicture> operator()(const CaptureRequest& request) {
    EXPECT_TRUE(request.objects.empty());
    EXPECT_FALSE(request.camera.keeps_farthest());
    ++asked;
    CaptureRequest quick = request;
    quick.samples = 1, quick.with_sky = false;
    auto captured = rays_.capture(quick);
    if (!captured) return captured;
    const Camera& camera = request.camera;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        if (captured->picture.covered(x, y))
          captured->picture.color(x, y) = color_at(
              world_from_raster(camera, {x + 0.5, y + 0.5}, double(captured->picture.depth(x, y))));
        else if (request.with_sky)
          captured->picture.color(x, y) = {0.1f, 0.2f, 0.9f, 1};
      }
    return captured;
  }
  int asked = 0;

 private:
  RaySource rays_;
};

TEST(LitSource, a_program_colours_what_it_cannot_take_by_pictures_from_around) {
  const auto built = make_builtin("builtin:teapots?triangles=10000");
  ASSERT_TRUE(built);
  const auto rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  RaySource geometry(*rays);
  PlaceProgram program(*rays);
  CallableSource light("exec:places", geometry.bounds({}), std::ref(program));
  LitSource lit(geometry, light, {.light = LightOf::program});
  const auto camera = view_camera(lit.bounds({}), {0, 0.6, 0.8}, {.size = 96});
  ASSERT_TRUE(camera);
  const auto seen = lit.capture({.camera = *camera});
  ASSERT_TRUE(seen) << seen.error().message();
  EXPECT_EQ(program.asked, 13);
  const auto plain = geometry.capture({.camera = *camera});
  expect_same_surfaces(seen->picture, plain->picture);
  int right = 0, covered = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      if (!seen->picture.covered(x, y)) continue;
      ++covered;
      const glm::vec4 own = seen->picture.color(x, y) / seen->picture.color(x, y).a;
      const glm::vec4 due = PlaceProgram::color_at(
          world_from_raster(*camera, {x + 0.5, y + 0.5}, double(seen->picture.depth(x, y))));
      // A texel around is 0.3 m wide, over which places' colours change by less than 0.03.
      right += glm::length(own - due) < 0.03f;
    }
  EXPECT_GT(right, 0.95 * covered);
  // What was taken around serves the next direction, too: only its own is new.
  const auto other = view_camera(lit.bounds({}), {0.6, 0.0, 0.8}, {.size = 96});
  ASSERT_TRUE(lit.capture({.camera = *other}));
  EXPECT_EQ(program.asked, 14);

  Camera parallel = look_at({0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 1.0, 64, 64, 0.1, 40);
  parallel.projection = Projection::parallel;
  parallel.window = {-8, 8, -8, 8};
  const auto layers = lit.capture_layers({.camera = parallel, .merge = 1e-3});
  const auto cast = geometry.capture_layers({.camera = parallel, .merge = 1e-3});
  ASSERT_TRUE(layers && cast);
  ASSERT_EQ(layers->first, cast->first);
  // What is nearest is seen from in front.
  int first_right = 0, firsts = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const std::size_t i = std::size_t(y) * 64 + std::size_t(x);
      if (layers->first[i] == layers->first[i + 1]) continue;
      const LayerSample& sample = layers->samples[layers->first[i]];
      EXPECT_EQ(sample.depth, cast->samples[layers->first[i]].depth);
      const glm::vec4 due = PlaceProgram::color_at(
          world_from_raster(parallel, {x + 0.5, y + 0.5}, double(sample.depth)));
      ++firsts;
      first_right += glm::length(sample.color - due) < 0.04f;
    }
  EXPECT_GT(first_right, 0.9 * firsts);
}

TEST(LitSource, a_programs_sky_is_its_own_and_free_of_what_is_in_front) {
  const Scene scene = shaded_floor();
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RaySource geometry(*rays);
  PlaceProgram program(*rays);
  const glm::vec3 blue(0.1f, 0.2f, 0.9f);
  CallableSource light("exec:sky", geometry.bounds({}), [&](const CaptureRequest& request) {
    auto captured = program(request);
    if (!captured) return captured;
    // Texels of the sky beside surfaces are half of their colour, as a filter mixes them.
    const DepthImage& whole = captured->picture;
    const ColorImage before = whole.color;
    for (int y = 0; y < request.camera.height; ++y)
      for (int x = 1; x < request.camera.width; ++x)
        if (!whole.covered(x, y) && whole.covered(x - 1, y))
          captured->picture.color(x, y) = 0.5f * (before(x, y) + glm::vec4(1, 0, 0, 1));
    return captured;
  });
  LitSource lit(geometry, light, {.light = LightOf::program});
  const Camera camera = look_at({1, 3, 6}, {0, 1, 0}, {0, 1, 0}, 1.4, 80, 60, 0.1, 60);
  const auto seen = lit.capture({.camera = camera, .with_sky = true});
  ASSERT_TRUE(seen) << seen.error().message();
  int open = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      if (seen->picture.covered(x, y)) continue;
      ++open;
      EXPECT_LT(glm::length(glm::vec3(seen->picture.color(x, y)) - blue), 1e-6f);
    }
  EXPECT_GT(open, 500);
}

TEST(LitSource, the_light_of_another_scene_is_refused_by_name) {
  const Scene scene = shaded_floor();
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RaySource geometry(*rays);
  CallableSource empty("exec:elsewhere", geometry.bounds({}), [](const CaptureRequest& request) {
    const Camera& camera = request.camera;
    CapturedPicture none;
    none.picture.camera = camera;
    none.picture.color = ColorImage(camera.width, camera.height);
    none.picture.depth = Image<float>(camera.width, camera.height, kNoDepth);
    return Result<CapturedPicture>(std::move(none));
  });
  LitSource lit(geometry, empty, {.light = LightOf::program});
  const Camera camera = look_at({1, 5, 4}, {0, 0, 0}, {0, 1, 0}, 1.0, 40, 30, 0.1, 30);
  const auto seen = lit.capture({.camera = camera});
  ASSERT_FALSE(seen);
  EXPECT_EQ(seen.error().where, "exec:elsewhere");
  EXPECT_NE(seen.error().reason.find("shows nothing at 100 %"), std::string::npos);
}

TEST(FindDepthKind, two_pictures_tell_axis_from_ray) {
  for (const char* name :
       {"builtin:teapots?triangles=10000", "builtin:stonehenge?triangles=10000"}) {
    const auto built = make_builtin(name);
    ASSERT_TRUE(built);
    const auto rays = RayScene::create(built->scene);
    ASSERT_TRUE(rays);
    RaySource source(*rays);
    for (const DepthKind kind : {DepthKind::eye_z, DepthKind::ray}) {
      Random random(5);
      CallableSource program("exec:depths", source.bounds({}), [&](const CaptureRequest& request) {
        auto captured = source.capture(request);
        if (!captured) return captured;
        const Camera& camera = request.camera;
        for (int y = 0; y < camera.height; ++y)
          for (int x = 0; x < camera.width; ++x) {
            float& depth = captured->picture.depth(x, y);
            if (depth == kNoDepth) continue;
            // Of one sample somewhere in the texel, more or less.
            const double noise = double(random.between(0.995f, 1.005f));
            depth =
                float(noise * depth_from_eye_z(kind, double(depth), camera, {x + 0.5, y + 0.5}));
          }
        return captured;
      });
      const auto found = find_depth_kind(program);
      ASSERT_TRUE(found) << found.error().message();
      EXPECT_EQ(*found, kind) << name;
    }
  }
}

TEST(FindDepthKind, what_shows_nothing_tells_nothing) {
  CallableSource empty("exec:dark", {glm::vec3(-1), glm::vec3(1)}, [](const CaptureRequest& r) {
    CapturedPicture none;
    none.picture.camera = r.camera;
    none.picture.color = ColorImage(r.camera.width, r.camera.height);
    none.picture.depth = Image<float>(r.camera.width, r.camera.height, kNoDepth);
    return Result<CapturedPicture>(std::move(none));
  });
  const auto found = find_depth_kind(empty);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().where, "exec:dark");
}

}  // namespace
}  // namespace rilievo
