#include "rilievo/capture/shaders/posed_tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rilievo/capture/shaders/ray_tracer.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/relief_impostor/impostor_motion.h"

namespace rilievo {
namespace {

// An upright strip, whose upper half bends to the right within a second and back.
struct BendingStrip {
  Scene scene;
  Deformations deformations;
};
BendingStrip bending_strip() {
  BendingStrip made;
  Mesh mesh;
  Deformation deformation;
  for (int row = 0; row <= 20; ++row)
    for (int side = 0; side < 2; ++side) {
      const float height = 0.1f * float(row), part = std::clamp(height - 0.5f, 0.0f, 1.0f);
      mesh.positions.push_back({side ? 0.15f : -0.15f, height, 0});
      mesh.normals.push_back({0, 0, 1});
      mesh.colors.push_back({0.2f, 0.1f * float(row % 8), 0.9f, 1});
      deformation.first_influence.push_back(std::uint32_t(deformation.influences.size()));
      if (part < 1) deformation.influences.push_back({0, 1 - part});
      if (part > 0) deformation.influences.push_back({1, part});
    }
  deformation.first_influence.push_back(std::uint32_t(deformation.influences.size()));
  for (std::uint32_t row = 0; row < 20; ++row)
    for (const std::uint32_t corner : {0u, 1u, 3u, 0u, 3u, 2u})
      mesh.indices.push_back(2 * row + corner);
  mesh.material = 0;
  Material material;
  material.double_sided = true;
  deformation.positions = mesh.positions, deformation.normals = mesh.normals;
  // The second joint is one metre above the first.
  glm::mat4 below(1.0f);
  below[3].y = -1;
  deformation.joints = {{0, glm::mat4(1.0f)}, {1, below}};
  Node upper;
  upper.parent = 0, upper.translation = {0, 1, 0};
  made.deformations.rig.nodes = {Node{}, upper};
  Channel turn;
  turn.node = 1, turn.path = Channel::Path::rotation;
  turn.times = {0, 1, 2};
  const float half = 0.45f;
  turn.values = {{0, 0, 0, 1}, {0, 0, -std::sin(half), std::cos(half)}, {0, 0, 0, 1}};
  made.deformations.rig.channels = {turn};
  made.deformations.rig.duration = 2;
  made.deformations.meshes = {deformation};
  made.scene.name = "strip";
  made.scene.materials = {material};
  made.scene.meshes = {mesh};
  Model model;
  model.parts = {{0, glm::mat4(1.0f)}};
  made.scene.models = {model};
  Object object;
  object.placement = glm::mat4(2.0f);
  object.placement[3] = {1, 0, -1, 1};
  made.scene.objects = {object};
  finish(made.scene);
  return made;
}

Result<CapturedPicture> traced_at(const BendingStrip& strip, double time, const Camera& camera) {
  const Scene bent = pose_at(strip.scene, strip.deformations, time);
  const Result<RayScene> rays = RayScene::create(bent, 0, RayParts::all);
  if (!rays) return rays.error();
  CaptureRequest request;
  request.camera = camera;
  return RayTracer(*rays).capture(request);
}

// The slow twin: a scene that is made bent.
TEST(PosedTracer, a_picture_is_that_of_the_scene_at_its_time) {
  const BendingStrip strip = bending_strip();
  Result<std::unique_ptr<PosedTracer>> tracer = PosedTracer::create(
      strip.scene, strip.deformations, deformation_bounds(strip.scene, strip.deformations), 0);
  ASSERT_TRUE(tracer.ok());
  const Camera camera = look_at({2, 2, 6}, {1, 2, -1}, {0, 1, 0}, 0.8, 90, 90, 1, 20);
  for (const double time : {0.4, 0.9, 0.9, 3.3, 0.0}) {
    CaptureRequest request;
    request.camera = camera;
    request.time = time;
    const Result<CapturedPicture> found = (*tracer)->capture(request),
                                  wanted = traced_at(strip, time, camera);
    ASSERT_TRUE(found && wanted);
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 90; ++x) {
        ASSERT_EQ(found->picture.color(x, y), wanted->picture.color(x, y)) << time;
        ASSERT_EQ(found->picture.depth(x, y), wanted->picture.depth(x, y)) << time;
      }
  }
}

// The slow twin of update_meshes(): a scene that is made anew. Two objects bend, one stands still
// before them, and all of its triangles stay where they are.
TEST(PosedTracer, rays_hit_bent_meshes_where_they_would_in_a_scene_made_anew) {
  BendingStrip strip = bending_strip();
  Scene& scene = strip.scene;
  scene.meshes.push_back(scene.meshes[0]);
  Model still;
  still.parts = {{1, glm::mat4(1.0f)}};
  still.parts[0].model_from_mesh[3] = {0.4f, 1, 0, 1};
  scene.models.push_back(still);
  Object beside = scene.objects[0], before;
  beside.placement[3].x = 1.5f;
  before.model = 1;
  scene.objects.push_back(beside);
  scene.objects.push_back(before);
  finish(scene);
  Scene bent = scene;
  Result<RayScene> updated = RayScene::create(bent, 0, RayParts::all);
  ASSERT_TRUE(updated.ok());
  const int meshes[] = {0};
  std::mt19937 rng(5);
  std::uniform_real_distribution<float> any(-1, 1);
  int hits[3] = {};
  for (const double time : {0.3, 1.0, 0.7, 0.0}) {
    bend(strip.deformations, time, bent);
    ASSERT_TRUE(updated->update_meshes(meshes).ok());
    const Result<RayScene> anew = RayScene::create(bent, 0, RayParts::all);
    ASSERT_TRUE(anew.ok());
    for (int i = 0; i < 4000; ++i) {
      const glm::vec3 from(3 * any(rng), 2 + 2 * any(rng), 5),
          to(1 + 2 * any(rng), 2 + 2 * any(rng), -1);
      const auto a = updated->first_hit(from, to - from, 0, 10, RaySides::both),
                 b = anew->first_hit(from, to - from, 0, 10, RaySides::both);
      ASSERT_EQ(a.has_value(), b.has_value()) << time;
      if (!a) continue;
      ++hits[a->object - 1];
      ASSERT_EQ(a->object, b->object);
      ASSERT_EQ(a->triangle, b->triangle);
      ASSERT_EQ(a->distance, b->distance);
      ASSERT_EQ(a->normal, b->normal);
    }
  }
  for (const int count : hits) EXPECT_GT(count, 100);
}

// Pixels between two points for this eye, in the middle of a frame.
double apart_px(const ImpostorEye& eye, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 one = glm::normalize(a - eye.position), two = glm::normalize(b - eye.position);
  return eye.focal_px * std::atan2(glm::length(glm::cross(one, two)), glm::dot(one, two));
}

TEST(PosedTracer, what_is_drawn_is_off_by_no_more_than_its_bound_and_right_once_it_is_made_again) {
  const BendingStrip strip = bending_strip();
  Result<std::unique_ptr<PosedTracer>> tracer = PosedTracer::create(
      strip.scene, strip.deformations, deformation_bounds(strip.scene, strip.deformations), 0);
  ASSERT_TRUE(tracer.ok());
  ImpostorObject object;
  object.objects = {0};
  object.drawable = false;
  set_deformation(strip.scene, deformation_bounds(strip.scene, strip.deformations), 0, object);
  // The tip, 2 metres from the joint at twice the size, 0.9 radians a second; all else is slower.
  EXPECT_GT(object.deforms, 2 * 0.9);
  EXPECT_LT(object.deforms, 3 * 2 * 0.9);
  EXPECT_NEAR(object.jump, 0, 1e-5);
  EXPECT_EQ(object.period, 2);
  std::vector<glm::mat4> poses;
  pose(strip.scene, 0, poses);
  const auto vertices = [&](double time) {
    const Scene bent = pose_at(strip.scene, strip.deformations, time);
    std::vector<glm::dvec3> all;
    for (const glm::vec3& p : bent.meshes[0].positions)
      all.emplace_back(poses[0] * glm::vec4(p, 1));
    return all;
  };

  ImpostorWorkers workers({tracer->get()}, {object}, {.size = 128, .samples = 1});
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> any(-1, 1);
  double made = 0, largest = 0;
  int renewed = 0, wrong = 0, stale_wrong = 0, covered = 0;
  ImpostorEye eye;
  eye.focal_px = 120;
  for (int step = 0; step < 40; ++step) {
    eye.position = glm::dvec3(1, 2, 6) + 0.3 * glm::dvec3(any(rng), any(rng), any(rng));
    // Some steps are a pixel's, some many.
    eye.time += std::pow(10.0, any(rng) - 1.6);
    const ImpostorFrame frame = workers.frame(0, eye);
    if (frame.board) {
      const std::vector<glm::dvec3> then = vertices(made), now = vertices(eye.time);
      for (std::size_t i = 0; i < now.size(); ++i) {
        const double off = apart_px(eye, then[i], now[i]);
        ASSERT_LE(off, frame.deformed_px + 1e-3) << step;
        largest = std::max(largest, off);
      }
    }
    // Until nothing is ordered any more.
    ImpostorFrame then = frame;
    bool ordered = false;
    for (int round = 0; round < 6; ++round) {
      ordered = ordered || then.rendering;
      workers.wait_until_idle();
      then = workers.frame(0, eye);
      if (!then.warping && !then.rendering) break;
    }
    ASSERT_TRUE(then.board) << workers.last_error();
    ASSERT_LE(then.deformed_px, 0.5);
    if (then.deformed_px == 0) made = eye.time;
    renewed += ordered;
    // The truth at the same time, by the eye and the window of the board.
    if (step % 4) continue;
    const Prewarped& board = *then.board;
    const Result<CapturedPicture> truth = traced_at(strip, eye.time, board.geometry.capture),
                                  first = traced_at(strip, 0, board.geometry.capture);
    ASSERT_TRUE(truth && first);
    for (int y = 0; y < board.height(); ++y)
      for (int x = 0; x < board.width(); ++x) {
        const bool shows = board.color[std::size_t(y * board.width() + x)].a >= 128;
        const bool there = truth->picture.color(x, y).a >= 0.5f;
        covered += there;
        wrong += shows != there;
        stale_wrong += (first->picture.color(x, y).a >= 0.5f) != there;
      }
  }
  EXPECT_GT(renewed, 10);
  EXPECT_GT(largest, 5);
  // Along silhouettes, half a pixel and the warp's samples; a scene that stands still is wrong by
  // most of its upper half.
  EXPECT_LT(wrong, 0.15 * covered);
  EXPECT_GT(stale_wrong, 3 * wrong);
}

}  // namespace
}  // namespace rilievo
