// Against the slow drawing (layered_impostor/warp.h); against OpenGL's in
// cache/gl/software_kinds_test.cpp.
#include "rilievo/layered_impostor/cpu/slice_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/core/random.h"
#include "rilievo/layered_impostor/jug_test_helpers.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/layered_impostor/warp.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

constexpr int kSliceFrame = 96;

class SliceTilesTest : public testing::Test {
 protected:
  void SetUp() override {
    impostor = test_shapes::jug_impostor(64, {.layers = 40, .overlap = 0.2f});
    find_fill_slices(impostor, {.size = 48});
  }
  [[nodiscard]] Camera camera_from(const glm::dvec3& towards, double distance) const {
    const glm::dvec3 center(impostor.bounds.center());
    const double radius = double(impostor.bounds.radius());
    return look_at(center + distance * radius * glm::normalize(towards), center, {0.1, 1, 0},
                   2.2 / distance, kSliceFrame, kSliceFrame, 0.3 * radius, 8 * radius);
  }
  // Draws colours, and identifiers.
  [[nodiscard]] static SoftwareTarget drawn(Drawable& drawable, const Camera& camera,
                                            const Instance& instance, int samples) {
    SoftwareTarget target(kSliceFrame, kSliceFrame, samples);
    const TileDrawer* drawers[] = {drawable.tiles()};
    drawable.draw(camera, {&instance, 1}, Output::object_id);
    target.draw_objects(camera.z_far, drawers);
    drawable.draw(camera, {&instance, 1}, Output::color);
    target.draw(camera.z_far, drawers);
    return target;
  }

  LayeredImpostor impostor;
};

TEST_F(SliceTilesTest, slices_are_what_the_slow_drawing_shows) {
  Random random(2);
  int pixels = 0, other_coverage = 0, other_object = 0, other_depth = 0, other_color = 0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 towards(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    const Camera camera = camera_from(towards, 2.5 + 0.3 * i);
    const bool fill = i % 2 == 0;
    const DepthImage expected =
        warp_slices(impostor, slices_for_eye(impostor, camera.position(), fill), camera);
    const Rgba8Image expected_color = encoded_colors(expected.color);
    const auto drawable = make_slice_tiles(
        impostor, {.method = LayeredMethod::slices, .max_views = fill ? 6 : 1, .handover = 0});
    const SoftwareTarget target = drawn(*drawable, camera, {glm::dmat4(1.0), 0, 1}, 1);
    const Image<float> eye_z = target.eye_z();
    for (int y = 0; y < kSliceFrame; ++y)
      for (int x = 0; x < kSliceFrame; ++x) {
        const bool covered = target.objects()(x, y) != kNoObject;
        pixels += expected.covered(x, y);
        other_coverage += covered != expected.covered(x, y);
        if (!covered || !expected.covered(x, y)) continue;
        other_object += target.objects()(x, y) != expected.object(x, y);
        other_depth += std::abs(eye_z(x, y) - expected.depth(x, y)) > 1e-4f;
        for (int c = 0; c < 3; ++c)
          if (std::abs(int(target.color()(x, y)[c]) - int(expected_color(x, y)[c])) > 2) {
            ++other_color;
            break;
          }
      }
  }
  EXPECT_GT(pixels, 10000);
  // A texel's end may fall on the other side of a slice's, of which 16 bits are known.
  EXPECT_LE(other_coverage, pixels / 500);
  EXPECT_LE(other_object, pixels / 500);
  EXPECT_LE(other_depth, pixels / 500);
  EXPECT_LE(other_color, pixels / 500);
}

// Moved, turned and twice as large, seen by an eye that stands as it did.
TEST_F(SliceTilesTest, an_impostor_that_moved_is_an_eye_that_moved_the_other_way) {
  const auto drawable = make_slice_tiles(impostor, {.method = LayeredMethod::slices});
  const Camera camera = camera_from({0.3, 0.4, 1}, 3);
  const glm::dmat4 turn = glm::rotate(glm::translate(glm::dmat4(1), {3, -1, 2}), 0.7,
                                      glm::normalize(glm::dvec3(1, 2, 3)));
  Camera moved = camera;
  moved.world_from_eye = turn * camera.world_from_eye;
  moved.world_from_eye[3] =
      turn * glm::scale(glm::dmat4(1), glm::dvec3(2)) * camera.world_from_eye[3];
  moved.z_near *= 2, moved.z_far *= 2;
  const Instance instance{turn * glm::scale(glm::dmat4(1), glm::dvec3(2)), 0, 1};
  const SoftwareTarget a = drawn(*drawable, camera, {glm::dmat4(1.0), 0, 1}, 4),
                       b = drawn(*drawable, moved, instance, 4);
  int shown = 0, other = 0;
  for (std::size_t i = 0; i < a.color().texels().size(); ++i) {
    shown += a.objects().texels()[i] != kNoObject;
    other += a.color().texels()[i] != b.color().texels()[i] ||
             std::abs(2 * b.inverse_z().texels()[i] - a.inverse_z().texels()[i]) > 1e-4f;
  }
  EXPECT_GT(shown, 1000);
  EXPECT_LE(other, shown / 100);  // rounded to the other side of a texel's edge
}

}  // namespace
}  // namespace rilievo
