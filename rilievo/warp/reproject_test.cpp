#include "rilievo/warp/reproject.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/sanitized_test_helpers.h"

namespace rilievo {
namespace {

// Shapes thrown about, within a box of radius 2.
Scene random_scene(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(-1, 1);
  Scene scene;
  for (int i = 0; i < 5; ++i) {
    const glm::vec3 color = 0.5f + 0.4f * glm::vec3(u(rng), u(rng), u(rng));
    const glm::mat4 place =
        glm::rotate(glm::translate(glm::mat4(1), glm::vec3(u(rng), u(rng), u(rng))), 3 * u(rng),
                    glm::normalize(glm::vec3(u(rng), u(rng), 1.1f)));
    const float size = 0.45f + 0.25f * u(rng);
    if (i % 3 == 0) test_shapes::add(scene, test_shapes::sphere(size), color, place);
    if (i % 3 == 1) test_shapes::add(scene, test_shapes::box(glm::vec3(size)), color, place);
    if (i % 3 == 2) test_shapes::add(scene, test_shapes::torus(size, 0.2), color, place);
  }
  finish(scene);
  return scene;
}

// Photographs from all around, at random places.
std::vector<DepthImage> photographs_of(const Scene& scene, std::mt19937& rng, int count, int size) {
  const Result<RayScene> rays = RayScene::create(scene);
  std::vector<DepthImage> pictures;
  const ViewSet set = make_view_set({.spread = ViewSpread::both_32});
  for (int i = 0; i < count; ++i) {
    std::normal_distribution<double> n;
    const glm::dvec3 direction = count == 32 ? set.directions[std::size_t(i)]
                                             : glm::normalize(glm::dvec3(n(rng), n(rng), n(rng)));
    pictures.push_back(cast_picture(
        *rays, look_at(5.0 * direction, {0, 0, 0}, {0.1, 1, 0.2}, 0.9, size, size, 0.5, 20)));
  }
  return pictures;
}

Box grown(Box box, float by) {
  box.min -= glm::vec3(by);
  box.max += glm::vec3(by);
  return box;
}

// The slow definition: every target ray against every triangle between three linked texels of a
// cell.
struct SlowTriangle {
  std::array<glm::dvec3, 3> corner;
  std::array<glm::vec4, 3> color;
  double eye_z = 0;  // mean, of its photograph
};

std::vector<SlowTriangle> triangles_of(const DepthImage& picture, const Box& box) {
  const Image<std::uint8_t> links = texel_links(picture);
  std::vector<SlowTriangle> list;
  const auto place = [&](glm::ivec2 p) {
    return world_from_raster(picture.camera, glm::dvec2(p) + 0.5, picture.depth(p.x, p.y));
  };
  const auto inside = [&](glm::ivec2 p) {
    if (!picture.covered(p.x, p.y)) return false;
    const glm::dvec3 at = place(p);
    for (int a = 0; a < 3; ++a)
      if (at[a] < double(box.min[a]) || at[a] > double(box.max[a])) return false;
    return true;
  };
  const auto linked = [&](glm::ivec2 p, glm::ivec2 r) {
    if (!inside(p) || !inside(r)) return false;
    for (int k = 0; k < 8; ++k)
      if (kLinkSteps[std::size_t(k)] == r - p) return bool(links(p.x, p.y) >> k & 1);
    return false;
  };
  const auto add = [&](glm::ivec2 p, glm::ivec2 r, glm::ivec2 s) {
    if (!linked(p, r) || !linked(r, s) || !linked(s, p)) return;
    SlowTriangle triangle;
    int i = 0;
    for (const glm::ivec2& t : {p, r, s}) {
      triangle.corner[std::size_t(i)] = place(t);
      triangle.color[std::size_t(i++)] = picture.color(t.x, t.y);
      triangle.eye_z += double(picture.depth(t.x, t.y)) / 3;
    }
    list.push_back(triangle);
  };
  for (int y = 0; y + 1 < picture.camera.height; ++y)
    for (int x = 0; x + 1 < picture.camera.width; ++x) {
      const glm::ivec2 a{x, y}, b{x + 1, y}, c{x, y + 1}, d{x + 1, y + 1};
      const float down = std::abs(picture.depth(x, y) - picture.depth(x + 1, y + 1));
      const float up = std::abs(picture.depth(x + 1, y) - picture.depth(x, y + 1));
      if (linked(a, d) && (!linked(b, c) || down <= up)) {
        add(a, b, d);
        add(a, d, c);
      } else {
        add(a, b, c);
        add(b, d, c);
      }
    }
  return list;
}

struct SlowSample {
  double eye_z = 0, trusted = 0, density = 0;
  glm::vec4 color{0.0f};
};

// Moeller and Trumbore; only from the front for an ordinary target, only from the back else.
std::optional<SlowSample> meet(const SlowTriangle& triangle, const Camera& camera, int x, int y,
                               double depth_error) {
  const glm::dvec3 origin = camera.position();
  const glm::dvec3 ray = world_from_raster(camera, {x + 0.5, y + 0.5}, 1.0) - origin;
  const auto& [p0, p1, p2] = triangle.corner;
  // Corners turn clockwise as photographed with y down: counter-clockwise in space is 0 2 1.
  const glm::dvec3 normal = glm::cross(p2 - p0, p1 - p0);
  const double facing = glm::dot(normal, ray);
  if (camera.keeps_farthest() ? facing <= 0 : facing >= 0) return std::nullopt;
  const double t = glm::dot(normal, p0 - origin) / facing;
  const glm::dvec3 at = origin + t * ray;
  const double area2 = glm::dot(normal, normal);
  const double b1 = glm::dot(glm::cross(p2 - p0, at - p0), normal) / area2;
  const double b2 = glm::dot(glm::cross(at - p0, p1 - p0), normal) / area2;
  if (b1 < 0 || b2 < 0 || b1 + b2 > 1 || t < camera.z_near || t > camera.z_far) return std::nullopt;
  return SlowSample{t, depth_error * triangle.eye_z, 1 / std::sqrt(area2),
                    float(1 - b1 - b2) * triangle.color[0] + float(b1) * triangle.color[1] +
                        float(b2) * triangle.color[2]};
}

TEST(Reproject, is_what_every_ray_against_every_triangle_finds) {
  for (unsigned seed = 0; seed < unsigned(sanitized_cases(6)); ++seed) {
    std::mt19937 rng(seed);
    const Scene scene = random_scene(rng);
    const std::vector<DepthImage> photographs = photographs_of(scene, rng, 3, 40);
    const Box bounds = world_bounds(scene);
    // The odd ones cut through the shapes.
    const Box box = grown(bounds, seed % 2 ? -0.3f : 0.1f);
    std::vector<Camera> targets;
    for (Projection kind : {Projection::perspective, Projection::back_perspective})
      targets.push_back(
          *view_camera(bounds, {0.3 * seed, 0.2, 1}, {.projection = kind, .size = 24}));
    const ReprojectOptions options{.box = box};
    const Reprojection fast = reproject(photographs, targets, options);
    int compared = 0, off = 0;
    for (std::size_t i = 0; i < targets.size(); ++i)
      for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 24; ++x) {
          std::vector<SlowSample> samples;
          for (const DepthImage& photograph : photographs)
            for (const SlowTriangle& triangle : triangles_of(photograph, box))
              if (const auto hit = meet(triangle, targets[i], x, y, options.depth_error))
                samples.push_back(*hit);
          ++compared;
          if (samples.empty()) {
            off += fast.pictures[i].covered(x, y);
            continue;
          }
          const double sign = targets[i].keeps_farthest() ? -1 : 1;
          double front = 1e300;
          for (const SlowSample& s : samples) front = std::min(front, sign * s.eye_z);
          std::erase_if(samples,
                        [&](const SlowSample& s) { return sign * s.eye_z - front > s.trusted; });
          double total = 0, eye_z = 0;
          glm::vec4 color(0.0f);
          for (const SlowSample& s : samples) {
            const double weight = s.density * s.density;
            total += weight;
            eye_z += weight * s.eye_z;
            color += float(weight) * s.color;
          }
          // Floats of a distance of 8, and of a colour of 1, summed up.
          off += std::abs(eye_z / total - double(fast.pictures[i].depth(x, y))) > 2e-5 ||
                 glm::length(color / float(total) - fast.pictures[i].color(x, y)) > 1e-4f;
        }
    EXPECT_GT(compared, 1000);
    // A centre on an edge may fall either way.
    EXPECT_LE(off, 2) << seed;
  }
}

TEST(Reproject, shows_what_a_camera_there_would_see) {
  for (unsigned seed = 10; seed < 14; ++seed) {
    std::mt19937 rng(seed);
    const Scene scene = random_scene(rng);
    const Result<RayScene> rays = RayScene::create(scene);
    const Box bounds = world_bounds(scene);
    const std::vector<DepthImage> photographs = photographs_of(scene, rng, 32, 160);
    std::vector<Camera> targets;
    for (int i = 0; i < 6; ++i)
      targets.push_back(*view_camera(
          bounds, make_view_set({}).directions[std::size_t(5 * i)],
          {.projection = i % 2 ? Projection::perspective : Projection::back_perspective,
           .size = 64}));
    const Reprojection made = reproject(photographs, targets, {.box = grown(bounds, 0.1f)});
    double inside = 0, missing = 0, both = 0, off = 0, outside = 0, extra = 0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const DepthImage truth = cast_picture(*rays, targets[i]);
      for (int y = 1; y < 63; ++y)
        for (int x = 1; x < 63; ++x) {
          // Away from outlines and creases: there a texel more or less is another surface.
          float low = kNoDepth, high = 0;
          bool some = false, all = true;
          for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
              const float d = truth.depth(x + dx, y + dy);
              (d == kNoDepth ? all : some) = d != kNoDepth;
              low = std::min(low, d);
              high = std::max(high, d);
            }
          outside += !some;
          extra += !some && made.pictures[i].covered(x, y);
          if (!all || high - low > 0.4f) continue;
          ++inside;
          missing += !made.pictures[i].covered(x, y);
          if (!made.pictures[i].covered(x, y)) continue;
          ++both;
          // A photograph's texel is 0.03 wide at the shapes; steeper than 45 degrees, and with the
          // 2 % by which samples of one surface may differ, 0.15.
          off += std::abs(made.pictures[i].depth(x, y) - truth.depth(x, y)) > 0.15f;
        }
    }
    EXPECT_GT(inside, 2000);
    EXPECT_LT(missing, 0.01 * inside) << seed;
    EXPECT_LT(off, 0.01 * both) << seed;
    EXPECT_LE(extra, 0.002 * outside) << seed;
    // With photographs all around hardly anything is unknown; the scene's inside is closed.
    EXPECT_LT(made.total.hole_share(), 0.05) << seed;
  }
}

// A wall z = 0 that faces +z, photographed from there.
DepthImage wall_photograph() {
  DepthImage p;
  p.camera = look_at({0.3, 0.1, 3}, {0, 0, 0}, {0, 1, 0}, 0.6, 64, 64, 0.5, 10);
  p.color = ColorImage(64, 64, glm::vec4(0.5f, 0.5f, 0.5f, 1));
  p.depth = Image<float>(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const glm::dvec3 eye = p.camera.position();
      const glm::dvec3 ray = world_from_raster(p.camera, {x + 0.5, y + 0.5}, 1) - eye;
      p.depth(x, y) = float(-eye.z / ray.z);
    }
  return p;
}

std::size_t shown(const DepthImage& picture) {
  const auto texels = picture.depth.texels();
  return texels.size() - std::size_t(std::count(texels.begin(), texels.end(), kNoDepth));
}

TEST(Reproject, a_wall_is_seen_from_its_front_only) {
  const std::vector<DepthImage> photographs{wall_photograph()};
  const Box box{{-0.5f, -0.5f, -0.1f}, {0.5f, 0.5f, 0.1f}};
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    std::vector<Camera> targets;
    for (double z : {1.0, -1.0})
      targets.push_back(*view_camera(box, {0.2, 0.1, z}, {.projection = kind, .size = 32}));
    const Reprojection made = reproject(photographs, targets, {.box = box});
    EXPECT_GT(shown(made.pictures[0]), 400u);
    EXPECT_EQ(shown(made.pictures[1]), 0u);
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        if (!made.pictures[0].covered(x, y)) continue;
        const glm::dvec3 world =
            world_from_raster(targets[0], {x + 0.5, y + 0.5}, made.pictures[0].depth(x, y));
        EXPECT_NEAR(world.z, 0, 1e-5);  // floats of a distance of 3
      }
  }
}

TEST(Reproject, a_plane_has_no_cracks_and_an_edge_no_skin) {
  // The wall, and on its left half another 0.5 before it.
  DepthImage photograph = wall_photograph();
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 32; ++x) photograph.depth(x, y) *= 2.5f / 3;
  const Box box{{-2, -2, -1}, {2, 2, 1}};
  for (int size : {40, 160, 600}) {
    Camera target = photograph.camera;
    target.world_from_eye =
        look_at({1.2, 0, 3}, {0, 0, 0}, {0, 1, 0}, 1, 1, 1, 1, 2).world_from_eye;
    target.width = target.height = size;
    const std::vector<DepthImage> one{photograph};
    const DepthImage made = reproject(one, std::span(&target, 1), {.box = box}).pictures[0];
    // Every row is a run of the front wall, a gap, and a run of the back wall: nothing between.
    for (int y = size / 4; y < 3 * size / 4; ++y) {
      int runs = 0;
      bool before = false;
      for (int x = 0; x < size; ++x) {
        const bool now = made.covered(x, y);
        runs += now && !before;
        before = now;
        if (!now) continue;
        const double z = world_from_raster(target, {x + 0.5, y + 0.5}, made.depth(x, y)).z;
        EXPECT_TRUE(std::abs(z) < 1e-4 || std::abs(z - 0.5) < 0.06) << z;
      }
      EXPECT_EQ(runs, 2) << size << " " << y;
    }
  }
}

TEST(Reproject, the_denser_photograph_counts_most) {
  // A near red photograph and a far green one, in either order.
  DepthImage near = wall_photograph(), far = near;
  far.camera.world_from_eye[3] += far.camera.world_from_eye[2] * 2.0;
  for (float& d : far.depth.texels()) d += 2;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const glm::dvec3 eye = far.camera.position();
      const glm::dvec3 ray = world_from_raster(far.camera, {x + 0.5, y + 0.5}, 1) - eye;
      far.depth(x, y) = float(-eye.z / ray.z);
      near.color(x, y) = {1, 0, 0, 1};
      far.color(x, y) = {0, 1, 0, 1};
    }
  const Box box{{-0.5f, -0.5f, -0.1f}, {0.5f, 0.5f, 0.1f}};
  const Camera target = *view_camera(box, {0, 0, 1}, {.size = 32});
  for (const auto& order : {std::vector{near, far}, std::vector{far, near}}) {
    const Reprojection made = reproject(order, std::span(&target, 1), {.box = box});
    for (int y = 8; y < 24; ++y)
      for (int x = 8; x < 24; ++x) {
        const float red = made.pictures[0].color(x, y).r;
        // From 3 against 5: (5 / 3)^4 = 7.7 times the weight, and a little more or less off the
        // centre.
        EXPECT_GT(red, 0.84f);
        EXPECT_LT(red, 0.94f);
      }
  }
}

TEST(Reproject, holes_are_what_no_photograph_knows) {
  const std::vector<DepthImage> photographs{wall_photograph()};
  // Only free space, seen through by the photograph: nothing is shown and nothing missing.
  const Box free{{-0.2f, -0.2f, 0.5f}, {0.2f, 0.2f, 0.9f}};
  Camera target = *view_camera(free, {0, 0, 1}, {.size = 16});
  Reprojection made = reproject(photographs, std::span(&target, 1), {.box = free});
  EXPECT_EQ(made.total.filled, 0u);
  EXPECT_EQ(made.total.holes, 0u);
  // Only space behind the wall: nothing is shown, all of it may hold something.
  const Box behind{{-0.2f, -0.2f, -0.9f}, {0.2f, 0.2f, -0.5f}};
  target = *view_camera(behind, {0, 0, 1}, {.size = 16});
  made = reproject(photographs, std::span(&target, 1), {.box = behind});
  EXPECT_EQ(made.total.filled, 0u);
  EXPECT_GT(made.total.holes, 100u);
  EXPECT_EQ(made.total.hole_share(), 1.0);
  for (const glm::vec4& c : made.pictures[0].color.texels())
    made.total.holes -= c == glm::vec4(0, 0, 0, 1);
  EXPECT_EQ(made.total.holes, 0u);
  // A photograph that is masked out knows that nothing is there.
  std::vector<DepthImage> masked = photographs;
  for (glm::vec4& c : masked[0].color.texels()) c = glm::vec4(0);
  for (float& d : masked[0].depth.texels()) d = kNoDepth;
  made = reproject(masked, std::span(&target, 1), {.box = behind});
  EXPECT_EQ(made.total.holes, 0u);
}

// A quarter of a pixel beyond the centres of 10 x 10 pixels, in which the box is seen.
TEST(Reproject, a_hole_is_where_the_ray_of_a_pixels_centre_meets_the_box) {
  const std::vector<DepthImage> photographs{wall_photograph()};
  const double eye_z = 2, front = -0.9, half_fov = 0.2;
  const Camera target = look_at({0, 0, eye_z}, {0, 0, 0}, {0, 1, 0}, 2 * half_fov, 32, 32, 0.1, 10);
  const auto half = float(4.75 / 16 * std::tan(half_fov) * (eye_z - front));
  const Box box{{-half, -half, float(front) - 1e-4f}, {half, half, float(front)}};
  const Reprojection made = reproject(photographs, std::span(&target, 1), {.box = box});
  EXPECT_EQ(made.total.filled, 0u);
  EXPECT_EQ(made.total.holes, 100u);
  const auto is_hole = [&](int x, int y) {
    return made.pictures[0].color(x, y) == glm::vec4(0, 0, 0, 1);
  };
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      EXPECT_EQ(is_hole(x, y), x >= 11 && x < 21 && y >= 11 && y < 21) << x << ' ' << y;
}

TEST(Reproject, same_bytes_for_any_number_of_threads) {
  std::mt19937 rng(5);
  const Scene scene = random_scene(rng);
  const std::vector<DepthImage> photographs = photographs_of(scene, rng, 5, 64);
  const Box bounds = world_bounds(scene);
  std::vector<Camera> targets;
  for (const glm::dvec3& direction : make_view_set({.spread = ViewSpread::faces_12}).directions)
    targets.push_back(*view_camera(bounds, direction, {.size = 32}));
  const Reprojection many = reproject(photographs, targets, {.box = bounds});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Reprojection single = reproject(photographs, targets, {.box = bounds});
  for (std::size_t i = 0; i < targets.size(); ++i) {
    EXPECT_TRUE(many.pictures[i].color == single.pictures[i].color);
    EXPECT_TRUE(many.pictures[i].depth == single.pictures[i].depth);
    EXPECT_EQ(many.stats[i].holes, single.stats[i].holes);
  }
}

TEST(Reproject, bounds_hold_what_is_measured) {
  std::mt19937 rng(6);
  const Scene scene = random_scene(rng);
  const std::vector<DepthImage> photographs = photographs_of(scene, rng, 8, 96);
  const Box box = measured_bounds(photographs, 0.0);
  Box truth;
  for (const DepthImage& p : photographs)
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x)
        if (p.covered(x, y))
          truth.add(glm::vec3(world_from_raster(p.camera, {x + 0.5, y + 0.5}, p.depth(x, y))));
  for (int a = 0; a < 3; ++a) {
    // Photographs' texels are 0.05 apart, and every fourth is asked.
    EXPECT_NEAR(box.min[a], truth.min[a], 0.2);
    EXPECT_NEAR(box.max[a], truth.max[a], 0.2);
    EXPECT_GE(box.min[a], truth.min[a] - 1e-4f);
  }
  EXPECT_TRUE(measured_bounds({}).empty());
}

}  // namespace
}  // namespace rilievo
