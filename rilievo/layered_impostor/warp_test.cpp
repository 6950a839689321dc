#include "rilievo/layered_impostor/warp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <span>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/layered_impostor/jug_test_helpers.h"
#include "rilievo/layered_impostor/pixel_march.h"

namespace rilievo {
namespace {

using test_shapes::jug_impostor;
using test_shapes::random_direction;

Camera frame_camera(const Box& bounds, const glm::dvec3& direction, double distance, int size) {
  const glm::dvec3 eye =
      glm::dvec3(bounds.center()) + glm::normalize(direction) * (distance * bounds.radius());
  Camera camera = *tight_camera(Projection::perspective, eye, {0, 1, 0}, bounds);
  camera.width = camera.height = size;
  return camera;
}

double share_uncovered_inside(const DepthImage& truth, const DepthImage& frame) {
  double inside = 0, uncovered = 0;
  for (int y = 1; y + 1 < truth.depth.height(); ++y)
    for (int x = 1; x + 1 < truth.depth.width(); ++x) {
      bool all = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) all &= truth.covered(x + dx, y + dy);
      inside += all;
      uncovered += all && !frame.covered(x, y);
    }
  return uncovered / inside;
}

TEST(LayeredWarp, seen_from_its_own_apex_a_picture_is_itself) {
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    const LayeredImpostor impostor = jug_impostor(48, {.layers = 32, .overlap = 0.5f}, kind);
    for (int v : {0, 7, 20}) {
      const DepthImage& picture = impostor.pictures[v];
      Camera camera = picture.camera;
      camera.projection = Projection::perspective;
      std::vector<SliceDraw> draws;
      for (int s = 0; s < int(impostor.slices[v].size()); ++s)
        draws.push_back({v, s, impostor.slices[v][s].rect});
      const DepthImage frame = warp_slices(impostor, draws, camera);
      for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 48; ++x) {
          ASSERT_EQ(frame.covered(x, y), picture.covered(x, y));
          EXPECT_EQ(frame.color(x, y), picture.color(x, y));
        }
    }
  }
}

TEST(LayeredWarp, a_slice_stands_at_most_half_its_thickness_from_its_samples) {
  const LayeredImpostor impostor = jug_impostor(64, {.layers = 24, .overlap = 0, .pieces = false});
  std::mt19937 rng(1);
  for (int i = 0; i < 5; ++i) {
    const Camera camera = frame_camera(impostor.bounds, random_direction(rng), 4, 96);
    const auto draws = slices_for_eye(impostor, camera.position(), false);
    Image<int> drawn;
    const DepthImage frame = warp_slices(impostor, draws, camera, &drawn);
    const int v = draws[0].view;
    const DepthImage& picture = impostor.pictures[v];
    const double thickness = impostor.slices[v][1].eye_z - impostor.slices[v][0].eye_z;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        if (drawn(x, y) < 0) continue;
        const glm::dvec3 at = raster_from_world(
            picture.camera, world_from_raster(camera, {x + 0.5, y + 0.5}, frame.depth(x, y)));
        const Slice& slice = impostor.slices[v][draws[drawn(x, y)].slice];
        // 1e-5: eye_z of the frame is a float of size 8.
        EXPECT_NEAR(at.z, slice.eye_z, 1e-5);
        const glm::ivec2 texel{int(std::floor(at.x)), int(std::floor(at.y))};
        if (std::abs(at.x - std::round(at.x)) < 1e-4 || std::abs(at.y - std::round(at.y)) < 1e-4)
          continue;  // on the border of two texels
        EXPECT_LE(std::abs(at.z - picture.depth(texel.x, texel.y)), 0.5 * thickness + 1e-5);
      }
  }
}

TEST(LayeredWarp, surfaces_lie_where_the_object_lies) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  const LayeredImpostor impostor = jug_impostor(128);
  std::mt19937 rng(2);
  double worst_share = 0;
  for (int i = 0; i < 12; ++i) {
    const Camera camera = frame_camera(impostor.bounds, random_direction(rng), 4, 96);
    const DepthImage truth = cast_picture(*rays, camera), frame = warp_surfaces(impostor, camera);
    int both = 0, off = 0;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        if (!truth.covered(x, y) || !frame.covered(x, y)) continue;
        ++both;
        // A texel is 3.5 / 128 wide; across it a surface is met within its width, but for outlines,
        // where one texel more or less is a different surface.
        off += std::abs(truth.depth(x, y) - frame.depth(x, y)) > 3.5 / 128;
      }
    EXPECT_GT(both, 1500);
    worst_share = std::max(worst_share, double(off) / both);
    EXPECT_LT(share_uncovered_inside(truth, frame), 0.002);
  }
  EXPECT_LT(worst_share, 0.04);
}

// Of two neighbours one sees the jug and one, which sees everything there, does not.
TEST(LayeredWarp, the_weighted_majority_of_views_decides_where_the_outline_is) {
  std::vector<DepthImage> pictures = test_shapes::cast_views(
      test_shapes::jug(), make_view_set({.spread = ViewSpread::faces_12}), {.size = 64});
  const int blind = 0;
  pictures[blind].depth = Image<float>(64, 64, kNoDepth);
  pictures[blind].color = ColorImage(64, 64);
  const Result<LayeredImpostor> impostor = make_layered_impostor(pictures, {.layers = 16});
  ASSERT_TRUE(impostor);
  const ViewSet& views = impostor->views;
  std::array<int, 2> pair;
  ASSERT_EQ(nearest_views(views, views.directions[blind], pair), 2);
  ASSERT_EQ(pair[0], blind);
  const glm::dvec3 from = views.directions[blind], to = views.directions[std::size_t(pair[1])];
  const double zone = kHandover * mean_spacing(views);
  int shared = 0, decided_by_seeing = 0;
  for (int i = 0; i <= 80; ++i) {
    const glm::dvec3 towards = glm::normalize(glm::mix(from, to, 0.4 + 0.2 * i / 80));
    std::array<float, 2> weights;
    nearest_views(views, towards, pair);
    handover_weights(views, towards, zone, pair, weights);
    const bool first_is_blind = pair[0] == blind;
    const float blind_weight = weights[first_is_blind ? 0 : 1],
                seeing_weight = weights[first_is_blind ? 1 : 0];
    const Camera camera = frame_camera(impostor->bounds, towards, 4, 48);
    const DepthImage frame = warp_surfaces(*impostor, camera, {.max_views = 2});
    // What the seeing view has there, and what it is certain of: its own neighbourhood is.
    DepthImage alone;
    if (!first_is_blind) alone = warp_surfaces(*impostor, camera, {.max_views = 1});
    shared += blind_weight > 0 && seeing_weight > 0;
    int covered = 0, of_seeing = 0;
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 48; ++x) {
        covered += frame.covered(x, y);
        if (first_is_blind) continue;
        of_seeing += alone.covered(x, y);
        EXPECT_LE(frame.covered(x, y), alone.covered(x, y));
      }
    if (blind_weight > seeing_weight) {
      EXPECT_EQ(covered, 0) << i;
    } else if (seeing_weight > blind_weight) {
      ++decided_by_seeing;
      // Behind its edges the seeing view is not certain: there the blind one has the word.
      EXPECT_GT(covered, 0.9 * of_seeing) << i;
      EXPECT_GT(of_seeing, 300);
    }
  }
  EXPECT_GT(shared, 10);
  EXPECT_GT(decided_by_seeing, 20);
}

// A sample's ray is looked at beside its neighbours' depths alone, without OpenGL.
TEST(LayeredWarp, a_part_of_a_ray_asks_pictures_in_the_order_of_the_whole_one) {
  std::mt19937 rng(31);
  std::uniform_real_distribution<double> unit(0, 1);
  int met = 0;
  for (int i = 0; i < 500; ++i) {
    Box box;
    box.min = glm::vec3(-random_direction(rng)), box.max = box.min + glm::vec3(1.5f);
    const glm::dvec3 low(box.min), high(box.max);
    // From within, too.
    PixelRay ray{(i % 3 ? 3.0 : 0.5) * random_direction(rng), {}, 0.01, 100};
    ray.direction = (0.5 + unit(rng)) * (glm::mix(low, high, unit(rng)) - ray.origin);
    PixelRay part = ray;
    const RayBounds bounds(box);
    if (!bounds.keep(ray)) continue;
    ++met;
    part.begin = glm::mix(ray.begin, ray.end, 0.5 * unit(rng));
    part.end = glm::mix(part.begin, ray.end, 0.2 + 0.5 * unit(rng));
    ASSERT_TRUE(bounds.keep(part));
    EXPECT_LT(part.end - part.begin, 0.8 * (ray.end - ray.begin));
    const Camera picture =
        look_at(4.0 * random_direction(rng), {0, 0, 0}, {0, 1, 0}, 0.8, 8, 8, 1, 9);
    EXPECT_EQ(looks_along(picture, part), looks_along(picture, ray));
    // The middle of the points that lie within, in front of the eye.
    double first = 1e9, last = 0;
    const double step = 1e-3 * ray.end;
    for (double t = 0; t < 1.1 * ray.end; t += step) {
      const glm::dvec3 at = ray.origin + t * ray.direction;
      if (!glm::all(glm::greaterThan(at, low)) || !glm::all(glm::lessThan(at, high))) continue;
      first = std::min(first, t), last = t;
    }
    // But for a step at either end, and room for rounding.
    if (first < last) {
      EXPECT_NEAR(ray.middle, 0.5 * (first + last), 2 * step);
    }
  }
  EXPECT_GT(met, 300);
}

// The eye_z of a ray's point at t of its segment over a picture.
double depth_at(const LayeredImpostor& impostor, int view, const PixelRay& ray, double t) {
  const Camera& picture = impostor.pictures[std::size_t(view)].camera;
  const DisparitySegment over = *disparity_segment(picture, ray.origin + ray.begin * ray.direction,
                                                   ray.origin + ray.end * ray.direction);
  const glm::dvec3 at = glm::mix(over.from, over.to, t);
  const glm::dvec3 world = world_from_raster(picture, glm::dvec2(at), 1 / at.z);
  return glm::distance(world, ray.origin) / glm::length(ray.direction);
}

// Eyes beside the jug, whose nearest picture knows nothing. Each picture has a colour of its own,
// which tells which one a pixel was taken from.
TEST(LayeredWarp, where_the_eyes_view_knows_nothing_the_one_along_the_ray_is_asked_first) {
  std::mt19937 rng(12);
  int by_ray = 0, by_order_of_eye = 0;
  for (int i = 0; i < sanitized_cases(8); ++i) {
    std::vector<DepthImage> pictures =
        test_shapes::cast_views(test_shapes::jug(), make_view_set({}), {.size = 48});
    const auto color_of = [](int view) { return glm::vec4(glm::vec3((view + 1) / 40.0f), 1.0f); };
    for (int v = 0; v < int(pictures.size()); ++v)
      std::fill(pictures[std::size_t(v)].color.texels().begin(),
                pictures[std::size_t(v)].color.texels().end(), color_of(v));
    const ViewSet set = make_view_set({});
    const glm::dvec3 direction = random_direction(rng);
    std::array<int, kMaxViewsAsked + kSpareViews> near;
    ASSERT_EQ(nearest_views(set, direction, near), int(near.size()));
    // Colours without depth are holes.
    pictures[std::size_t(near[0])].depth = Image<float>(48, 48, kNoDepth);
    const Result<LayeredImpostor> impostor = make_layered_impostor(pictures, {.layers = 8});
    ASSERT_TRUE(impostor.ok()) << impostor.error().message();
    Camera camera = frame_camera(impostor->bounds, direction, 1.6, 40);
    // The bounds' centre, from which views are counted, lies beside the origin.
    ASSERT_EQ(nearest_views(impostor->views,
                            camera.position() - glm::dvec3(impostor->bounds.center()), near),
              int(near.size()));
    const DepthImage frame = warp_surfaces(*impostor, camera, {.handover = 0});
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const std::optional<PixelRay> ray = pixel_ray(impostor->bounds, camera, {x + 0.5, y + 0.5});
        if (!ray) continue;
        const glm::dvec3 at = ray->origin + 0.5 * (ray->begin + ray->end) * ray->direction;
        const auto angle = [&](int view) {
          const Camera& of = impostor->pictures[std::size_t(view)].camera;
          const glm::dvec3 to_apex = glm::normalize(of.position() - at);
          return std::acos(
              std::clamp(glm::dot(to_apex, glm::normalize(ray->direction)), -1.0, 1.0));
        };
        // The first one that is certain, or what one says that came out in front again from where
        // another one sees.
        const auto first_certain = [&](std::span<const int> order) {
          int beyond = -2;
          double beyond_from = 1e300, seen_to = 0;
          for (const int view : order) {
            const SurfaceHit hit = march_picture(*impostor, view, *ray);
            const int says = hit.hit ? view : impostor->complete[std::size_t(view)] ? -1 : -2;
            if (!hit.passed_behind && says != -2) return says;
            if (!hit.passed_behind) continue;
            seen_to = std::max(seen_to, depth_at(*impostor, view, *ray, hit.behind_from));
            if (says != -2 && hit.behind_to < 1) {
              const double from = depth_at(*impostor, view, *ray, hit.behind_to);
              if (from < beyond_from) beyond_from = from, beyond = says;
            }
            if (beyond_from <= seen_to) return beyond;
          }
          return -2;
        };
        std::array<int, near.size()> order = near;
        std::stable_sort(order.begin() + 1, order.end(),
                         [&](int a, int b) { return angle(a) < angle(b); });
        const int expected = first_certain(std::span(order).first(kMaxViewsAsked));
        if (expected == -2) continue;
        ++by_ray;
        by_order_of_eye += first_certain(std::span(near).first(kMaxViewsAsked)) != expected;
        ASSERT_EQ(frame.covered(x, y), expected >= 0) << x << " " << y;
        if (expected < 0) continue;
        EXPECT_LT(glm::distance(frame.color(x, y), color_of(expected)), 1e-4f) << expected;
      }
  }
  // The order matters.
  EXPECT_GT(by_order_of_eye, by_ray / 10);
  EXPECT_GT(by_ray, 1000);
}

TEST(LayeredWarp, back_perspective_views_fill_each_others_holes) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  LayeredImpostor impostor = jug_impostor(96, {.layers = 48});
  std::mt19937 rng(3);
  std::vector<Camera> cameras;
  for (int i = 0; i < sanitized_cases(10); ++i)
    cameras.push_back(frame_camera(impostor.bounds, random_direction(rng), 3.5, 80));
  double one = 0, filled = 0, all = 0, surface_one = 0, surface_all = 0;
  std::size_t drawn_fill = 0, drawn_all = 0;
  const auto area = [](const std::vector<SliceDraw>& draws) {
    std::size_t sum = 0;
    for (const SliceDraw& d : draws) sum += d.rect.area();
    return sum;
  };
  for (int pass = 0; pass < 2; ++pass) {
    for (const Camera& camera : cameras) {
      const DepthImage truth = cast_picture(*rays, camera);
      const auto draws = slices_for_eye(impostor, camera.position(), true);
      const double holes = share_uncovered_inside(truth, warp_slices(impostor, draws, camera));
      (pass ? filled : all) += holes;
      (pass ? drawn_fill : drawn_all) += area(draws);
      if (pass) continue;
      const auto alone = slices_for_eye(impostor, camera.position(), false);
      one += share_uncovered_inside(truth, warp_slices(impostor, alone, camera));
      surface_one +=
          share_uncovered_inside(truth, warp_surfaces(impostor, camera, {.max_views = 1}));
      surface_all += share_uncovered_inside(truth, warp_surfaces(impostor, camera));
    }
    find_fill_slices(impostor);
  }
  EXPECT_GT(one, 0.0);
  // The chosen slices close nearly all the holes that all three stacks together close, at less
  // than half of what the two other stacks cost.
  EXPECT_LT(all, 0.2 * one);
  EXPECT_LT(filled, 0.3 * one);
  EXPECT_LT(drawn_fill, drawn_all * 2 / 3);
  EXPECT_LT(surface_all, 0.2 * surface_one);
}

TEST(LayeredWarp, overlap_and_pieces_close_tears) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  std::vector<DepthImage> pictures =
      test_shapes::cast_views(scene, make_view_set({}), {.size = 96});
  const auto tears = [&](const SliceOptions& options) {
    const Result<LayeredImpostor> impostor = make_layered_impostor(pictures, options);
    double sum = 0;
    for (int i = 0; i < 6; ++i) {
      const glm::dvec3 direction =
          impostor->views.directions[i] + 0.3 * impostor->views.directions[(i + 5) % 12];
      const Camera camera = frame_camera(impostor->bounds, direction, 4, 96);
      const DepthImage truth = cast_picture(*rays, camera);
      sum += share_uncovered_inside(
          truth,
          warp_slices(*impostor, slices_for_eye(*impostor, camera.position(), false), camera));
    }
    return sum;
  };
  const double disjoint = tears({.layers = 32, .overlap = 0, .pieces = false});
  const double overlapping = tears({.layers = 32, .overlap = 1, .pieces = false});
  const double pieces = tears({.layers = 32, .overlap = 0, .pieces = true});
  // Figure 4: tears are what disjoint intervals leave and overlapping ones do not.
  EXPECT_LT(overlapping, 0.5 * disjoint);
  EXPECT_LT(pieces, 0.5 * disjoint);
}

}  // namespace
}  // namespace rilievo
