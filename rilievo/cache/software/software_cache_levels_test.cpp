#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/mesh_distance.h"

namespace rilievo {
namespace {

constexpr int kWidth = 320, kHeight = 180;

ImageCacheOptions with_levels(double error_px) {
  ImageCacheOptions options;
  options.levels = true, options.error_px = error_px, options.delta_bits = 16;
  return options;
}

std::unique_ptr<TestSource> make_cache(const Scene& scene, const ImageCacheOptions& options) {
  auto cache = software_cache(scene, options);
  EXPECT_TRUE(cache.ok());
  return std::move(*cache);
}

// All triangles of a scene at time 0.
TriangleTree tree_of(const Scene& scene) {
  const PlacedScene placed(scene);
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t object = 0; object < scene.objects.size(); ++object)
    for (const Part& part : scene.models[std::size_t(scene.objects[object].model)].parts) {
      const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
      for (const std::uint32_t vertex : mesh.indices) {
        indices.push_back(std::uint32_t(positions.size()));
        positions.emplace_back(placed.poses()[object] * part.model_from_mesh *
                               glm::vec4(mesh.positions[vertex], 1));
      }
    }
  return {positions, indices};
}

// What a level is off by in space appears no smaller than this in the middle of the frame; so what
// a frame says of its error bounds the distance of each surface that it draws from the true ones.
TEST(SoftwareCacheLevels, draw_surfaces_that_are_within_the_frames_bound_of_the_true_ones) {
  const auto made = make_builtin("builtin:teapots?triangles=200000");
  ASSERT_TRUE(made.ok());
  const TriangleTree truth = tree_of(made->scene);
  const auto cache = make_cache(made->scene, with_levels(4));
  int samples = 0;
  double farthest = 0;
  for (int frame = 0; frame < 6; ++frame) {
    const Camera camera = camera_at(made->path, frame_time(made->path, frame), kWidth, kHeight);
    ASSERT_TRUE(cache->draw(camera, 0).ok());  // nothing moves
    const double bound_px = cache->stats().bound_px.value();
    const double pixels = kHeight / (camera.window.top - camera.window.bottom);
    for (const DepthImage& picture : cache->read_pictures())
      for (int y = 0; y < picture.depth.height(); y += 3)
        for (int x = 0; x < picture.depth.width(); x += 3) {
          if (!picture.covered(x, y)) continue;
          const glm::dvec3 at =
              world_from_raster(picture.camera, {x + 0.5, y + 0.5}, double(picture.depth(x, y)));
          const double z = raster_from_world(camera, at).z;
          if (!(z > camera.z_near)) continue;
          const double off = std::sqrt(truth.nearest(at).square);
          // 16 bits of Delta, of a picture that is no deeper than a hundred metres.
          ASSERT_LE(off, bound_px * z / pixels + 0.002) << frame;
          farthest = std::max(farthest, off * pixels / z);
          ++samples;
        }
  }
  EXPECT_GT(samples, 2000);
  EXPECT_GT(farthest, 0.2);  // pixels: levels are in use
}

// Does the image show an object at the pixel or near it?
bool shown_near(const Image<std::uint32_t>& objects, int x, int y, double reach) {
  const int r = int(std::ceil(reach));
  for (int dy = -r; dy <= r; ++dy)
    for (int dx = -r; dx <= r; ++dx) {
      const int u = x + dx, v = y + dy;
      if (std::hypot(dx, dy) > reach) continue;
      if (u < 0 || v < 0 || u >= objects.width() || v >= objects.height()) return true;
      if (objects(u, v) != kNoObject) return true;
    }
  return false;
}

// Polygons and pictures alike: what shows a teapot is near where a teapot is, and the other way.
TEST(SoftwareCacheLevels, outlines_are_off_by_no_more_than_the_bound) {
  const auto made = make_builtin("builtin:teapot?triangles=30000");
  ASSERT_TRUE(made.ok());
  for (const bool polygons : {false, true}) {
    ImageCacheOptions options = with_levels(6);
    options.machine = builtin_software_costs();
    if (polygons)
      options.machine->capture_rasterizer.picture_ns = 1e12;
    else
      options.machine->draw_software.triangle_ns = options.machine->draw_software.object_ns = 1e6;
    const auto cache = make_cache(made->scene, options);
    TestSource direct = software_direct(made->scene, 4);
    int differs = 0;
    for (int frame = 0; frame < 4; ++frame) {
      const Camera camera =
          camera_at(made->path, frame_time(made->path, 10 * frame), kWidth, kHeight);
      for (FrameSource* source :
           {static_cast<FrameSource*>(cache.get()), static_cast<FrameSource*>(&direct)}) {
        ASSERT_TRUE(source->draw(camera, 0).ok());
        ASSERT_TRUE(source->draw_objects().ok());
      }
      const Image<std::uint32_t>&drawn = cache->software_target()->objects(),
            &truth = direct.software_target()->objects();
      EXPECT_LE(cache->stats().bound_px, options.error_px + 1e-9);
      EXPECT_EQ(cache->stats().polygons > 0, polygons);
      // A pixel's corner, and that of a texel.
      const double reach = cache->stats().bound_px.value() + 1.5;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          differs += drawn(x, y) != truth(x, y);
          if (drawn(x, y) != kNoObject) {
            ASSERT_TRUE(shown_near(truth, x, y, reach)) << x << " " << y;
          }
          if (truth(x, y) != kNoObject) {
            ASSERT_TRUE(shown_near(drawn, x, y, reach)) << x << " " << y;
          }
        }
    }
    EXPECT_GT(differs, 0);
  }
}

TEST(SoftwareCacheLevels, draw_the_same_bytes_with_any_number_of_threads) {
  const auto made = make_builtin("builtin:teapots?triangles=60000");
  ASSERT_TRUE(made.ok());
  const auto walk = [&](const ImageCacheOptions& options) {
    const auto cache = make_cache(made->scene, options);
    std::vector<Rgba8Image> colors;
    for (int frame = 0; frame < 4; ++frame) {
      const Camera camera = camera_at(made->path, frame_time(made->path, frame), kWidth, kHeight);
      EXPECT_TRUE(cache->draw(camera, 0).ok());
      EXPECT_TRUE(cache->draw_objects().ok());  // which leaves the levels as they were
      colors.push_back(cache->software_target()->color());
    }
    return colors;
  };
  const auto together = walk(with_levels(2));
  ImageCacheOptions without = with_levels(2);
  without.levels = false;
  EXPECT_NE(together, walk(without));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(together, walk(with_levels(2)));
}

}  // namespace
}  // namespace rilievo
