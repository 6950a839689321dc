// Against the slow drawing (layered_impostor/warp.h); against OpenGL's in
// cache/gl/software_kinds_test.cpp.
#include "rilievo/layered_impostor/software/slice_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/core/random.h"
#include "rilievo/layered_impostor/jug_test_helpers.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/layered_impostor/software/layered_tiles.h"
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

  [[nodiscard]] static glm::dvec3 random_direction(Random& random) {
    const float x = random.between(-1, 1), y = random.between(-1, 1), z = random.between(-1, 1);
    return {x, y, z};
  }

  struct Differences {
    int pixels = 0, coverage = 0, object = 0, depth = 0, color = 0;
  };
  // With the slow drawing, from one eye.
  void compare(const Camera& camera, bool fill, Differences& found) const {
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
        found.pixels += expected.covered(x, y);
        found.coverage += covered != expected.covered(x, y);
        if (!covered || !expected.covered(x, y)) continue;
        found.object += target.objects()(x, y) != expected.object(x, y);
        found.depth += std::abs(eye_z(x, y) - expected.depth(x, y)) > 1e-4f;
        for (int c = 0; c < 3; ++c)
          if (std::abs(int(target.color()(x, y)[c]) - int(expected_color(x, y)[c])) > 2) {
            ++found.color;
            break;
          }
      }
  }
  // A texel's end may fall on the other side of a slice's, of which 16 bits are known.
  static void expect_few(const Differences& found) {
    EXPECT_LE(found.coverage, found.pixels / 500);
    EXPECT_LE(found.object, found.pixels / 500);
    EXPECT_LE(found.depth, found.pixels / 500);
    EXPECT_LE(found.color, found.pixels / 500);
  }

  LayeredImpostor impostor;
};

TEST_F(SliceTilesTest, slices_are_what_the_slow_drawing_shows) {
  Random random(2);
  Differences found;
  for (int i = 0; i < 8; ++i)
    compare(camera_from(random_direction(random), 2.5 + 0.3 * i), i % 2 == 0, found);
  EXPECT_GT(found.pixels, 10000);
  expect_few(found);
}

// Slices reach behind the eye, and their corners in front of it tell little of where they are.
TEST_F(SliceTilesTest, slices_around_the_eye_are_what_the_slow_drawing_shows) {
  Random random(3);
  Differences found;
  for (int i = 0; i < 8; ++i) {
    Camera camera = camera_from(random_direction(random), 1.1);
    camera.z_near = 1e-3 * camera.z_far;
    compare(camera, i % 2 == 0, found);
  }
  EXPECT_GT(found.pixels, 5000);
  expect_few(found);
}

TEST_F(SliceTilesTest, nothing_is_drawn_before_the_near_plane) {
  const auto drawable = make_slice_tiles(impostor, {.method = LayeredMethod::slices});
  Camera camera = camera_from({0.3, 0.4, 1}, 2.5);
  const auto drawn_with = [&](double z_near) {
    camera.z_near = z_near;
    return drawn(*drawable, camera, {glm::dmat4(1.0), 0, 1}, 1);
  };
  const double all = camera.z_near, middle = 2.3 * double(impostor.bounds.radius());
  const SoftwareTarget whole = drawn_with(all), cut = drawn_with(middle);
  const Image<float> before = whole.eye_z(), after = cut.eye_z();
  int kept = 0, gone = 0, behind = 0;
  for (std::size_t i = 0; i < before.texels().size(); ++i) {
    const float was = before.texels()[i], is = after.texels()[i];
    if (was == kNoDepth) continue;
    if (double(was) >= middle) {
      ++kept;
      EXPECT_EQ(is, was);
      EXPECT_EQ(cut.color().texels()[i], whole.color().texels()[i]);
      continue;
    }
    ++(is == kNoDepth ? gone : behind);
    EXPECT_GE(double(is), middle * (1 - 1e-6));
  }
  EXPECT_GT(kept, 100);
  EXPECT_GT(gone, 10);
  EXPECT_GT(behind, 100);
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

// By slices and by surfaces.
TEST(ImpostorTiles, an_instance_without_an_identifier_has_that_of_the_only_object) {
  LayeredImpostor impostor = test_shapes::jug_impostor(32);
  for (DepthImage& picture : impostor.pictures)
    for (std::uint32_t& object : picture.object.texels())
      if (object != kNoObject) object = 7;
  const Camera camera =
      look_at({0, 0.5, 3}, impostor.bounds.center(), {0, 1, 0}, 1, 64, 64, 0.5, 10);
  for (const std::uint32_t named : {kNoObject, 3u})
    for (const auto& drawable : {make_slice_tiles(impostor, {.method = LayeredMethod::slices}),
                                 make_layered_tiles(impostor, {})}) {
      const Instance instance{glm::dmat4(1.0), 0, named};
      SoftwareTarget target(64, 64, 1);
      const TileDrawer* drawers[] = {drawable->tiles()};
      drawable->draw(camera, {&instance, 1}, Output::object_id);
      target.draw_objects(camera.z_far, drawers);
      int shown = 0;
      for (const std::uint32_t object : target.objects().texels()) {
        if (object == kNoObject) continue;
        ++shown;
        EXPECT_EQ(object, named == kNoObject ? 7u : named);
      }
      EXPECT_GT(shown, 500);
    }
}

}  // namespace
}  // namespace rilievo
