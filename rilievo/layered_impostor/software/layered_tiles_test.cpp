// Against the slow drawing (layered_impostor/warp.h); against OpenGL's in
// cache/gl/software_kinds_test.cpp.
#include "rilievo/layered_impostor/software/layered_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rilievo/core/random.h"
#include "rilievo/layered_impostor/jug_test_helpers.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/layered_impostor/warp.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

// No whole number of blocks.
constexpr int kMarchedWidth = 90, kMarchedHeight = 75;

TEST(LayeredTiles, surfaces_are_what_the_slow_drawing_shows) {
  // The slow drawing mixes colours as they are: encoded ones, as tiles do.
  LayeredImpostor impostor = test_shapes::jug_impostor(64);
  for (DepthImage& picture : impostor.pictures) {
    const Image<glm::u8vec4> encoded = encoded_colors(picture.color);
    std::transform(encoded.texels().begin(), encoded.texels().end(), picture.color.texels().begin(),
                   [](const glm::u8vec4& c) { return glm::vec4(c) / 255.0f; });
  }
  const LayeredOptions options;
  const auto drawable = make_layered_tiles(test_shapes::jug_impostor(64), options);
  const glm::dvec3 center(impostor.bounds.center());
  const double radius = double(impostor.bounds.radius());
  Random random(9);
  int pixels = 0, coverage = 0, object = 0, depth = 0, color = 0;
  for (int i = 0; i < 16; ++i) {
    const float x = random.between(-1, 1), y = random.between(-1, 1), z = random.between(-1, 1);
    // The nearest eyes stand in the bounds.
    const double distance = 0.8 + 0.2 * i;
    const Camera camera = look_at(center + distance * radius * glm::normalize(glm::dvec3(x, y, z)),
                                  center, {0.1, 1, 0}, std::min(1.4, 2.2 / distance), kMarchedWidth,
                                  kMarchedHeight, 0.02 * radius, 8 * radius);
    const DepthImage expected = warp_surfaces(
        impostor, camera, {.max_views = options.max_views, .handover = options.handover});
    SoftwareTarget target(kMarchedWidth, kMarchedHeight, 1);
    const TileDrawer* drawers[] = {drawable->tiles()};
    const Instance instance{glm::dmat4(1.0), 0, kNoObject};
    drawable->draw(camera, {&instance, 1}, Output::object_id);
    target.draw_objects(camera.z_far, drawers);
    drawable->draw(camera, {&instance, 1}, Output::color);
    target.draw(camera.z_far, drawers);
    const Image<float> eye_z = target.eye_z();
    for (int v = 0; v < kMarchedHeight; ++v)
      for (int u = 0; u < kMarchedWidth; ++u) {
        const bool covered = target.objects()(u, v) != kNoObject;
        pixels += expected.covered(u, v);
        coverage += covered != expected.covered(u, v);
        if (!covered || !expected.covered(u, v)) continue;
        object += target.objects()(u, v) != expected.object(u, v);
        depth += std::abs(eye_z(u, v) - expected.depth(u, v)) > 1e-3f * expected.depth(u, v);
        const glm::vec3 off =
            255.0f * glm::vec3(expected.color(u, v)) - glm::vec3(target.color()(u, v));
        color += glm::length(off) > 2;  // rounded
      }
  }
  EXPECT_GT(pixels, 15000);
  // At edges, where rays pass by within what single precision tells.
  EXPECT_LE(coverage, pixels / 1000);
  EXPECT_LE(object, pixels / 1000);
  EXPECT_LE(depth, pixels / 1000);
  EXPECT_LE(color, pixels / 1000);
}

}  // namespace
}  // namespace rilievo
