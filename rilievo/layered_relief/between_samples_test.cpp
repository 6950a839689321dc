#include "rilievo/layered_relief/between_samples.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/random.h"
#include "rilievo/layered_relief/relief_pictures.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

// The places between the samples of each picture of a scene, and the samples' own.
struct Places {
  std::vector<glm::dvec3> between, all;
  double texel = 0;
};
Places places_between(const Scene& scene, double spacing_texels) {
  Places out;
  const auto rays = RayScene::create(scene);
  EXPECT_TRUE(rays.ok());
  RaySource source(*rays);
  const auto made = capture_relief_pictures(source, {}, {.size = 48, .share_texels = 0});
  EXPECT_TRUE(made.ok());
  std::vector<const LayeredDepthImage*> all;
  for (const ReliefPictures::Picture& picture : made->pictures) all.push_back(&picture.layers);
  const auto closed = find_closed_objects(all);
  for (const LayeredDepthImage* layers : all) {
    out.texel = std::max(out.texel, texel_angle(layers->camera));
    const int width = layers->camera.width;
    for (std::size_t i = 0; i + 1 < layers->first.size(); ++i)
      for (std::uint64_t s = layers->first[i]; s < layers->first[i + 1]; ++s) {
        const glm::dvec2 at(int(i) % width + 0.5, int(i) / width + 0.5);
        out.all.push_back(world_from_raster(
            layers->camera, at,
            eye_z_from(layers->depth_kind, double(layers->samples[s].depth), layers->camera, at)));
      }
  }
  for (const LayeredDepthImage* layers : all) {
    const SampleSides sides(*layers, closed);
    SurfaceLattice(sides).each_place(
        spacing_texels * out.texel, [](std::size_t) { return true; },
        [&](const PlaceBetween& place) { out.between.push_back(place.world); });
  }
  out.all.insert(out.all.end(), out.between.begin(), out.between.end());
  return out;
}

double nearest(const std::vector<glm::dvec3>& places, const glm::dvec3& to) {
  double least = 1e9;
  for (const glm::dvec3& p : places) least = std::min(least, glm::distance(p, to));
  return least;
}

TEST(BetweenSamples, they_lie_on_a_ball_and_leave_no_gaps) {
  Scene scene;
  test_shapes::add(scene, test_shapes::sphere(1), glm::vec3(1), glm::mat4(1));
  finish(scene);
  const Places places = places_between(scene, 0.5);
  // The ball's own triangles lie up to 0.0011 inside of it.
  for (const glm::dvec3& p : places.between)
    ASSERT_NEAR(glm::length(p), 1, 0.5 * kOnePlane * places.texel + 0.0011);
  Random random(3);
  double widest = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 at(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    if (glm::length(at) < 0.1) continue;
    widest = std::max(widest, nearest(places.all, glm::normalize(at)));
  }
  // Half of the diagonal of a square of the spacing is 0.35; hits alone leave 0.87.
  EXPECT_LT(widest, 0.4 * places.texel);
}

TEST(BetweenSamples, nothing_lies_between_two_boxes_or_leaves) {
  Scene boxes;
  for (const float x : {-0.56f, 0.56f})
    test_shapes::add(boxes, test_shapes::box(glm::vec3(0.5f)), glm::vec3(1),
                     glm::translate(glm::mat4(1), glm::vec3(x, 0, 0)));
  finish(boxes);
  const Places places = places_between(boxes, 0.5);
  EXPECT_GT(places.between.size(), 1000u);
  for (const glm::dvec3& p : places.between) ASSERT_GE(std::abs(p.x), 0.06 - 1e-5);

  Scene leaf;
  Mesh mesh;
  mesh.positions = {{-1, 0, -1}, {1, 0.3f, -1}, {1, 0.2f, 1}};
  mesh.indices = {0, 1, 2};
  mesh.material = 0;
  leaf.materials.emplace_back();
  leaf.meshes = {mesh};
  leaf.models = {{"leaf", {{0, glm::mat4(1)}}, {}, 0}};
  leaf.objects.resize(1);
  finish(leaf);
  EXPECT_TRUE(places_between(leaf, 0.5).between.empty());
}

}  // namespace
}  // namespace rilievo
