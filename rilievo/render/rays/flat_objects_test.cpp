// What a placement flattens is drawn as a sheet, by rays and by the rasteriser: as the same object
// is that is thin and has an inverse.
#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/core/linear_maps.h"
#include "rilievo/render/flat_test_helpers.h"
#include "rilievo/render/raster/raster_picture.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {
namespace {

const std::uint32_t kCube[] = {0};

RasterPicture flat_by_raster(const Scene& scene, double time) {
  std::vector<glm::mat4> poses;
  pose(scene, time, poses);
  RasterPicture picture;
  PictureRasterizer(scene).draw(test::cube_camera(), kCube, poses, 4, picture);
  return picture;
}

RasterPicture flat_by_rays(const Scene& scene, double time) {
  Result<RayScene> rays = RayScene::create(scene);
  EXPECT_TRUE(rays.ok());
  EXPECT_TRUE(rays->set_time(time).ok());
  RasterPicture picture;
  PictureCaster(*rays).draw(test::cube_camera(), kCube, 4, picture);
  return picture;
}

int shown(const RasterPicture& picture) {
  int count = 0;
  for (const glm::u8vec4& c : picture.color) count += c.a > 0;
  return count;
}

// The share of texels that differ by more than a level.
double differing(const RasterPicture& a, const RasterPicture& b) {
  EXPECT_EQ(a.color.size(), b.color.size());
  int differ = 0;
  for (std::size_t i = 0; i < a.color.size(); ++i)
    for (int c = 0; c < 4; ++c)
      if (std::abs(int(a.color[i][c]) - int(b.color[i][c])) > 1) {
        ++differ;
        break;
      }
  return double(differ) / double(a.color.size());
}

TEST(FlatObjects, are_sheets_lit_as_thin_ones) {
  for (const glm::dvec3& scale : test::flat_scales()) {
    const Scene flat = test::scaled_cube(scale), thin = test::scaled_cube(test::thickened(scale));
    const RasterPicture raster = flat_by_raster(flat, 0), rays = flat_by_rays(flat, 0);
    if (!test::is_sheet(scale)) {
      EXPECT_EQ(shown(raster), 0);
      EXPECT_EQ(shown(rays), 0);
      continue;
    }
    EXPECT_GT(shown(raster), 250) << scale.x << scale.y << scale.z;
    // Beside an edge, 1e-5 metres of thickness may cover a sample.
    EXPECT_LT(differing(raster, flat_by_raster(thin, 0)), 0.005);
    EXPECT_LT(differing(rays, flat_by_rays(thin, 0)), 0.005);
    EXPECT_LT(differing(raster, rays), 0.005);
  }
}

TEST(FlatObjects, may_be_flat_for_a_moment) {
  for (const glm::dvec3& scale : test::flat_scales()) {
    const Scene scene = test::squashed_cube(glm::vec3(scale));
    EXPECT_EQ(flat_by_rays(scene, 1).color, flat_by_rays(test::scaled_cube(scale), 0).color);
    EXPECT_EQ(flat_by_raster(scene, 1).color, flat_by_raster(test::scaled_cube(scale), 0).color);
    Result<RayScene> rays = RayScene::create(scene, 1);
    ASSERT_TRUE(rays.ok());
    ASSERT_TRUE(rays->set_time(2).ok());  // whole again
    const auto hit = rays->first_hit({0, 0, 3}, {0, 0, -1}, 0, 10);
    ASSERT_TRUE(hit.has_value());
    EXPECT_FLOAT_EQ(hit->distance, 2.5f);
    EXPECT_EQ(hit->normal, glm::vec3(0, 0, 1));
  }
}

TEST(FlatObjects, have_normals_on_the_side_that_a_ray_meets) {
  const Scene scene = test::scaled_cube({1, 1, 0});
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  for (const float side : {1.0f, -1.0f}) {
    const auto hit = rays->first_hit({0.1, 0.2, 3 * side}, {0, 0, -side}, 0, 10);
    ASSERT_TRUE(hit.has_value());
    EXPECT_FLOAT_EQ(hit->distance, 3);
    EXPECT_EQ(hit->normal, glm::vec3(0, 0, side));
  }
}

TEST(LinearMaps, tell_what_mirrors_and_what_is_flat) {
  EXPECT_TRUE(is_mirroring(glm::dmat3(glm::scale(glm::dmat4(1), {-1e-20, 1e-20, 1e-20}))));
  EXPECT_FALSE(is_mirroring(glm::dmat3(glm::scale(glm::dmat4(1), {-1, 1, 0}))));
  for (const glm::dvec3& scale : test::flat_scales())
    EXPECT_FALSE(is_invertible(glm::dmat3(glm::scale(glm::dmat4(1), scale))));
  EXPECT_TRUE(is_invertible(glm::dmat3(glm::scale(glm::dmat4(1), {-1000.0, 0.1, 10.0}))));
  EXPECT_FALSE(is_invertible(glm::dmat3(NAN)));
  // At right angles to the images of what they were at right angles to.
  const glm::dmat3 shear({1, 0.3, 0}, {0, -2, 0.1}, {0.5, 0, 1});
  const glm::dvec3 n = normal_map(shear) * glm::dvec3(0, 0, 1);
  EXPECT_NEAR(glm::dot(n, shear[0]), 0, 1e-12);
  EXPECT_NEAR(glm::dot(n, shear[1]), 0, 1e-12);
  EXPECT_GT(glm::dot(n, shear[2]), 0);
}

}  // namespace
}  // namespace rilievo
