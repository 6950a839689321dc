#include "rilievo/layered_impostor/gl/layered_drawer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/color.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/layered_impostor/gl/layered_drawable.h"
#include "rilievo/layered_impostor/jug_test_helpers.h"
#include "rilievo/layered_impostor/lawn_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {
namespace {

using test_shapes::random_direction;

constexpr int kSize = 96;

Camera frame_camera(const Box& bounds, const glm::dvec3& direction, double distance) {
  const glm::dvec3 eye = glm::dvec3(bounds.center()) + direction * (distance * bounds.radius());
  return look_at(eye, bounds.center(), {0.1, 1, 0}, 2.2 / distance, kSize, kSize,
                 0.3 * bounds.radius(), 8.0 * bounds.radius());
}

LayeredImpostor jug_impostor(Projection kind = Projection::back_perspective) {
  return test_shapes::jug_impostor(64, {.layers = 40, .overlap = 0.2f}, kind);
}

class LayeredDrawerTest : public gl::ContextTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(ContextTest::SetUp());
    auto drawer = LayeredDrawer::create();
    ASSERT_TRUE(drawer.ok()) << drawer.error().message();
    drawer_.emplace(std::move(*drawer));
    auto probe = ProbeTarget::create(kSize, kSize);
    ASSERT_TRUE(probe.ok());
    probe_.emplace(std::move(*probe));
    auto target = FrameTarget::create(kSize, kSize, 1);
    ASSERT_TRUE(target.ok());
    target_.emplace(std::move(*target));
  }

  struct Drawn {
    Rgba8Image color;
    Image<std::uint32_t> object;
    Image<float> eye_z;
  };
  Drawn draw(LayeredPictures& pictures, const Camera& camera, const LayeredOptions& options,
             bool outlines = false, const LayeredInstance& instance = {}) {
    Drawn drawn;
    target_->begin();
    drawer_->draw(pictures, camera, {&instance, 1}, options);
    if (outlines) drawer_->draw_outlines(pictures, camera, {&instance, 1});
    target_->resolve();
    drawn.color = target_->read();
    probe_->begin();
    drawer_->draw_objects(pictures, camera, {&instance, 1}, options);
    drawn.object = probe_->read_objects();
    drawn.eye_z = probe_->read_eye_z(camera);
    EXPECT_TRUE(gl::check_errors("draw").ok());
    return drawn;
  }

  // How a drawn frame differs from the CPU's.
  struct Difference {
    int pixels = 0, coverage = 0, object = 0, depth = 0, color = 0;
  };
  static void compare(const DepthImage& expected, const Drawn& drawn, double tolerance,
                      Difference& d) {
    const Rgba8Image color = srgb8_from_linear(expected.color);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const bool covered = drawn.object(x, y) != kNoObject;
        d.pixels += expected.covered(x, y);
        d.coverage += covered != expected.covered(x, y);
        if (!covered || !expected.covered(x, y)) continue;
        d.object += drawn.object(x, y) != expected.object(x, y);
        d.depth += std::abs(drawn.eye_z(x, y) - expected.depth(x, y)) > tolerance;
        int off = 0;
        for (int k = 0; k < 3; ++k)
          off = std::max(off, std::abs(int(color(x, y)[k]) - int(drawn.color(x, y)[k])));
        d.color += off > 12;
      }
  }

  std::optional<LayeredDrawer> drawer_;
  std::optional<ProbeTarget> probe_;
  std::optional<FrameTarget> target_;
};

TEST_F(LayeredDrawerTest, surfaces_are_what_the_walk_on_the_cpu_finds) {
  for (Projection kind : {Projection::back_perspective, Projection::perspective}) {
    const LayeredImpostor impostor = jug_impostor(kind);
    auto pictures = LayeredPictures::create(impostor);
    ASSERT_TRUE(pictures.ok()) << pictures.error().message();
    std::mt19937 rng(1);
    Difference d;
    for (int i = 0; i < 8; ++i) {
      const Camera camera = frame_camera(impostor.bounds, random_direction(rng), 2.5 + 0.3 * i);
      const SurfaceWarpOptions cpu{.max_views = i % 2 ? 6 : 1, .handover = i % 4 < 2 ? 0.0 : 0.5};
      const LayeredOptions gpu{.max_views = cpu.max_views, .handover = cpu.handover};
      const Drawn drawn = draw(*pictures, camera, gpu);
      // Depth: where the surface is steep to the ray a float's error in q goes a long way.
      compare(warp_surfaces(impostor, camera, cpu), drawn, 2e-3, d);
    }
    EXPECT_GT(d.pixels, 10000);
    // Floats and doubles tell edges apart differently, a pixel here and there; colours are
    // interpolated in sRGB there and in linear light here, which shows at edges between materials.
    EXPECT_LT(d.coverage, d.pixels / 200);
    EXPECT_LT(d.depth, d.pixels / 100);
    EXPECT_LT(d.object, d.pixels / 100);
    EXPECT_LT(d.color, d.pixels / 40);
  }
}

TEST_F(LayeredDrawerTest, holes_in_pictures_are_looked_through_as_on_the_cpu) {
  std::vector<DepthImage> views = test_shapes::cast_views(
      test_shapes::jug(), make_view_set({.spread = ViewSpread::faces_12}), {.size = 64});
  // Each lost another square; its colour stays, by which a hole is known from nothing.
  for (std::size_t v = 0; v < views.size(); ++v)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x)
        views[v].depth(12 + int(v) % 3 * 10 + x, 12 + int(v) / 3 % 3 * 10 + y) = kNoDepth;
  const Result<LayeredImpostor> impostor = make_layered_impostor(views, {});
  ASSERT_TRUE(impostor.ok());
  auto pictures = LayeredPictures::create(*impostor);
  ASSERT_TRUE(pictures.ok()) << pictures.error().message();
  std::mt19937 rng(7);
  Difference d;
  for (int i = 0; i < 6; ++i) {
    EXPECT_FALSE(impostor->complete[std::size_t(i)]);
    const Camera camera = frame_camera(impostor->bounds, random_direction(rng), 3);
    const Drawn drawn = draw(*pictures, camera, {.handover = 0.25});
    compare(warp_surfaces(*impostor, camera, {.handover = 0.25}), drawn, 2e-3, d);
  }
  EXPECT_GT(d.pixels, 8000);
  // As above.
  EXPECT_LT(d.coverage, d.pixels / 200);
  EXPECT_LT(d.depth, d.pixels / 50);
  EXPECT_LT(d.color, d.pixels / 40);
}

// Seen from a little above, and from below, where it is not.
TEST_F(LayeredDrawerTest, a_one_sided_lawn_is_what_the_walk_on_the_cpu_finds) {
  const LayeredImpostor impostor = test_shapes::impostor_of_scene(test_shapes::lawn(false), kSize);
  auto pictures = LayeredPictures::create(impostor);
  ASSERT_TRUE(pictures.ok()) << pictures.error().message();
  std::mt19937 rng(8);
  Difference d;
  for (int i = 0; i < 16; ++i) {
    const glm::dvec3 towards = test_shapes::grazing_direction(rng, i % 4 < 3);
    const Camera camera = frame_camera(impostor.bounds, towards, 3);
    compare(warp_surfaces(impostor, camera), draw(*pictures, camera, {}), 1e-2, d);
  }
  EXPECT_GT(d.pixels, 8000);
  // As above; depths reach far along the lawn.
  EXPECT_LT(d.coverage, d.pixels / 100);
  EXPECT_LT(d.depth, d.pixels / 50);
  EXPECT_LT(d.color, d.pixels / 40);
}

TEST_F(LayeredDrawerTest, a_view_that_begins_to_fade_in_changes_nothing_yet) {
  const LayeredImpostor impostor = jug_impostor();
  auto pictures = LayeredPictures::create(impostor);
  ASSERT_TRUE(pictures.ok());
  constexpr double kHandover = 0.5;
  for (const std::array<int, 2>& edge : {impostor.views.edges[3], impostor.views.edges[20]}) {
    // From one view towards the other, until that has a weight of 1e-4 or so.
    double begin = 0, end = 0.5;
    glm::dvec3 towards(0.0);
    std::array<int, 6> views{};
    std::array<float, 6> weights{};
    for (int i = 0; i < 60 && !(weights[1] > 5e-5 && weights[1] < 5e-4); ++i) {
      const double s = 0.5 * (begin + end);
      towards = glm::normalize(
          glm::mix(impostor.views.directions[edge[0]], impostor.views.directions[edge[1]], s));
      nearest_views(impostor.views, towards, views);
      handover_weights(impostor.views, towards, kHandover * mean_spacing(impostor.views), views,
                       weights);
      (weights[1] > 1e-4 ? end : begin) = s;
    }
    ASSERT_GT(weights[1], 5e-5);
    ASSERT_LT(weights[1], 5e-4);
    const Camera camera = frame_camera(impostor.bounds, towards, 3);
    const Drawn switched = draw(*pictures, camera, {.handover = 0});
    const Drawn faded = draw(*pictures, camera, {.handover = kHandover});
    EXPECT_EQ(faded.object, switched.object);
    int covered = 0, differ = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        for (int k = 0; k < 3; ++k) {
          covered += switched.object(x, y) != kNoObject;
          // A weight of 5e-4 moves a byte by an eighth, and then it is rounded.
          differ += std::abs(int(faded.color(x, y)[k]) - int(switched.color(x, y)[k])) > 1;
        }
    EXPECT_GT(covered, 3000);
    EXPECT_EQ(differ, 0);
  }
}

TEST_F(LayeredDrawerTest, slices_are_what_the_slow_drawing_on_the_cpu_shows) {
  LayeredImpostor impostor = jug_impostor();
  find_fill_slices(impostor, {.size = 48});
  auto pictures = LayeredPictures::create(impostor);
  ASSERT_TRUE(pictures.ok()) << pictures.error().message();
  std::mt19937 rng(2);
  Difference d;
  for (int i = 0; i < 8; ++i) {
    const Camera camera = frame_camera(impostor.bounds, random_direction(rng), 2.5 + 0.3 * i);
    const bool fill = i % 2 == 0;
    const auto draws = slices_for_eye(impostor, camera.position(), fill);
    const LayeredOptions gpu{
        .method = LayeredMethod::slices, .max_views = fill ? 6 : 1, .handover = 0};
    const Drawn drawn = draw(*pictures, camera, gpu);
    EXPECT_EQ(drawer_->stats().slices, draws.size());
    compare(warp_slices(impostor, draws, camera), drawn, 1e-3, d);
  }
  EXPECT_GT(d.pixels, 10000);
  // A texel's edge may fall on the other side of a pixel's centre, and a texel's end on that of a
  // slice, of which 16 bits are known.
  EXPECT_LT(d.coverage, d.pixels / 200);
  EXPECT_LT(d.depth, d.pixels / 100);
  EXPECT_LT(d.object, d.pixels / 100);
  EXPECT_LT(d.color, d.pixels / 100);
}

// A room's corner, photographed from within: large pictures of surfaces that recede.
LayeredImpostor corner_impostor() {
  Scene scene;
  const glm::mat4 one(1);
  test_shapes::add(scene, test_shapes::box({2, 0.05f, 2}), {0.7f, 0.6f, 0.5f},
                   glm::translate(one, {0, -1, 0}));
  test_shapes::add(scene, test_shapes::box({2, 1, 0.05f}), {0.3f, 0.6f, 0.3f},
                   glm::translate(one, {0, 0, -2}));
  test_shapes::add(scene, test_shapes::box({0.05f, 1, 2}), {0.3f, 0.3f, 0.7f},
                   glm::translate(one, {-2, 0, 0}));
  test_shapes::add(scene, test_shapes::sphere(0.4), {0.8f, 0.3f, 0.2f},
                   glm::translate(one, {-0.5f, -0.5f, -0.8f}));
  finish(scene);
  const Result<RayScene> rays = RayScene::create(scene);
  std::vector<DepthImage> pictures;
  for (int i = 0; i < 3; ++i) {
    const double a = 0.3 * (i - 1);
    pictures.push_back(cast_picture(
        *rays, look_at({1.5 + a, 0.3, 1.5 - a}, {-1, -0.6, -1}, {0, 1, 0}, 0.9, 192, 160, 0.1, 9)));
  }
  // Its far side lost a stripe, as where a sensor measures nothing.
  for (DepthImage& picture : pictures)
    for (int y = 40; y < 90; ++y)
      for (int x = 90; x < 96; ++x) picture.depth(x, y) = kNoDepth;
  Result<LayeredImpostor> impostor = make_layered_impostor(std::move(pictures), {.layers = 64});
  return std::move(*impostor);
}

TEST_F(LayeredDrawerTest, a_room_seen_from_within_and_from_behind_is_drawn_as_on_the_cpu) {
  const LayeredImpostor impostor = corner_impostor();
  auto pictures = LayeredPictures::create(impostor);
  ASSERT_TRUE(pictures.ok()) << pictures.error().message();
  Difference surfaces, slices;
  for (int i = 0; i < 4; ++i) {
    const Camera camera =
        i < 3 ? look_at({1.4 - 0.5 * i, 0.2, 1.2}, {-1, -0.6, -1}, {0, 1, 0}, 0.9, kSize, kSize,
                        0.05, 20)
              : look_at({-5, 3, -4}, {0, 0, 0}, {0, 1, 0}, 0.6, kSize, kSize, 0.5, 20);
    compare(warp_surfaces(impostor, camera, {.handover = 0.25}), draw(*pictures, camera, {}), 5e-3,
            surfaces);
    const LayeredOptions by_slices{.method = LayeredMethod::slices, .handover = 0};
    const auto draws = slices_for_eye(impostor, camera.position(), true);
    compare(warp_slices(impostor, draws, camera), draw(*pictures, camera, by_slices), 5e-3, slices);
    EXPECT_EQ(drawer_->stats().slices, draws.size());
    // Part of the slices' rectangles is empty, and not drawn.
    double whole = 0;
    for (const SliceDraw& d : draws) whole += double(d.rect.area());
    EXPECT_LT(drawer_->stats().texels, 0.8 * whole);
    EXPECT_GT(drawer_->stats().quads, draws.size());
  }
  EXPECT_GT(surfaces.pixels, 10000);
  EXPECT_GT(slices.pixels, 10000);
  // As above.
  for (const Difference& d : {surfaces, slices}) {
    EXPECT_LT(d.coverage, d.pixels / 100);
    EXPECT_LT(d.depth, d.pixels / 50);
    EXPECT_LT(d.color, d.pixels / 40);
  }
}

TEST_F(LayeredDrawerTest, an_impostor_that_moved_is_an_eye_that_moved_the_other_way) {
  const LayeredImpostor impostor = jug_impostor();
  auto pictures = LayeredPictures::create(impostor);
  ASSERT_TRUE(pictures.ok());
  glm::dmat4 motion = glm::translate(glm::dmat4(1), glm::dvec3(30, -7, 12));
  motion = glm::rotate(motion, 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  for (LayeredMethod method : {LayeredMethod::surfaces, LayeredMethod::slices}) {
    const Camera camera = frame_camera(impostor.bounds, glm::normalize(glm::dvec3(1, 0.7, 0.4)), 3);
    Camera moved = camera;
    moved.world_from_eye = motion * camera.world_from_eye;
    const Drawn still = draw(*pictures, camera, {.method = method});
    const Drawn other = draw(*pictures, moved, {.method = method}, false, {motion, 7});
    int differ = 0, covered = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        covered += still.object(x, y) != kNoObject;
        differ += (still.object(x, y) != kNoObject) != (other.object(x, y) != kNoObject) ||
                  std::abs(int(still.color(x, y).g) - int(other.color(x, y).g)) > 3;
      }
    EXPECT_GT(covered, 1000);
    EXPECT_LT(differ, covered / 100);  // other floats, other edges
  }
}

TEST_F(LayeredDrawerTest, outlines_are_the_edges_of_the_box_before_what_it_shows) {
  const LayeredImpostor impostor = jug_impostor();
  auto pictures = LayeredPictures::create(impostor);
  ASSERT_TRUE(pictures.ok());
  const Camera camera = frame_camera(impostor.bounds, glm::normalize(glm::dvec3(1, 0.7, 0.4)), 4);
  for (const LayeredMethod method : {LayeredMethod::surfaces, LayeredMethod::slices}) {
    const Drawn plain = draw(*pictures, camera, {.method = method});
    const Drawn outlined = draw(*pictures, camera, {.method = method}, true);
    EXPECT_TRUE(std::ranges::equal(outlined.object.texels(), plain.object.texels()));
    int before = 0, shown = 0, behind = 0, hidden = 0;
    for (int edge = 0; edge < 12; ++edge)
      for (int i = 0; i <= 100; ++i) {
        glm::dvec3 share;
        share[edge / 4] = 0.01 * i;
        share[(edge / 4 + 1) % 3] = edge & 1;
        share[(edge / 4 + 2) % 3] = edge >> 1 & 1;
        const glm::dvec3 at = raster_from_world(
            camera, glm::dvec3(impostor.bounds.min) + share * glm::dvec3(impostor.bounds.extent()));
        const int x = int(at.x), y = int(at.y);
        if (x < 1 || y < 1 || x >= kSize - 1 || y >= kSize - 1) continue;
        // A line goes through this pixel, or through one beside it.
        bool changed = false, hides = true;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            changed |= outlined.color(x + dx, y + dy) != plain.color(x + dx, y + dy);
            hides &= double(plain.eye_z(x + dx, y + dy)) < at.z - 0.1;
          }
        if (plain.object(x, y) == kNoObject || at.z < double(plain.eye_z(x, y)) - 0.1)
          ++before, shown += changed;
        else if (hides)
          ++behind, hidden += !changed;
      }
    EXPECT_GT(before, 300);
    EXPECT_EQ(shown, before);
    EXPECT_GT(behind, 50);
    // Other edges cross in front of some.
    EXPECT_GT(hidden, behind / 2);
  }
}

TEST_F(LayeredDrawerTest, the_eye_may_be_within_the_bounds) {
  const LayeredImpostor impostor = jug_impostor();
  auto pictures = LayeredPictures::create(impostor);
  ASSERT_TRUE(pictures.ok());
  // In the corner of the bounds, outside the jug.
  const glm::dvec3 eye = glm::mix(glm::dvec3(impostor.bounds.min), glm::dvec3(impostor.bounds.max),
                                  glm::dvec3(0.97, 0.95, 0.95));
  const Camera camera =
      look_at(eye, impostor.bounds.center(), {0, 1, 0}, 1.2, kSize, kSize, 0.01, 20);
  const Drawn drawn = draw(*pictures, camera, {});
  Difference d;
  compare(warp_surfaces(impostor, camera, {.handover = 0.25}), drawn, 2e-3, d);
  EXPECT_GT(d.pixels, 1000);
  EXPECT_LT(d.coverage, d.pixels / 100);
  EXPECT_LT(d.depth, d.pixels / 50);
}

TEST_F(LayeredDrawerTest, what_stands_in_front_hides_it_and_what_it_hides_stays_hidden) {
  // A wall of slices and a wall of polygons are told apart by depth alone: the same impostor twice,
  // a hair apart, in both orders, gives the same frame.
  const LayeredImpostor impostor = jug_impostor();
  auto pictures = LayeredPictures::create(impostor);
  ASSERT_TRUE(pictures.ok());
  const Camera camera = frame_camera(impostor.bounds, {0, 0, 1}, 3);
  const LayeredInstance near_one{glm::translate(glm::dmat4(1), glm::dvec3(0.3, 0, 0.9)), 2};
  const LayeredInstance far_one{glm::dmat4(1), 3};
  for (LayeredMethod method : {LayeredMethod::surfaces, LayeredMethod::slices}) {
    Image<std::uint32_t> frames[2];
    for (int order = 0; order < 2; ++order) {
      const LayeredInstance both[] = {order ? near_one : far_one, order ? far_one : near_one};
      target_->begin();
      drawer_->draw(*pictures, camera, both, {.method = method});
      target_->resolve();
      const Rgba8Image color = target_->read();
      frames[order] = Image<std::uint32_t>(kSize, kSize);
      for (std::size_t i = 0; i < color.texels().size(); ++i)
        frames[order].texels()[i] = std::uint32_t(color.texels()[i].r) << 16 |
                                    std::uint32_t(color.texels()[i].g) << 8 | color.texels()[i].b;
    }
    EXPECT_EQ(frames[0], frames[1]);
  }
}

TEST_F(LayeredDrawerTest, an_instance_without_an_identifier_has_that_of_the_only_object) {
  LayeredImpostor impostor = test_shapes::jug_impostor(32);
  for (DepthImage& picture : impostor.pictures)
    for (std::uint32_t& object : picture.object.texels())
      if (object != kNoObject) object = 7;
  const Camera camera = frame_camera(impostor.bounds, {0, 0, 1}, 2.5);
  for (const LayeredMethod method : {LayeredMethod::surfaces, LayeredMethod::slices}) {
    auto drawable = make_layered_drawable(impostor, *drawer_, {.method = method});
    ASSERT_TRUE(drawable.ok()) << drawable.error().message();
    for (const std::uint32_t named : {kNoObject, 3u}) {
      const Instance instance{glm::dmat4(1.0), 0, named};
      probe_->begin();
      (*drawable)->draw(camera, {&instance, 1}, Output::object_id);
      const Image<std::uint32_t> objects = probe_->read_objects();
      int shown = 0;
      for (const std::uint32_t object : objects.texels()) {
        if (object == kNoObject) continue;
        ++shown;
        EXPECT_EQ(object, named == kNoObject ? 7u : named);
      }
      EXPECT_GT(shown, 1000);
    }
  }
}

}  // namespace
}  // namespace rilievo
