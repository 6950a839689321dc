#include "rilievo/warp/texel_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "rilievo/capture/shapes_test_helpers.h"

namespace rilievo {
namespace {

using test_shapes::random_direction;

DepthImage jug_picture(Projection projection, const glm::dvec3& direction, int size) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  return cast_picture(*rays, *view_camera(world_bounds(scene), direction,
                                          {.projection = projection, .size = size}));
}

// The walk by definition: every texel of the picture is asked for the stretch of the segment over
// it, the stretches are sorted, and the side is looked up on either end of each.
SurfaceHit slow_intersect(const TexelSurface& surface, const DisparitySegment& segment) {
  struct Stretch {
    double begin, end;
    glm::ivec2 texel;
  };
  std::vector<Stretch> stretches;
  for (int y = 0; y < surface.texels.height(); ++y)
    for (int x = 0; x < surface.texels.width(); ++x) {
      double begin = 0, end = 1;
      for (int a = 0; a < 2; ++a) {
        const double lo = (a ? y : x) - segment.from[a], hi = lo + 1;
        const double step = segment.to[a] - segment.from[a];
        begin = std::max(begin, std::min(lo / step, hi / step));
        end = std::min(end, std::max(lo / step, hi / step));
      }
      if (begin < end) stretches.push_back({begin, end, {x, y}});
    }
  std::sort(stretches.begin(), stretches.end(),
            [](const Stretch& a, const Stretch& b) { return a.begin < b.begin; });
  const auto in_front = [&](const glm::ivec2& texel, double t) {
    const SurfaceTexel& piece = surface.texels(texel.x, texel.y);
    const glm::dvec3 p = glm::mix(segment.from, segment.to, t);
    const double beyond = p.z - surface_q(piece, glm::dvec2(texel) + 0.5, glm::dvec2(p));
    return piece.q == 0 || (surface.camera.keeps_farthest() ? beyond < 0 : beyond > 0);
  };
  SurfaceHit march;
  bool before = true, behind = false;
  glm::ivec2 last{-1};
  for (const Stretch& s : stretches) {
    const bool enters = in_front(s.texel, s.begin), leaves = in_front(s.texel, s.end);
    if (before && !enters) {
      bool linked = false;
      if (last.x >= 0)
        for (int k = 0; k < 8; ++k)
          linked |=
              kLinkSteps[k] == s.texel - last && surface.texels(last.x, last.y).links >> k & 1;
      if (linked) {
        const glm::dvec2 at(glm::mix(segment.from, segment.to, s.begin));
        const auto q_of = [&](const glm::ivec2& texel) {
          return surface_q(surface.texels(texel.x, texel.y), glm::dvec2(texel) + 0.5, at);
        };
        linked = std::abs(q_of(s.texel) - q_of(last)) <= patch_gap(surface, last);
      }
      if (linked) {
        march.hit = true, march.t = s.begin, march.texel = s.texel;
        return march;
      }
      if (!march.passed_behind) march.behind_from = s.begin;
      march.passed_behind = true;
      march.passed_outline =
          march.passed_outline || last.x < 0 || surface.texels(last.x, last.y).q == 0;
      march.t = s.begin, march.texel = last;
      behind = true;
    }
    if (behind && (enters || leaves)) march.behind_to = enters ? s.begin : s.end, behind = false;
    if (enters && !leaves) {
      // The first of many steps that is not in front, then bisection.
      double t0 = s.begin, t1 = s.end;
      for (int i = 1; i <= 256; ++i) {
        t1 = glm::mix(s.begin, s.end, i / 256.0);
        if (!in_front(s.texel, t1)) break;
        t0 = t1;
      }
      for (int i = 0; i < 60; ++i) (in_front(s.texel, 0.5 * (t0 + t1)) ? t0 : t1) = 0.5 * (t0 + t1);
      march.hit = true, march.t = t1, march.texel = s.texel;
      return march;
    }
    before = leaves;
    last = s.texel;
  }
  if (behind) march.behind_to = 1;
  return march;
}

TEST(TexelSurface, walk_meets_what_every_texel_asked_in_turn_meets) {
  std::mt19937 rng(1);
  int hits = 0, holes = 0, wrong = 0;
  for (int i = 0; i < 6; ++i) {
    const Projection kind = i % 2 ? Projection::perspective : Projection::back_perspective;
    const DepthImage picture = jug_picture(kind, random_direction(rng), 24);
    const TexelSurface surface = make_texel_surface(picture);
    for (int k = 0; k < 1500; ++k) {
      const glm::dvec3 eye = 6.0 * random_direction(rng), to = 1.2 * random_direction(rng);
      const std::optional<DisparitySegment> segment =
          disparity_segment(picture.camera, eye, eye + 2.0 * (to - eye));
      if (!segment) continue;
      const SurfaceHit march = intersect(surface, *segment);
      const SurfaceHit slow = slow_intersect(surface, *segment);
      hits += slow.hit, holes += slow.passed_behind;
      // 1e-9: rounding of doubles along the segment.
      const bool agree =
          march.hit == slow.hit && march.passed_behind == slow.passed_behind &&
          std::abs(march.behind_from - slow.behind_from) < 1e-9 &&
          std::abs(march.behind_to - slow.behind_to) < 1e-9 &&
          (!march.hit || (march.texel == slow.texel && std::abs(march.t - slow.t) < 1e-9));
      wrong += !agree;
    }
  }
  EXPECT_GT(hits, 1500);
  EXPECT_GT(holes, 500);
  // A segment through a texel's very corner may be told either way.
  EXPECT_LE(wrong, 1);
}

TEST(TexelSurface, the_pictures_own_rays_get_its_samples_back) {
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    const DepthImage picture = jug_picture(kind, {0.3, 0.4, 0.8}, 48);
    const TexelSurface surface = make_texel_surface(picture);
    int covered = 0;
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 48; ++x) {
        const CameraRay ray = camera_ray(picture.camera, {x + 0.5, y + 0.5});
        const std::optional<DisparitySegment> segment =
            disparity_segment(picture.camera, ray.origin, ray.origin + ray.direction);
        ASSERT_TRUE(segment);
        const SurfaceHit march = intersect(surface, *segment);
        EXPECT_EQ(march.hit, picture.covered(x, y));
        EXPECT_FALSE(march.passed_behind);
        if (!march.hit) continue;
        ++covered;
        // Float depths of size 3 carry 2e-7.
        EXPECT_NEAR(1 / march.at.z, picture.depth(x, y), 1e-6);
      }
    EXPECT_GT(covered, 500);
  }
}

TEST(TexelSurface, a_plane_is_met_where_it_is) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 100; ++i) {
    Camera camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.8, 32, 32, 1, 20);
    if (i % 2) camera.projection = Projection::back_perspective;
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0.8 * u(rng), 0.8 * u(rng), 1));
    DepthImage picture;
    picture.camera = camera;
    picture.color = ColorImage(32, 32);
    picture.depth = Image<float>(32, 32, kNoDepth);
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const glm::dvec3 d = world_from_raster(camera, {x + 0.5, y + 0.5}, 1) - camera.position();
        const double eye_z = -glm::dot(normal, camera.position()) / glm::dot(normal, d);
        if (eye_z > 1 && eye_z < 20) picture.depth(x, y) = float(eye_z);
      }
    const TexelSurface surface = make_texel_surface(picture);
    for (int k = 0; k < 50; ++k) {
      // From the side that the picture looks from, or for the other kind of picture from beyond.
      const glm::dvec3 eye{3 * u(rng), 3 * u(rng), i % 2 ? -9 : 7};
      const glm::dvec3 to{0.8 * u(rng), 0.8 * u(rng), 0};
      const glm::dvec3 end = eye + 2.0 * (to - eye);
      const std::optional<DisparitySegment> segment = disparity_segment(camera, eye, end);
      if (!segment) continue;
      const SurfaceHit march = intersect(surface, *segment);
      if (!march.hit) continue;
      const glm::dvec3 met = world_from_raster(camera, glm::dvec2(march.at), 1 / march.at.z);
      // Slopes are differences of floats of size 0.2: 1e-7 in q is 3e-6 at a distance of 5.
      EXPECT_NEAR(glm::dot(normal, met), 0, 1e-5);
    }
  }
}

TEST(TexelSurface, segments_are_clipped_to_the_frustum_and_stay_on_their_line) {
  std::mt19937 rng(3);
  const Camera camera = look_at({1, 2, 6}, {0, 0, 0}, {0, 1, 0}, 0.7, 40, 30, 2, 11);
  int inside = 0;
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 a = 8.0 * random_direction(rng), b = 8.0 * random_direction(rng);
    const std::optional<DisparitySegment> segment = disparity_segment(camera, a, b);
    int seen = 0;
    for (int k = 0; k <= 200; ++k) {
      const glm::dvec3 r = raster_from_world(camera, glm::mix(a, b, k / 200.0));
      const bool in_frustum =
          r.z >= 2 && r.z <= 11 && r.x >= 0 && r.x <= 40 && r.y >= 0 && r.y <= 30;
      seen += in_frustum;
    }
    if (!segment) {
      EXPECT_LE(seen, 1);
      continue;
    }
    ++inside;
    for (const glm::dvec3& end : {segment->from, segment->to}) {
      const glm::dvec3 p = world_from_raster(camera, glm::dvec2(end), 1 / end.z);
      const double off = glm::length(glm::cross(p - a, glm::normalize(b - a)));
      EXPECT_LT(off, 1e-9);  // rounding of doubles of size 8
      EXPECT_GE(1 / end.z, 2 - 1e-9);
      EXPECT_LE(1 / end.z, 11 + 1e-9);
      EXPECT_GE(std::min(end.x, end.y), -1e-6);
    }
  }
  EXPECT_GT(inside, 300);
}

TEST(TexelSurface, depth_interval_holds_the_piece) {
  std::mt19937 rng(4);
  std::uniform_real_distribution<float> u(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    SurfaceTexel texel;
    texel.q = 0.5f;
    for (float& s : texel.slope) s = 0.1f * u(rng);
    const DepthInterval interval = depth_interval(texel);
    float lowest = 1e9f, highest = 0;
    for (int y = 0; y <= 10; ++y)
      for (int x = 0; x <= 10; ++x) {
        const float d = float(1 / surface_q(texel, {0.5, 0.5}, {x / 10.0, y / 10.0}));
        lowest = std::min(lowest, d), highest = std::max(highest, d);
      }
    // Corners are among the probes, so that both agree but for rounding.
    EXPECT_NEAR(interval.front, lowest, 1e-6);
    EXPECT_NEAR(interval.back, highest, 1e-6);
  }
}

// Whatever steps and ends the surface has: what is interpolated between the samples belongs to a
// place that is not far from the point of the patch.
TEST(TexelSurface, the_place_between_the_samples_lies_at_the_patch) {
  std::mt19937 rng(6);
  std::uniform_real_distribution<double> u(-0.5, 0.5);
  int points = 0, between = 0;
  double farthest = 0, farthest_between = 0;
  for (int i = 0; i < 6; ++i) {
    const DepthImage picture = jug_picture(
        i % 2 ? Projection::perspective : Projection::back_perspective, random_direction(rng), 48);
    const TexelSurface surface = make_texel_surface(picture);
    const Camera& camera = surface.camera;
    const auto& [l, r, b, t] = camera.window;
    const double across = std::hypot((r - l) / camera.width, (t - b) / camera.height);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 48; ++x) {
        const SurfaceTexel& texel = surface.texels(x, y);
        if (texel.q == 0) continue;
        const auto sample = [&](int dx, int dy) {
          return world_from_raster(camera, {x + dx + 0.5, y + dy + 0.5},
                                   1 / double(surface.texels(x + dx, y + dy).q));
        };
        const glm::dvec2 offset(u(rng), u(rng)), center(x + 0.5, y + 0.5);
        const SampleWeights w = sample_weights(texel, offset);
        EXPECT_NEAR(w.own + w.u + w.v + w.uv, 1, 1e-6);
        EXPECT_GE(std::min({w.own, w.u, w.v, w.uv}), 0);
        glm::dvec3 place = double(w.own) * sample(0, 0);
        if (w.u > 0) place += double(w.u) * sample(w.side.x, 0);
        if (w.v > 0) place += double(w.v) * sample(0, w.side.y);
        if (w.uv > 0) place += double(w.uv) * sample(w.side.x, w.side.y);
        const double q = surface_q(texel, center, center + offset);
        const double off = glm::distance(place, world_from_raster(camera, center + offset, 1 / q)) *
                           double(texel.q) / across;
        ++points;
        farthest = std::max(farthest, off);
        if (!(w.u + w.uv > 0 && w.v + w.uv > 0)) continue;
        ++between;
        farthest_between = std::max(farthest_between, off);
      }
  }
  EXPECT_GT(points, 3500);
  EXPECT_GT(between, 3000);
  // In diagonals of a texel. Beside an end: half of one across, and as deep as half a texel is wide
  // and high, twice; along lines of sight that are stretched in the corners of a picture.
  EXPECT_LT(farthest, 1.2 * std::hypot(0.5, 2 * 0.5 * std::sqrt(2.0)));
  EXPECT_GT(farthest, 0.5);
  // Between samples: a quarter of the twist that is allowed, and what perspective bends in steps
  // as steep as 20.
  EXPECT_LT(farthest_between, 0.125 + 0.25);
}

}  // namespace
}  // namespace rilievo
