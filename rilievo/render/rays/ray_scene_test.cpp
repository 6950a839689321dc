#include "rilievo/render/rays/ray_scene.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/core/random.h"
#include "rilievo/render/rays/box_test_helpers.h"
#include "rilievo/render/rays/cast_picture.h"

namespace rilievo {
namespace {

// Boxes of all kinds: mirrored, single- and double-sided, blended, cut out by a texture.
Scene scene_to_trace(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(-1, 1);
  Scene scene;
  scene.images.emplace_back(2, 2, glm::u8vec4(255));
  scene.images[0](0, 0).a = scene.images[0](1, 1).a = 0;
  Texture holes;
  holes.nearest = true;
  scene.textures.push_back(holes);
  Material single, both, blended, masked;
  both.double_sided = true;
  blended.alpha_mode = AlphaMode::blend;
  masked.alpha_mode = AlphaMode::mask;
  masked.base_color_texture.texture = 0;
  scene.materials = {single, both, blended, masked};
  for (int m = -1; m < 4; ++m) {
    Mesh mesh = box_between({-0.5f, -0.3f, -0.2f}, {0.4f, 0.6f, 0.3f});
    mesh.material = m;
    for (const glm::vec3& p : mesh.positions) mesh.uv[0].push_back({3 * p.x, 3 * p.y + p.z});
    scene.meshes.push_back(mesh);
  }
  Model model;
  for (int m = 0; m < 5; ++m) {
    glm::mat4 place = glm::translate(glm::mat4(1), 2.0f * glm::vec3(u(rng), u(rng), u(rng)));
    if (m % 2) place = glm::scale(place, {-1, 0.7f, 1.2f});
    model.parts.push_back({m, place});
  }
  scene.models.push_back(model);
  for (int i = 0; i < 3; ++i) {
    Object object;
    object.placement = glm::translate(glm::mat4(1), 2.0f * glm::vec3(u(rng), u(rng), u(rng)));
    object.placement = glm::rotate(object.placement, 3 * u(rng), {0.6f, 0.8f, 0});
    if (i == 1) object.placement = glm::scale(object.placement, {1, 1, -1.5f});
    scene.objects.push_back(object);
  }
  finish(scene);
  return scene;
}

struct SlowHit {
  double distance = 1e300;
  std::uint32_t object = 0, triangle = 0;
  int part = 0;
  glm::dvec3 normal{0.0};
};

// By definition: every triangle of every object, in world space and doubles.
SlowHit slow_first_hit(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  SlowHit best;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const Model& model = scene.models[scene.objects[o].model];
    for (int p = 0; p < int(model.parts.size()); ++p) {
      const Mesh& mesh = scene.meshes[model.parts[p].mesh];
      const Material* material = mesh.material < 0 ? nullptr : &scene.materials[mesh.material];
      if (material && material->alpha_mode == AlphaMode::blend) continue;
      const glm::dmat4 place =
          glm::dmat4(scene.objects[o].placement) * glm::dmat4(model.parts[p].model_from_mesh);
      for (std::uint32_t t = 0; t < mesh.indices.size() / 3; ++t) {
        glm::dvec3 c[3];
        for (int k = 0; k < 3; ++k)
          c[k] = glm::dvec3(place * glm::dvec4(mesh.positions[mesh.indices[3 * t + k]], 1));
        const glm::dvec3 solved =
            glm::inverse(glm::dmat3(c[1] - c[0], c[2] - c[0], -direction)) * (origin - c[0]);
        if (!(solved.x >= 0 && solved.y >= 0 && solved.x + solved.y <= 1 && solved.z > 0 &&
              solved.z < best.distance))
          continue;
        glm::dvec3 normal = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
        if (glm::determinant(glm::dmat3(place)) < 0) normal = -normal;
        if (!(material && material->double_sided) && glm::dot(normal, direction) > 0) continue;
        if (material && material->alpha_mode == AlphaMode::mask) {
          const glm::dvec2 uv[3] = {mesh.uv[0][mesh.indices[3 * t]],
                                    mesh.uv[0][mesh.indices[3 * t + 1]],
                                    mesh.uv[0][mesh.indices[3 * t + 2]]};
          const glm::dvec2 at = uv[0] + solved.x * (uv[1] - uv[0]) + solved.y * (uv[2] - uv[0]);
          const glm::ivec2 cell = glm::ivec2(glm::floor(2.0 * at));
          if (((cell.x ^ cell.y) & 1) == 0) continue;
        }
        best = {solved.z, o + 1, t, p, normal};
      }
    }
  }
  return best;
}

TEST(RayScene, meets_what_every_triangle_tried_in_turn_meets) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<float> u(-1, 1);
  int hits = 0, disagreements = 0;
  for (int s = 0; s < 10; ++s) {
    const Scene scene = scene_to_trace(rng);
    const Result<RayScene> rays = RayScene::create(scene);
    ASSERT_TRUE(rays.ok()) << rays.error().message();
    for (int i = 0; i < 400; ++i) {
      const glm::vec3 origin = 6.0f * glm::normalize(glm::vec3(u(rng), u(rng), u(rng)));
      const glm::vec3 target = 2.0f * glm::vec3(u(rng), u(rng), u(rng));
      const SlowHit slow = slow_first_hit(scene, origin, target - origin);
      const std::optional<RayHit> hit = rays->first_hit(origin, target - origin, 0.0f, 100.0f);
      const bool slow_met = slow.distance < 100;
      EXPECT_EQ(rays->occluded(origin, target - origin, 0.0f, 100.0f), hit.has_value());
      // 1e-5: floats of size 6 carry 5e-7; where an edge is grazed either answer is right.
      if (hit.has_value() != slow_met || (hit && std::abs(hit->distance - slow.distance) > 1e-5)) {
        ++disagreements;
        continue;
      }
      if (!hit) continue;
      ++hits;
      EXPECT_EQ(hit->object, slow.object);
      EXPECT_EQ(hit->part, slow.part);
      EXPECT_GT(glm::dot(glm::dvec3(hit->normal), slow.normal), 1 - 1e-5);
    }
  }
  EXPECT_GT(hits, 1000);
  // One ray in a thousand may graze an edge, or a texel of the cut-out, within rounding.
  EXPECT_LE(disagreements, 4);
}

TEST(RayScene, what_is_not_kept_is_passed_as_if_it_were_told_to_be_and_comes_back) {
  std::mt19937 rng(8);
  std::uniform_real_distribution<float> u(-1, 1);
  const Scene scene = scene_to_trace(rng);
  Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok()) << rays.error().message();
  const std::vector<std::vector<std::uint32_t>> sets = {{1}, {0, 2}, {2}, {}, {0, 1, 2}};
  int hits = 0, without = 0;
  for (const std::vector<std::uint32_t>& objects : sets)
    for (int i = 0; i < 200; ++i) {
      const glm::vec3 origin = 6.0f * glm::normalize(glm::vec3(u(rng), u(rng), u(rng)));
      const glm::vec3 way = 2.0f * glm::vec3(u(rng), u(rng), u(rng)) - origin;
      ASSERT_TRUE(rays->keep_objects({}).ok());
      const std::optional<RayHit> told =
          rays->first_hit(origin, way, 0.0f, 100.0f, RaySides::seen, ObjectSet(scene, objects));
      ASSERT_TRUE(rays->keep_objects(objects).ok());
      const std::optional<RayHit> hit = rays->first_hit(origin, way, 0.0f, 100.0f);
      ASSERT_EQ(hit.has_value(), told.has_value());
      ++(hit ? hits : without);
      if (!hit) continue;
      EXPECT_EQ(hit->object, told->object);
      EXPECT_EQ(hit->part, told->part);
      EXPECT_EQ(hit->triangle, told->triangle);
      EXPECT_EQ(hit->distance, told->distance);
    }
  EXPECT_GT(hits, 150);
  EXPECT_GT(without, 100);
}

TEST(RayScene, blended_parts_that_rays_hit_have_their_textures) {
  Scene opaque;
  opaque.images.emplace_back(2, 1, glm::u8vec4(255));
  opaque.images[0](0, 0) = {0, 0, 0, 255};
  opaque.textures.emplace_back().nearest = true;
  Material& material = opaque.materials.emplace_back();
  material.unlit = true, material.base_color_texture.texture = 0;
  Mesh& mesh = opaque.meshes.emplace_back();
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.material = 0;
  opaque.models.emplace_back().parts.push_back({0, glm::mat4(1)});
  opaque.objects.emplace_back();
  finish(opaque);
  Scene blended = opaque;
  blended.materials[0].alpha_mode = AlphaMode::blend;
  const Result<RayScene> expected_rays = RayScene::create(opaque);
  const Result<RayScene> rays = RayScene::create(blended, 0, RayParts::all);
  ASSERT_TRUE(expected_rays.ok() && rays.ok());
  const Camera camera = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.5, 16, 16, 1, 9);
  const HitShader expected(*expected_rays, camera), shader(*rays, camera);
  int dark = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const CameraRay ray = camera_ray(camera, {x + 0.5, y + 0.5});
      const std::optional<RayHit> hit = rays->first_hit(ray.origin, ray.direction, 0.0f, 1.0f);
      ASSERT_TRUE(hit.has_value());
      const glm::vec4 color = shader.shade(*hit, x, y);
      EXPECT_EQ(color, expected.shade(*hit, x, y)) << x << " " << y;
      dark += color.g < 0.5f;
    }
  EXPECT_EQ(dark, 128);
}

TEST(CastPicture, back_perspective_keeps_the_farthest_and_holds_five_faces_of_a_cube) {
  Scene scene;
  // One material, and so one part, a face: parts tell which face a texel shows.
  const Mesh cube = box_between({-1, -1, -1}, {1, 1, 1});
  Model model;
  for (int face = 0; face < 6; ++face) {
    Mesh mesh;
    mesh.positions = cube.positions;
    mesh.indices.assign(cube.indices.begin() + 6 * face, cube.indices.begin() + 6 * face + 6);
    scene.meshes.push_back(mesh);
    model.parts.push_back({face, glm::mat4(1)});
  }
  scene.models.push_back(model);
  scene.objects.emplace_back();
  finish(scene);
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    Result<Camera> camera = tight_camera(kind, {0, 0, -4}, {0, 1, 0}, world_bounds(scene));
    ASSERT_TRUE(camera.ok());
    camera->width = camera->height = 64;
    const DepthImage picture = cast_picture(*rays, *camera);
    ASSERT_TRUE(validate(picture).ok());
    std::array<int, 6> texels{};
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        if (!picture.covered(x, y)) continue;
        const glm::dvec3 p = world_from_raster(*camera, {x + 0.5, y + 0.5}, picture.depth(x, y));
        // On the cube: 1e-5 for floats of size 4.
        EXPECT_NEAR(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1.0, 1e-5);
        for (int axis = 0; axis < 3; ++axis)
          if (std::abs(std::abs(p[axis]) - 1) < 1e-5) ++texels[2 * axis + (p[axis] > 0)];
      }
    // The apex stands at z = -4: as an eye it sees the face at z = -1 alone, as an apex all others.
    const bool back = kind == Projection::back_perspective;
    for (int face : {0, 1, 2, 3}) EXPECT_EQ(texels[face] > 100, back) << face;
    EXPECT_EQ(texels[4] > 100, !back);
    EXPECT_EQ(texels[5] > 100, back);
  }
}

// The first of balls and rods that a ray enters, by their formulae in doubles.
double nearest_stroke(const std::vector<std::array<glm::dvec3, 2>>& rods, double radius,
                      const glm::dvec3& origin, const glm::dvec3& to) {
  double nearest = 1e9;
  const auto ball = [&](const glm::dvec3& center) {
    const glm::dvec3 from = origin - center;
    const double b = glm::dot(from, to), c = glm::dot(from, from) - radius * radius;
    if (b * b - c < 0) return;
    const double t = -b - std::sqrt(b * b - c);
    if (t > 0) nearest = std::min(nearest, t);
  };
  for (const auto& [a, b] : rods) {
    ball(a), ball(b);
    const double length = glm::distance(a, b);
    if (length == 0) continue;
    const glm::dvec3 axis = (b - a) / length, from = origin - a;
    const glm::dvec3 across = to - axis * glm::dot(to, axis);
    const glm::dvec3 beside = from - axis * glm::dot(from, axis);
    const double k = glm::dot(across, across), m = glm::dot(across, beside);
    const double disc = m * m - k * (glm::dot(beside, beside) - radius * radius);
    if (k < 1e-12 || disc < 0) continue;
    const double t = (-m - std::sqrt(disc)) / k, along = glm::dot(from + t * to, axis);
    if (t > 0 && 0 <= along && along <= length) nearest = std::min(nearest, t);
  }
  return nearest;
}

TEST(RayScene, rays_hit_points_as_balls_and_lines_as_rods_if_asked) {
  for (const Primitive primitive : {Primitive::points, Primitive::lines}) {
    Random random(21);
    const auto around = [&](float size) {
      const float x = random.between(-size, size), y = random.between(-size, size);
      return glm::vec3(x, y, random.between(-size, size));
    };
    Scene scene;
    Mesh mesh;
    mesh.primitive = primitive;
    mesh.width = 0.3f;
    std::vector<std::array<glm::dvec3, 2>> rods;
    for (int i = 0; i < 40; ++i) {
      const std::array<glm::vec3, 2> ends{around(3), around(3)};
      for (std::uint32_t k = 0; k < corners_of(primitive); ++k) {
        mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
        mesh.positions.push_back(ends[k]);
      }
      rods.push_back({ends[0], primitive == Primitive::lines ? ends[1] : ends[0]});
    }
    scene.meshes.push_back(mesh);
    scene.models.emplace_back().parts = {Part{0}};
    scene.objects.emplace_back();
    finish(scene);
    const Result<RayScene> rays = RayScene::create(scene, 0, RayParts::strokes);
    const Result<RayScene> none = RayScene::create(scene);
    ASSERT_TRUE(rays.ok() && none.ok());
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const glm::vec3 origin = 8.0f * glm::normalize(around(1));
      const glm::vec3 to = glm::normalize(around(3) - origin);
      const double expected = nearest_stroke(rods, 0.15, glm::dvec3(origin), glm::dvec3(to));
      const std::optional<RayHit> hit = rays->first_hit(origin, to, 0, 100);
      EXPECT_FALSE(none->first_hit(origin, to, 0, 100));
      // Embree's lines may be off by some 1e-4 of the distance; rays that graze may miss.
      if (!hit) continue;
      EXPECT_NEAR(double(hit->distance), expected, 3e-3) << i;
      ++hits;
    }
    EXPECT_GT(hits, 100);
  }
}

}  // namespace
}  // namespace rilievo
