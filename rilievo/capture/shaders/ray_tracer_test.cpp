#include "rilievo/capture/shaders/ray_tracer.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "rilievo/capture/plate_test_helpers.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/core/random.h"
#include "rilievo/render/rays/box_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// A colour that is linear in the position, so that a mesh has it exactly between its corners.
glm::dvec3 traced_color(const glm::dvec3& p) {
  return 0.5 + glm::dvec3(0.05 * p.x, 0.04 * p.y, 0.03 * (p.x + p.z));
}

Mesh traced_quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
  Mesh mesh;
  mesh.positions = {a, b, c, d};
  for (const glm::vec3& p : mesh.positions)
    mesh.colors.emplace_back(glm::vec3(traced_color(glm::dvec3(p))), 1.0f);
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

// A unit sphere with smooth normals.
Mesh traced_sphere(int slices) {
  Mesh mesh;
  for (int i = 0; i <= slices; ++i)
    for (int j = 0; j <= 2 * slices; ++j) {
      const float polar = glm::pi<float>() * float(i) / float(slices);
      const float turn = glm::pi<float>() * float(j) / float(slices);
      mesh.positions.emplace_back(std::sin(polar) * std::sin(turn), std::cos(polar),
                                  std::sin(polar) * std::cos(turn));
    }
  mesh.normals = mesh.positions;
  const auto at = [&](int i, int j) { return std::uint32_t(i * (2 * slices + 1) + j); };
  for (int i = 0; i < slices; ++i)
    for (int j = 0; j < 2 * slices; ++j)
      mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j),
                                               at(i + 1, j + 1), at(i, j + 1)});
  return mesh;
}

void add_traced(Scene& scene, Mesh mesh, const Material& material) {
  mesh.material = int(scene.materials.size());
  scene.materials.push_back(material);
  Model model;
  model.parts.push_back({int(scene.meshes.size()), glm::mat4(1.0f)});
  scene.meshes.push_back(std::move(mesh));
  Object object;
  object.model = int(scene.models.size());
  scene.models.push_back(model);
  scene.objects.push_back(object);
}

// Nothing shines but what is unlit.
Scene dark_scene() {
  Scene scene;
  Light none;
  none.intensity = glm::vec3(0.0f);
  scene.lights = {none};
  scene.sky = {glm::vec3(0.0f), glm::vec3(0.0f), glm::vec3(0.0f)};
  return scene;
}

Material unlit_sheet() {
  Material m;
  m.unlit = true;
  m.double_sided = true;
  return m;
}

CapturedPicture traced_picture(CaptureSource& source, const CaptureRequest& request) {
  Result<CapturedPicture> picture = source.capture(request);
  EXPECT_TRUE(picture.ok());
  return picture ? *std::move(picture) : CapturedPicture{};
}

glm::dvec3 ray_of_texel(const Camera& camera, int x, int y) {
  return glm::normalize(world_from_raster(camera, {x + 0.5, y + 0.5}, 1.0) - camera.position());
}

// A mirror sphere before a wall behind the eye: each texel shows the place of the wall that the
// law of reflection says.
TEST(RayTracer, a_sphere_mirrors_the_wall_behind_the_eye) {
  Scene scene = dark_scene();
  Material mirror;
  mirror.metallic = 1, mirror.roughness = 0;
  add_traced(scene, traced_sphere(256), mirror);
  const double wall = 7;
  add_traced(
      scene,
      traced_quad({-400, -400, wall}, {400, -400, wall}, {400, 400, wall}, {-400, 400, wall}),
      unlit_sheet());
  finish(scene);
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RayTracer tracer(*rays);
  const Camera camera = look_at({0.3, 0.2, 5}, {0, 0, 0}, {0, 1, 0}, 0.5, 48, 40, 0.1, 20);
  const std::uint32_t first[] = {0};
  const DepthImage picture =
      traced_picture(tracer, {.camera = camera, .objects = first, .samples = 1}).picture;
  int compared = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec3 o = camera.position(), d = ray_of_texel(camera, x, y);
      const double b = glm::dot(o, d), discriminant = b * b - glm::dot(o, o) + 1;
      if (std::abs(discriminant) < 0.01) continue;  // the edges of the mesh
      EXPECT_EQ(picture.covered(x, y), discriminant > 0);
      if (discriminant < 0) continue;
      const glm::dvec3 n = o + (-b - std::sqrt(discriminant)) * d;
      const glm::dvec3 r = glm::reflect(d, n);
      if (r.z < 0.2) continue;  // beside the wall, or far out on it
      const glm::dvec3 q = n + (wall - n.z) / r.z * r;
      shading_model::Response<double> response{};
      response.roughness = 0.045, response.f0 = {1, 1, 1};
      const auto share = shading_model::mirror_share(response, glm::dot(n, -d));
      const glm::dvec3 expected = 0.955 * share.x * traced_color(q);
      // A facet's sagitta is 2e-5, as is the error of its normal in radians, which at a slant moves
      // the place on the wall by up to 25 * 7 * 4e-5 m, of 0.08 a metre; floats beside that are
      // exact.
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(double(picture.color(x, y)[c]), expected[c], 2e-3) << x << ' ' << y;
      ++compared;
    }
  EXPECT_GT(compared, 200);
}

// Light is bent on its way in and back on its way out: what lies behind is moved sidewards, and as
// bright as Fresnel's formula says.
TEST(RayTracer, a_slab_of_glass_moves_what_is_behind_it_by_snells_law) {
  Scene scene = dark_scene();
  Material glass;
  glass.alpha_mode = AlphaMode::blend;
  glass.transmission = 1, glass.ior = 1.7f, glass.refracts = true, glass.roughness = 0;
  add_traced(scene, box_between({-50, -50, -1}, {50, 50, 0}), glass);
  add_traced(scene, traced_quad({-90, -90, -3}, {90, -90, -3}, {90, 90, -3}, {-90, 90, -3}),
             unlit_sheet());
  finish(scene);
  const auto rays = RayScene::create(scene, 0, RayParts::all);
  ASSERT_TRUE(rays);
  // Two bounces: in and out. More would add what is mirrored inside twice.
  RayTracer tracer(*rays, {.bounces = 2});
  const Camera camera = look_at({4, 3, 4}, {0, 0, 0}, {0, 1, 0}, 0.6, 40, 40, 0.1, 50);
  const DepthImage picture = traced_picture(tracer, {.camera = camera, .samples = 1}).picture;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec3 d = ray_of_texel(camera, x, y);
      const glm::dvec3 in = camera.position() - camera.position().z / d.z * d;
      const double c1 = -d.z, s2 = std::sqrt(1 - c1 * c1) / 1.7, c2 = std::sqrt(1 - s2 * s2);
      const glm::dvec3 sidewards = glm::normalize(glm::dvec3(d.x, d.y, 0));
      const glm::dvec3 behind = in + s2 / c2 * sidewards - glm::dvec3(0, 0, 1) - 2.0 / d.z * d;
      const double rs = (c1 - 1.7 * c2) / (c1 + 1.7 * c2), rp = (1.7 * c1 - c2) / (1.7 * c1 + c2);
      const double through = 1 - 0.5 * (rs * rs + rp * rp);
      for (int c = 0; c < 3; ++c)
        // Floats; each ray starts up to 6e-5 m beside its surface, where colours change by 0.1 a m.
        EXPECT_NEAR(double(picture.color(x, y)[c]),
                    through * through * traced_color({behind.x, behind.y, -3})[c], 2e-5);
      EXPECT_EQ(picture.object(x, y), 1u);
      EXPECT_FLOAT_EQ(picture.color(x, y).a, 1.0f);
    }
}

// Blended parts let light through, and open texels keep the alpha of what covers them.
TEST(RayTracer, blended_parts_cover_by_their_alpha) {
  Scene scene = dark_scene();
  Material veil = unlit_sheet();
  veil.alpha_mode = AlphaMode::blend, veil.base_color.a = 0.25f;
  add_traced(scene, traced_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}), veil);
  add_traced(scene, traced_quad({-1, -1, -1}, {0, -1, -1}, {0, 1, -1}, {-1, 1, -1}), unlit_sheet());
  finish(scene);
  const auto rays = RayScene::create(scene, 0, RayParts::all);
  ASSERT_TRUE(rays);
  RayTracer tracer(*rays);
  const Camera camera = look_at({0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 0.12, 16, 16, 0.1, 50);
  const DepthImage picture = traced_picture(tracer, {.camera = camera, .samples = 1}).picture;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const glm::dvec3 d = ray_of_texel(camera, x, y), o = camera.position();
      const bool wall = x < 8;
      const glm::dvec3 near = 0.25 * traced_color(o - o.z / d.z * d);
      const glm::dvec3 far = wall ? 0.75 * traced_color(o - (o.z + 1) / d.z * d) : glm::dvec3(0);
      EXPECT_NEAR(double(picture.color(x, y).a), wall ? 1 : 0.25, 1e-6);
      EXPECT_NEAR(double(picture.color(x, y).g), near.g + far.g, 1e-5);  // floats
      EXPECT_EQ(picture.object(x, y), 1u);
    }
}

// What one light gives to a floor at the origin, beside a half plane x < 0 at the height 2 that
// casts a shadow, by the definition: over the whole light.
double floor_light(const std::function<std::pair<glm::dvec3, double>(double, double)>& place,
                   const glm::dvec3& at, const glm::dvec3& eye) {
  const glm::dvec3 v = glm::normalize(eye - at);
  double sum = 0;
  constexpr int n = 160;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const auto [l, strength] = place((i + 0.5) / n, (j + 0.5) / n);
      if (at.x + 2 / l.y * l.x < 0) continue;
      sum +=
          strength * shading_model::reflected<double>({0, 1, 0}, {v.x, v.y, v.z}, {l.x, l.y, l.z},
                                                      {0.8, 0.8, 0.8}, {0.04, 0.04, 0.04}, 1.0)
                         .x;
    }
  return sum / (n * n);
}

TEST(RayTracer, penumbras_are_the_integral_over_the_light) {
  Material white;
  white.base_color = {0.8f, 0.8f, 0.8f, 1}, white.roughness = 1, white.double_sided = true;
  for (const bool sun : {true, false}) {
    Scene scene = dark_scene();
    Light& light = scene.lights[0];
    light.kind = sun ? Light::Kind::directional : Light::Kind::point;
    light.intensity = glm::vec3(sun ? 3.0f : 60.0f);
    light.direction = glm::normalize(glm::vec3(0.2f, -1, 0.1f));
    light.position = {-0.5f, 5, 0.4f};
    Mesh floor = traced_quad({-30, 0, 30}, {30, 0, 30}, {30, 0, -30}, {-30, 0, -30});
    Mesh blocker = traced_quad({-60, 2, 60}, {0, 2, 60}, {0, 2, -60}, {-60, 2, -60});
    floor.colors.clear(), blocker.colors.clear();
    add_traced(scene, floor, white);
    add_traced(scene, blocker, white);
    finish(scene);
    const auto rays = RayScene::create(scene);
    ASSERT_TRUE(rays);
    RayTracer tracer(*rays, {.light_samples = 256, .sun_degrees = 24, .light_radius = 0.7});
    const glm::dvec3 eye(4, 1.5, 0.3);
    const Camera camera = look_at(eye, {0.6, 0, 0}, {0, 1, 0}, 0.7, 24, 16, 0.1, 50);
    const DepthImage picture = traced_picture(tracer, {.camera = camera, .samples = 1}).picture;
    glm::dvec3 x, y, axis = -glm::dvec3(light.direction);
    const auto across = [&](const glm::dvec3& w) {
      x = glm::normalize(glm::cross(w, glm::dvec3(1, 0, 0))), y = glm::cross(w, x);
    };
    int partly = 0;
    for (int row = 0; row < camera.height; ++row)
      for (int column = 0; column < camera.width; ++column) {
        if (picture.object(column, row) != 1) continue;
        const glm::dvec3 d = ray_of_texel(camera, column, row), at = eye - eye.y / d.y * d;
        const auto place = [&](double u, double t) {
          const double turn = 2 * glm::pi<double>() * t;
          if (sun) {
            across(axis);
            const double c = 1 - u * (1 - std::cos(glm::radians(12.0)));
            const glm::dvec3 side = std::cos(turn) * x + std::sin(turn) * y;
            return std::pair(c * axis + std::sqrt(1 - c * c) * side, 3.0);
          }
          const glm::dvec3 center = glm::dvec3(light.position) - at;
          across(glm::normalize(center));
          const glm::dvec3 to =
              center + 0.7 * std::sqrt(u) * (std::cos(turn) * x + std::sin(turn) * y);
          return std::pair(glm::normalize(to), 60.0 / glm::dot(to, to));
        };
        const double expected = floor_light(place, at, eye), open = 3 * 0.8 / glm::pi<double>();
        partly += expected > 0.1 * open && expected < 0.9 * open;
        // 256 places of an even sequence: the border of the shadow leaves about sqrt(256) of them
        // undecided, so that their share is right to 1 in 50.
        EXPECT_NEAR(double(picture.color(column, row).r), expected, 0.02 * open)
            << sun << ' ' << at.x;
      }
    EXPECT_GT(partly, 20);
  }
}

TEST(RayTracer, depths_and_objects_are_those_of_all_other_sources) {
  for (const char* name : {"builtin:teapots?triangles=20000", "builtin:stonehenge"}) {
    const auto built = make_builtin(name);
    ASSERT_TRUE(built) << built.error().message();
    const auto rays = RayScene::create(built->scene);
    ASSERT_TRUE(rays);
    RayTracer tracer(*rays, {.bounces = 1, .light_samples = 1});
    RaySource source(*rays);
    const Box bounds = world_bounds(built->scene);
    Random random(3);
    for (int round = 0; round < 6; ++round) {
      const double radius = double(bounds.radius());
      const glm::dvec3 out = glm::normalize(
          glm::dvec3(random.between(-1, 1), random.between(0.1f, 1), random.between(-1, 1)));
      Camera camera =
          look_at(glm::dvec3(bounds.center()) + 1.3 * radius * out, glm::dvec3(bounds.center()),
                  {0, 1, 0}, 0.9, 37, 29, 0.3 * radius, 2.4 * radius);
      camera.projection = Projection(round % 3);
      if (camera.projection == Projection::parallel)
        camera.window = {-0.7 * radius, 0.7 * radius, -0.5 * radius, 0.5 * radius};
      const std::uint32_t some[] = {0, 2};
      const int samples = round % 2 ? 4 : 1;
      CaptureRequest request{.camera = camera, .samples = samples, .farthest = true};
      if (round % 2) request.objects = some;
      const CapturedPicture traced = traced_picture(tracer, request);
      // Of texels' centres: a thin surface that only samples see is others' alone.
      request.samples = 1;
      const CapturedPicture cast = traced_picture(source, request);
      EXPECT_TRUE(validate(traced.picture).ok());
      // Beside silhouettes, a tracer's texels show what only their samples see.
      for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x)
          if (cast.picture.covered(x, y) || samples == 1) {
            EXPECT_EQ(traced.picture.depth(x, y), cast.picture.depth(x, y));
            EXPECT_EQ(traced.picture.object(x, y), cast.picture.object(x, y));
          }
      EXPECT_TRUE(traced.farthest == cast.farthest);
    }
  }
}

// Where nothing is mirrored and nothing shadowed, it is the library's shading.
TEST(RayTracer, a_rough_convex_body_looks_as_everywhere) {
  Scene scene;
  Material rough;
  rough.roughness = 1, rough.base_color = {0.8f, 0.5f, 0.3f, 1};
  add_traced(scene, box_between({-1, -0.7f, -0.5f}, {0.6f, 0.8f, 1}), rough);
  finish(scene);
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RayTracer tracer(*rays, {.sun_degrees = 0});
  RaySource source(*rays);
  for (const glm::dvec3 eye : {glm::dvec3(3, 2, 4), glm::dvec3(-4, 1, 2), glm::dvec3(1, -4, -2)}) {
    const CaptureRequest request{look_at(eye, {0, 0, 0}, {0, 1, 0}, 0.7, 64, 48, 0.5, 9), {}, 1};
    const DepthImage traced = traced_picture(tracer, request).picture;
    const DepthImage cast = traced_picture(source, request).picture;
    for (std::size_t i = 0; i < cast.color.texels().size(); ++i)
      for (int c = 0; c < 4; ++c)  // the same operations in another order
        EXPECT_NEAR(traced.color.texels()[i][c], cast.color.texels()[i][c], 1e-6f);
  }
}

Scene glossy_scene() {
  Scene scene;
  Material floor, mirror;
  floor.base_color = {0.6f, 0.6f, 0.5f, 1}, floor.double_sided = true, floor.roughness = 0.4f;
  mirror.metallic = 0.9f, mirror.roughness = 0.1f;
  add_traced(scene, traced_quad({-4, -1, 4}, {4, -1, 4}, {4, -1, -4}, {-4, -1, -4}), floor);
  add_traced(scene, traced_sphere(24), mirror);
  finish(scene);
  return scene;
}

TEST(RayTracer, the_picture_depends_on_the_seed_but_not_on_threads_or_watchers) {
  const Scene scene = glossy_scene();
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RayTracer tracer(*rays, {.sun_degrees = 8});
  RayTracer other(*rays, {.sun_degrees = 8, .seed = 2});
  CaptureRequest request{look_at({3, 2, 4}, {0, 0, 0}, {0, 1, 0}, 0.8, 45, 35, 0.5, 30), {}, 8};
  const CapturedPicture picture = traced_picture(tracer, request);
  CapturedPicture alone;
  tbb::task_arena(1).execute([&] { alone = traced_picture(tracer, request); });
  EXPECT_TRUE(alone.picture.color == picture.picture.color);
  EXPECT_FALSE(traced_picture(other, request).picture.color == picture.picture.color);
  EXPECT_TRUE(traced_picture(other, request).picture.depth == picture.picture.depth);

  CaptureControl control;
  std::vector<CapturedPicture> coarse;
  control.refined = [&](const CapturedPicture& p) { coarse.push_back(p); };
  request.control = &control;
  EXPECT_TRUE(traced_picture(tracer, request).picture.color == picture.picture.color);
  request.control = nullptr, request.samples = 1;
  const CapturedPicture centers = traced_picture(tracer, request);
  // One texel in 64, in 16, in 4, all; then 4 of the 8 samples.
  ASSERT_EQ(coarse.size(), 5u);
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    EXPECT_TRUE(validate(coarse[k].picture).ok());
    const int step = std::max(1, 8 >> k);
    for (int y = 0; y < 35; ++y)
      for (int x = 0; x < 45; ++x)
        // Those that samples beside their centre alone show come with these.
        if (k == 4 || centers.picture.covered(x - x % step, y - y % step)) {
          EXPECT_EQ(coarse[k].picture.depth(x, y),
                    picture.picture.depth(x - x % step, y - y % step));
        }
  }
}

// Coverage is that of rays through many places of the texel, on both sides of a silhouette.
TEST(RayTracer, silhouettes_are_antialiased_on_both_sides) {
  Scene scene;
  add_traced(scene, traced_sphere(64), Material{});
  finish(scene);
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RayTracer tracer(*rays, {.bounces = 0, .light_samples = 1});
  CaptureRequest request{look_at({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 0.7, 40, 40, 0.5, 9), {}, 64};
  const DepthImage picture = traced_picture(tracer, request).picture;
  request.samples = 1;
  const DepthImage centers = traced_picture(tracer, request).picture;
  // The slow definition: 16 x 16 texels of a finer picture for each texel.
  request.camera.width = request.camera.height = 640;
  const DepthImage fine = traced_picture(tracer, request).picture;
  int beside = 0, inside = 0;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      int covered = 0;
      for (int n = 0; n < 256; ++n) covered += fine.covered(16 * x + n % 16, 16 * y + n / 16);
      // 64 samples, and a line through 16 x 16: each is right to about 1 in 16.
      EXPECT_NEAR(double(picture.color(x, y).a), covered / 256.0, 0.1) << x << ' ' << y;
      const bool partly = covered > 26 && covered < 230;
      (centers.covered(x, y) ? inside : beside) += partly;
      EXPECT_TRUE(!partly || picture.covered(x, y));
    }
  EXPECT_GT(beside, 20);
  EXPECT_GT(inside, 10);
}

TEST(RayTracer, a_stopped_capture_fails_and_says_so) {
  const Scene scene = glossy_scene();
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RayTracer tracer(*rays);
  for (int after = 0; after < 5; ++after) {
    std::stop_source stop;
    CaptureControl control{stop.get_token(), {}};
    int seen = 0;
    control.refined = [&](const CapturedPicture&) {
      if (++seen == after) stop.request_stop();
    };
    if (after == 0) stop.request_stop();
    CaptureRequest request{look_at({3, 2, 4}, {0, 0, 0}, {0, 1, 0}, 0.8, 45, 35, 0.5, 30), {}, 9};
    request.control = &control;
    const Result<CapturedPicture> stopped = tracer.capture(request);
    ASSERT_FALSE(stopped.ok());
    EXPECT_EQ(stopped.error().reason, kCaptureStopped);
    EXPECT_EQ(seen, after);
  }
}

TEST(RayTracer, gives_way_before_each_texel) {
  const Scene scene = glossy_scene();
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RayTracer tracer(*rays);
  std::atomic<int> calls{0};
  CaptureControl control;
  control.give_way = [&] { ++calls; };
  CaptureRequest request{look_at({3, 2, 4}, {0, 0, 0}, {0, 1, 0}, 0.8, 45, 35, 0.5, 30), {}, 4};
  const CapturedPicture alone = traced_picture(tracer, request);
  request.control = &control;
  EXPECT_TRUE(traced_picture(tracer, request).picture.color == alone.picture.color);
  int covered = 0;
  for (int y = 0; y < 35; ++y)
    for (int x = 0; x < 45; ++x) covered += alone.picture.covered(x, y);
  EXPECT_GT(covered, 100);
  // And before each other sample of those that show something.
  EXPECT_GE(calls, 45 * 35 + 3 * covered);
}

TEST(RayTracer, impossible_requests_are_refused) {
  const Scene scene = glossy_scene();
  const auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RayTracer tracer(*rays);
  const Camera camera = look_at({3, 2, 4}, {0, 0, 0}, {0, 1, 0}, 0.8, 8, 8, 0.5, 30);
  Camera flat = camera;
  flat.z_far = flat.z_near;
  EXPECT_FALSE(tracer.capture({.camera = flat}).ok());
  EXPECT_FALSE(tracer.capture({.camera = camera, .samples = 0}).ok());
  EXPECT_FALSE(tracer.capture({.camera = camera, .samples = 5000}).ok());
  EXPECT_FALSE(tracer.capture({.camera = camera, .with_sky = true}).ok());
}

// The texel rule (core/texel_rule.h).
TEST(RayTracer, colours_are_those_of_the_surface_whose_depth_a_texel_has) {
  Random random(1);
  int edges = 0;
  for (int round = 0; round < 6; ++round) {
    const Scene scene = test_plate::plate(random, round % 2);
    const Result<RayScene> rays = RayScene::create(scene, 0, RayParts::all);
    ASSERT_TRUE(rays);
    RayTracer tracer(*rays);
    const Camera camera = test_plate::plate_camera(random, 60);
    const auto captured = tracer.capture({.camera = camera, .samples = round < 3 ? 4 : 16});
    ASSERT_TRUE(captured);
    const DepthImage& picture = captured->picture;
    const auto is_red = [&](int x, int y) {
      return test_plate::is_plate(camera, {x + 0.5, y + 0.5}, picture.depth(x, y));
    };
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x) {
        if (!picture.covered(x, y)) continue;
        ASSERT_LT(test_plate::off_surface(picture, x, y), 1e-5f) << round << ' ' << x << ' ' << y;
        edges += x > 0 && picture.covered(x - 1, y) && is_red(x, y) != is_red(x - 1, y);
      }
  }
  EXPECT_GT(edges, 150);
}

}  // namespace
}  // namespace rilievo
