// Points and lines by the rasteriser and by rays, against their definition.
#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/render/placed_scene.h"
#include "rilievo/render/raster/raster_picture.h"
#include "rilievo/render/raster/whole_frames_test_helpers.h"
#include "rilievo/render/rays/cast_layers.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/rays/stroke_hits.h"
#include "rilievo/render/strokes_test_helpers.h"

namespace rilievo {
namespace {

// Of single precision, in pixels: far less than a sample's distance from the next one.
constexpr double kRoundingPx = 0.01;

struct Compared {
  int shown = 0, doubtful = 0;
};

// Rows from the bottom.
void compare(const Scene& scene, const Camera& camera, const ObjectPicture& picture,
             Compared& compared) {
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const StrokeSeen seen =
          stroke_at_raster(scene, camera, {x + 0.5, camera.height - y - 0.5}, kRoundingPx);
      if (seen.doubtful) {
        ++compared.doubtful;
        continue;
      }
      const std::size_t at = std::size_t(y) * std::size_t(camera.width) + std::size_t(x);
      ASSERT_EQ(picture.object[at], seen.object) << x << " " << y << " eye_z " << seen.eye_z;
      if (seen.object == kNoObject) continue;
      ++compared.shown;
      const double z = 1 - double(picture.depth[at]) * (1 - camera.z_near / camera.z_far);
      ASSERT_NEAR(camera.z_near / z, seen.eye_z, 2e-4 * seen.eye_z * seen.eye_z);
    }
}

TEST(Strokes, discs_and_lines_cover_the_pixels_that_they_should_in_frames) {
  const Scene scene = random_strokes(3, 90);
  RasterFrames raster(scene);
  RayFrames rays(scene);
  Random random(5);
  Compared compared;
  for (int i = 0; i < 12; ++i) {
    const Camera camera = stroke_camera(random, Projection::perspective, 61, 47);
    ObjectPicture picture;
    ASSERT_TRUE(raster.draw_objects(camera, picture).ok());
    compare(scene, camera, picture, compared);
    if (HasFatalFailure()) FAIL() << "the rasteriser, eye " << i;
    rays.draw_objects(camera, picture);
    compare(scene, camera, picture, compared);
    if (HasFatalFailure()) FAIL() << "rays, eye " << i;
  }
  EXPECT_GT(compared.shown, 5000);
  EXPECT_LT(compared.doubtful, compared.shown / 10);
}

TEST(Strokes, single_rays_of_every_camera_meet_them_where_they_are) {
  const Scene scene = random_strokes(4, 90);
  auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  Random random(6);
  for (const Projection projection :
       {Projection::perspective, Projection::parallel, Projection::back_perspective})
    for (int i = 0; i < 3; ++i) {
      const Camera camera = stroke_camera(random, projection, 45, 51);
      const DepthImage picture = cast_picture(*rays, camera, {});
      const StrokeHits strokes(*rays, camera, {});
      int shown = 0;
      for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
          const StrokeSeen seen = stroke_at_raster(scene, camera, {x + 0.5, y + 0.5}, kRoundingPx);
          if (seen.doubtful) continue;
          ASSERT_EQ(picture.object(x, y), seen.object) << int(projection) << " " << x << " " << y;
          if (seen.object == kNoObject) continue;
          ++shown;
          ASSERT_NEAR(double(picture.depth(x, y)), seen.eye_z, 1e-4 * seen.eye_z);
          const float farthest = strokes.farthest_eye_z({x + 0.5, y + 0.5});
          ASSERT_GE(farthest, float(seen.eye_z) - 1e-3f);
          // Unlit, in the colour of its vertices.
          ASSERT_NEAR(picture.color(x, y).g, 0.5f, 1e-3f);
          ASSERT_NEAR(picture.color(x, y).a, 1.0f, 1e-6f);
        }
      EXPECT_GT(shown, 100);
    }
}

TEST(Strokes, layers_hold_each_that_a_ray_meets) {
  const Scene scene = random_strokes(8, 200);
  auto rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  Random random(2);
  const Camera camera = stroke_camera(random, Projection::parallel, 30, 30);
  const LayeredDepthImage layers = cast_layers(*rays, camera, {});
  const DepthImage nearest = cast_picture(*rays, camera, {});
  int several = 0;
  for (std::size_t t = 0; t + 1 < layers.first.size(); ++t) {
    const std::uint32_t first = layers.first[t], end = layers.first[t + 1];
    const int x = int(t) % camera.width, y = int(t) / camera.width;
    ASSERT_EQ(end > first, nearest.covered(x, y));
    if (end == first) continue;
    ASSERT_EQ(layers.samples[first].object, nearest.object(x, y));
    for (std::uint32_t i = first + 1; i < end; ++i)
      ASSERT_GT(layers.samples[i].depth, layers.samples[i - 1].depth);
    several += end > first + 1;
  }
  EXPECT_GT(several, 30);
}

// In each column of a flat line, and in each row of a steep one, there is a pixel; and wherever it
// lies on the raster, it has as many on average as a strip a pixel wide with round ends.
TEST(Strokes, a_line_has_no_gap_at_any_angle_and_is_a_pixel_wide) {
  constexpr int kSize = 64, kPlaces = 5;
  Random random(1);
  double pixels = 0;
  for (int degrees = 0; degrees < 180; ++degrees)
    for (int place = 0; place < kPlaces; ++place) {
      const double angle = double(degrees) * 3.14159265358979 / 180;
      const glm::vec3 way(std::cos(angle), std::sin(angle), 0);
      // In the first place it lies between two rows, or columns, of pixels.
      const glm::vec3 off = place == 0 ? glm::vec3(0) : glm::vec3(random.unit(), random.unit(), 0);
      Scene scene;
      Mesh mesh;
      mesh.primitive = Primitive::lines;
      mesh.positions = {off - 25.0f * way, off + 25.0f * way};
      mesh.indices = {0, 1};
      scene.meshes.push_back(mesh);
      scene.models.emplace_back().parts = {Part{}};
      scene.objects.emplace_back();
      finish(scene);
      const Camera camera = look_at({0, 0, 32}, {0, 0, 0}, {0, 1, 0}, 2 * std::atan(1.0), kSize,
                                    kSize, 1, 100);  // a pixel is a metre
      RasterFrames raster(scene);
      ObjectPicture picture;
      ASSERT_TRUE(raster.draw_objects(camera, picture).ok());
      int columns = 0, rows = 0, all = 0;
      for (int i = 0; i < kSize; ++i) {
        bool in_column = false, in_row = false;
        for (int k = 0; k < kSize; ++k) {
          in_column |= picture.object[std::size_t(k * kSize + i)] != kNoObject;
          in_row |= picture.object[std::size_t(i * kSize + k)] != kNoObject;
          all += picture.object[std::size_t(i * kSize + k)] != kNoObject;
        }
        columns += in_column, rows += in_row;
      }
      const double across = 50 * std::abs(std::cos(angle)), down = 50 * std::abs(std::sin(angle));
      EXPECT_GE(across > down ? columns : rows, int(std::max(across, down))) << degrees;
      if (place == 0 && degrees % 90 == 0) {
        EXPECT_EQ(all, 50) << degrees;  // one row
      }
      if (place > 0) pixels += all;
    }
  EXPECT_NEAR(pixels / (180 * (kPlaces - 1)), 50 + 3.14159265 / 4, 0.5);
}

// The same pixels where there are four samples: 16 times as many places decide.
TEST(Strokes, with_four_samples_coverage_is_the_area) {
  Scene scene;
  Mesh mesh;
  mesh.primitive = Primitive::points;
  mesh.width = 20;
  mesh.positions = {{0, 0, 0}};
  mesh.indices = {0};
  scene.meshes.push_back(mesh);
  scene.models.emplace_back().parts = {Part{}};
  scene.objects.emplace_back();
  finish(scene);
  const Camera camera =
      look_at({0, 0, 32}, {0, 0, 0}, {0, 1, 0}, 2 * std::atan(1.0), 64, 64, 1, 100);
  RasterFrames raster(scene);
  RasterPicture picture;
  ASSERT_TRUE(raster.draw(camera, 4, picture).ok());
  double area = 0;
  for (const glm::u8vec4& texel : picture.color) area += texel.a / 255.0;
  EXPECT_NEAR(area, 100 * 3.14159265, 2);
}

TEST(Strokes, normals_count_from_both_sides_and_what_has_none_is_unlit) {
  for (const float z : {1.0f, -1.0f, 0.0f}) {
    Scene scene;
    Mesh mesh;
    mesh.primitive = Primitive::points;
    mesh.width = 20;
    mesh.positions = {{0, 0, 0}};
    if (z != 0) mesh.normals = {{0, 0, z}};
    mesh.colors = {{0.5f, 0.5f, 0.5f, 1}};
    mesh.indices = {0};
    scene.meshes.push_back(mesh);
    scene.models.emplace_back().parts = {Part{}};
    scene.objects.emplace_back();
    Light light;
    light.direction = {0, 0, -1};
    scene.lights = {light};
    finish(scene);
    const Camera camera =
        look_at({0, 0, 32}, {0, 0, 0}, {0, 1, 0}, 2 * std::atan(1.0), 16, 16, 1, 100);
    auto rays = RayScene::create(scene);
    ASSERT_TRUE(rays.ok());
    const glm::vec4 light_of_rays = cast_picture(*rays, camera, {}).color(8, 8);
    PlacedScene placed(scene);
    PictureRasterizer raster(scene);
    const std::uint32_t object = 0;
    const DepthImage by_raster = raster.capture(camera, {&object, 1}, placed.poses(), 1, false);
    EXPECT_NEAR(by_raster.color(8, 8).g, light_of_rays.g, 1e-4f);
    if (z == 0) {
      EXPECT_NEAR(light_of_rays.g, 0.5f, 1e-4f);
    } else {
      EXPECT_GT(light_of_rays.g, 0.1f);  // lit from the front, whichever way the normal points
      static float of_front = light_of_rays.g;
      EXPECT_NEAR(light_of_rays.g, of_front, 1e-4f);
    }
  }
}

}  // namespace
}  // namespace rilievo
