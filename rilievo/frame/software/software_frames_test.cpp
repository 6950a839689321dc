#include "rilievo/frame/software/software_frames.h"
#include "rilievo/method/test_source_test_helpers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/render/rays/ray_visibility.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

// The slow twin: a scene that is made as it is at that time. A ball is pulled aside by a target
// within a second, out of where it was; the one beside it stands still.
TEST(SoftwareFrames, show_what_bends_as_it_is_at_their_time) {
  Scene scene;
  test_shapes::add(scene, test_shapes::sphere(0.8), {0.8f, 0.5f, 0.2f});
  test_shapes::add(scene, test_shapes::sphere(0.5), {0.3f, 0.7f, 0.2f},
                   glm::translate(glm::mat4(1), {-1, 0, -2}));
  for (Mesh& mesh : scene.meshes) make_flat(mesh);
  finish(scene);
  Deformations deformations;
  Deformation& ball = deformations.meshes.emplace_back();
  ball.positions = scene.meshes[0].positions, ball.normals = scene.meshes[0].normals;
  Deformation::Target& target = ball.targets.emplace_back();
  for (const glm::vec3& p : ball.positions) target.positions.push_back({3 + p.y, 0, 0});
  target.weights.times = {0, 1}, target.weights.values = {{0, 0, 0, 0}, {1, 0, 0, 0}};
  deformations.rig.duration = 2;
  // At the end, the ball is out of view of the first camera, and in view of the second.
  const Camera here = look_at({0, 0.4, 5}, {0, 0, 0}, {0, 1, 0}, 0.6, 96, 64, 0.1, 50),
               there = look_at({4, 0.4, 5}, {4, 0, 0}, {0, 1, 0}, 0.6, 96, 64, 0.1, 50);
  for (const int samples : {1, 4}) {
    TestSource frames = software_direct(scene, samples, nullptr, &deformations);
    Rgba8Image last;
    for (const double time : {0.0, 0.4, 1.0, 0.7, 2.4}) {
      const Scene bent = pose_at(scene, deformations, time);
      TestSource truth = software_direct(bent, samples);
      for (const Camera& camera : {here, there}) {
        ASSERT_TRUE(frames.draw(camera, time).ok() && truth.draw(camera, time).ok());
        EXPECT_EQ(frames.software_target()->color(), truth.software_target()->color()) << time;
        ASSERT_TRUE(frames.draw_objects().ok() && truth.draw_objects().ok());
        EXPECT_EQ(frames.software_target()->objects(), truth.software_target()->objects()) << time;
      }
      EXPECT_FALSE(frames.software_target()->color() == last);
      last = frames.software_target()->color();
    }
  }
}

// In a frame that is no whole number of tiles.
TEST(SoftwareFrames, rays_show_what_the_rasteriser_shows_but_for_samples_on_edges) {
  auto built = make_builtin("builtin:teapots?triangles=10000");
  ASSERT_TRUE(built.ok());
  const Scene& scene = built->scene;
  for (const int samples : {1, 4}) {
    auto rays = RayVisibility::create(scene);
    ASSERT_TRUE(rays.ok());
    TestSource by_rays = software_direct(scene, samples, std::move(*rays)),
               by_raster = software_direct(scene, samples);
    for (const double time : {0.0, 1.5}) {
      const Camera camera = camera_at(built->path, time, 150, 90);
      ASSERT_TRUE(by_rays.draw(camera, time).ok() && by_raster.draw(camera, time).ok());
      ASSERT_TRUE(by_rays.draw_objects().ok() && by_raster.draw_objects().ok());
      const SoftwareTarget &a = *by_rays.software_target(), &b = *by_raster.software_target();
      const Image<float> far_a = a.eye_z(), far_b = b.eye_z();
      int other_color = 0, other_object = 0, other_depth = 0, shown = 0;
      for (std::size_t i = 0; i < far_a.texels().size(); ++i) {
        const glm::ivec4 apart =
            glm::abs(glm::ivec4(a.color().texels()[i]) - glm::ivec4(b.color().texels()[i]));
        other_color += std::max({apart.r, apart.g, apart.b}) > 2;
        other_object += a.objects().texels()[i] != b.objects().texels()[i];
        // Floats of window_z at some metres.
        other_depth += !(std::abs(far_a.texels()[i] - far_b.texels()[i]) < 1e-2f) &&
                       far_a.texels()[i] != far_b.texels()[i];
        shown += b.objects().texels()[i] != kNoObject;
      }
      EXPECT_LE(other_color, 150 * 90 / 200) << samples;
      EXPECT_LE(other_object, 150 * 90 / 500) << samples;
      EXPECT_LE(other_depth, 150 * 90 / 200) << samples;
      EXPECT_GT(shown, 150 * 90 / 10);
      EXPECT_EQ(by_rays.stats().polygons, by_raster.stats().polygons);
    }
  }
}

// Chooses no polygons, and fails at a time of its own.
struct CountedChooser final : FrameChooser {
  int chosen = 0, drawn_frames = 0;

  void add_sets(FrameContent&) override {}
  Result<> choose(const Camera&, const PlacedScene& placed, FrameContent&, FrameStats&) override {
    EXPECT_EQ(chosen, drawn_frames);
    ++chosen;
    if (placed.time() > 0) return Error{"chooser", "too late"};
    return Done{};
  }
  void drawn(const FrameWork*, FrameStats&) override { ++drawn_frames; }
};

TEST(SoftwareFrames, tell_the_chooser_when_a_frame_is_drawn_or_cannot_be) {
  Scene scene;
  test_shapes::add(scene, test_shapes::sphere(0.8), {0.8f, 0.5f, 0.2f});
  finish(scene);
  CountedChooser* chooser = nullptr;
  const auto frames = std::move(
      *software_chosen(scene, 1, [&](const PlacedScene&) -> Result<std::unique_ptr<FrameChooser>> {
        auto made = std::make_unique<CountedChooser>();
        chooser = made.get();
        return {std::move(made)};
      }));
  const Camera camera = look_at({0, 0.4, 5}, {0, 0, 0}, {0, 1, 0}, 0.6, 96, 64, 0.1, 50);
  EXPECT_TRUE(frames->draw(camera, 0).ok());
  EXPECT_EQ(chooser->drawn_frames, 1);
  EXPECT_FALSE(frames->draw(camera, 1).ok());
  EXPECT_EQ(chooser->drawn_frames, 2);
  EXPECT_TRUE(frames->draw(camera, 0).ok());
  EXPECT_EQ(chooser->drawn_frames, 3);
}

}  // namespace
}  // namespace rilievo
