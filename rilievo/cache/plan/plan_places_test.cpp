// Is everything that a capture saw drawn where it belongs? A property of whole plans, point by
// point, without OpenGL: boxes stand for objects, and points all over their sides for what is seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>
#include <random>
#include <vector>

#include "rilievo/cache/plan/eye_motion.h"
#include "rilievo/cache/plan/plan_test_helpers.h"
#include "rilievo/core/depth.h"
#include "rilievo/core/sanitized_test_helpers.h"

namespace rilievo {
namespace {

constexpr int kPointsOfSide = 9;

// A box in its own space, and where it goes.
struct Body {
  Box box;
  std::uint64_t triangles = 0;
  glm::dmat4 start{1.0};
  glm::dvec3 step{0.0};  // a frame
  double turn = 0;       // a frame, radians about the vertical; both 0: it stands
  std::vector<glm::dvec3> points;

  [[nodiscard]] bool moves() const { return step != glm::dvec3(0) || turn != 0; }
  [[nodiscard]] glm::dmat4 pose(int frame) const {
    return glm::rotate(glm::translate(glm::dmat4(1), step * double(frame)) * start, turn * frame,
                       {0, 1, 0});
  }
};

// The still bodies first.
struct World {
  std::vector<Body> bodies;
  std::size_t still = 0;
  Hierarchy tree;
};

World random_world(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(0, 1);
  World world;
  const int still = 10 + int(rng() % 30), moving = int(rng() % 4);
  // At times a row, at times a field.
  const float width = rng() % 2 ? 4.0f : 60.0f;
  PlanObjects standing;
  for (int i = 0; i < still + moving; ++i) {
    Body body;
    const glm::vec3 half(0.3f + 2 * u(rng), 0.3f + 3 * u(rng), 0.3f + 2 * u(rng));
    const glm::vec3 at((u(rng) - 0.5f) * width, half.y, -80 * u(rng));
    if (i < still) {
      body.box = {at - half, at + half};
    } else {
      body.box = {-half, half};
      body.start = glm::translate(glm::dmat4(1), glm::dvec3(at));
      body.step = {0.1 * u(rng), 0, 0.1 * u(rng)};
      body.turn = 0.01 * u(rng);
    }
    body.triangles = 500 + rng() % 20'000;
    for (int side = 0; side < 6; ++side)
      for (int k = 0; k < kPointsOfSide; ++k) {
        glm::vec3 share(u(rng), u(rng), u(rng));
        share[side / 2] = float(side % 2);
        body.points.emplace_back(body.box.min + share * body.box.extent());
      }
    if (i < still) standing.add(body.box, body.triangles);
    world.bodies.push_back(body);
  }
  world.still = std::size_t(still);
  standing.build();
  world.tree = std::move(standing.tree);
  return world;
}

std::vector<MovingObject> moving_in(const World& world, int frame) {
  std::vector<MovingObject> moving;
  for (std::size_t i = world.still; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    MovingObject object;
    object.world_from_object = body.pose(frame);
    object.now_from_last = body.pose(frame) * glm::inverse(body.pose(frame - 1));
    object.box = transformed(glm::mat4(object.world_from_object), body.box);
    object.triangles = body.triangles;
    moving.push_back(object);
  }
  return moving;
}

// Steps to the side, some faster and some slower, and cuts to another place now and then.
class Walker {
 public:
  explicit Walker(std::mt19937& rng) : rng_(rng) {}

  Camera next() {
    std::uniform_real_distribution<double> u(0, 1);
    if (left_-- <= 0) {
      left_ = 8 + int(rng_() % 20);
      eye_ = {80 * (u(rng_) - 0.5), 1 + 5 * u(rng_), -100 * u(rng_) + 20};
      target_ = {20 * (u(rng_) - 0.5), 1, -80 * u(rng_)};
      fov_ = 0.4 + 0.8 * u(rng_);
      const glm::dvec3 aside = glm::normalize(glm::cross(target_ - eye_, glm::dvec3(0, 1, 0)));
      const bool stands = rng_() % 4 == 0;
      step_ = stands ? glm::dvec3(0) : aside * (1.6 * u(rng_) * u(rng_) * (rng_() % 2 ? 1 : -1));
    }
    eye_ += step_, target_ += step_;
    return look_at(eye_, target_, {0, 1, 0}, fov_, 640, 360, 0.5, 500);
  }

 private:
  std::mt19937& rng_;
  int left_ = 0;
  double fov_ = 1;
  glm::dvec3 eye_{0.0}, target_{0.0}, step_{0.0};
};

// Does the segment from `eye` to `point` pass through the box before it ends?
bool hides(const Box& box, const glm::dvec3& eye, const glm::dvec3& point) {
  const glm::dvec3 way = point - eye;
  const glm::dvec3 low = (glm::dvec3(box.min) - eye) / way;
  const glm::dvec3 high = (glm::dvec3(box.max) - eye) / way;
  const glm::dvec3 in = glm::min(low, high), out = glm::max(low, high);
  const double enter = std::max({in.x, in.y, in.z, 0.0}), leave = std::min({out.x, out.y, out.z});
  return enter < leave && enter < 1 - 1e-6;  // not by the side on which it lies
}

// Points of the world at the time of a capture.
using Seen = std::vector<glm::dvec3>;

std::vector<std::size_t> bodies_of(const World& world, Entity e) {
  if (e >= world.tree.nodes.size()) return {world.still + (e - world.tree.nodes.size())};
  const HierarchyNode& node = world.tree.nodes[e];
  const auto begin = world.tree.order.begin() + node.first;
  return {begin, begin + node.count};
}

// What the capture sees of its own objects.
Seen look(const World& world, const Capture& capture, int frame) {
  const glm::dvec3 eye = capture.geometry.capture.position();
  const std::vector<std::size_t> bodies = bodies_of(world, capture.entity);
  Seen seen;
  for (std::size_t i : bodies) {
    const glm::dmat4 pose = world.bodies[i].pose(frame);
    for (const glm::dvec3& point : world.bodies[i].points) {
      const bool hidden = std::any_of(bodies.begin(), bodies.end(), [&](std::size_t other) {
        const glm::dmat4 own = glm::inverse(world.bodies[other].pose(frame));
        return hides(world.bodies[other].box, glm::dvec3(own * glm::dvec4(eye, 1)),
                     glm::dvec3(own * pose * glm::dvec4(point, 1)));
      });
      if (!hidden) seen.emplace_back(pose * glm::dvec4(point, 1));
    }
  }
  return seen;
}

DeltaRange range_of(const Seen& seen, const Camera& camera) {
  DeltaRange range{1, 0};
  for (const glm::dvec3& point : seen) {
    const glm::dvec3 at = raster_from_world(camera, point);
    const double delta = depth_from_eye_z(DepthKind::window_z, at.z, camera, {at.x, at.y});
    range = {std::min(range.nearest, delta), std::max(range.farthest, delta)};
  }
  return range;
}

bool inside(const Camera& frame, const glm::dvec3& raster, double margin) {
  return raster.z >= frame.z_near && raster.x >= -margin && raster.x <= frame.width + margin &&
         raster.y >= -margin && raster.y <= frame.height + margin;
}

struct Totals {
  int points = 0, beside = 0;  // seen ones in view; those drawn beside the frame
  int pictures = 0, several = 0;
};

// Every seen point of a picture that is in view now.
void check_picture(const Picture& picture, const glm::dmat4& motion, const Seen& seen,
                   const Camera& frame, double limit, Totals& totals) {
  const Camera& capture = picture.geometry.capture;
  const auto now = [&](const glm::dvec3& then) {
    return raster_from_world(frame, glm::dvec3(motion * glm::dvec4(then, 1)));
  };
  for (const glm::dvec3& point : seen) {
    const glm::dvec3 truth = now(point);
    if (!inside(frame, truth, 0)) continue;
    const glm::dvec3 texel = raster_from_world(capture, point);
    const glm::dvec3 drawn =
        now(world_from_raster(capture, {texel.x, texel.y}, picture.geometry.plane_z));
    ASSERT_GE(drawn.z, frame.z_near);  // or it is cut off
    // 1e-6: rounding of positions of 100 m in doubles, and the bound that is kept as a float.
    ASSERT_LE(glm::length(glm::dvec2(drawn) - glm::dvec2(truth)), limit + 1e-6);
    ASSERT_TRUE(inside(frame, drawn, limit + 1e-6));
    ++totals.points;
    totals.beside += !inside(frame, drawn, 0);
  }
}

// Each object with a point in view is drawn, at every pixel from one source.
void check_objects(const World& world, const Loop& run, const Camera& frame, int f) {
  std::vector<Shares> still(world.still), moving(world.bodies.size() - world.still);
  ASSERT_NO_FATAL_FAILURE(add_shares(run, world.tree, still, moving));
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    const glm::dmat4 pose = body.pose(f);
    const bool in_view = std::any_of(body.points.begin(), body.points.end(), [&](const auto& p) {
      return inside(frame, raster_from_world(frame, glm::dvec3(pose * glm::dvec4(p, 1))), 0);
    });
    if (in_view) {
      ASSERT_TRUE(complete(i < world.still ? still[i] : moving[i - world.still])) << i;
    }
  }
}

void walk_through(const World& world, const CacheOptions& options, bool narrow, std::mt19937& rng,
                  Totals& totals) {
  Loop run;
  std::vector<Seen> seen;  // by slot
  EyeMotion motion;
  Walker walker(rng);
  for (int f = 0; f < 80; ++f) {
    SCOPED_TRACE(f);
    const FrameView view = follow(motion, walker.next());
    const std::vector<MovingObject> moving = moving_in(world, f);
    run.maker.shows = [&](const Capture& capture) {
      if (seen.size() <= capture.slot) seen.resize(capture.slot + 1);
      Seen& now = seen[capture.slot] = look(world, capture, f);
      MadeCapture made{.made = true};
      if (narrow && !now.empty()) made.range = range_of(now, capture.geometry.capture);
      return made;
    };
    ASSERT_NO_FATAL_FAILURE(run.frame(world.tree, moving, view, options));
    ASSERT_NO_FATAL_FAILURE(check_objects(world, run, view.camera, f));
    for (const DrawnPicture& drawn : run.plan.pictures) {
      const Picture& picture = run.state.slots[drawn.slot];
      glm::dmat4 since(1.0);
      if (picture.entity >= world.tree.nodes.size())
        since = moving[picture.entity - world.tree.nodes.size()].world_from_object *
                glm::inverse(picture.world_from_object);
      ASSERT_NO_FATAL_FAILURE(check_picture(picture, since, seen[drawn.slot], view.camera,
                                            limit_px(picture, options), totals));
      ++totals.pictures;
      totals.several += bodies_of(world, picture.entity).size() > 1;
    }
  }
}

TEST(PlanPlaces, each_point_in_view_that_was_captured_is_drawn_where_it_belongs) {
  for (const bool rasterized : {false, true})
    for (const bool narrow : {false, true}) {
      Totals totals;
      for (std::uint32_t seed = 1; seed <= std::uint32_t(sanitized_cases(20)); ++seed) {
        SCOPED_TRACE(testing::Message() << rasterized << narrow << " seed " << seed);
        std::mt19937 rng(seed);
        CacheOptions options = rasterized ? rasterized_cache_options() : CacheOptions{};
        options.error_px = std::array{0.5, 1.0, 2.0}[seed % 3];
        const World world = random_world(rng);
        ASSERT_NO_FATAL_FAILURE(walk_through(world, options, narrow, rng, totals));
      }
      EXPECT_GT(totals.points, sanitized_cases(100'000));
      EXPECT_GT(totals.pictures, sanitized_cases(1000));
      EXPECT_GT(totals.several, sanitized_cases(100));
      EXPECT_GT(totals.beside, 0);  // the frame's border runs through some
    }
}

}  // namespace
}  // namespace rilievo
