#include "rilievo/keyframes/keyframe_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/capture/forwarding_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/color.h"
#include "rilievo/core/random.h"
#include "rilievo/keyframes/make_keyframe.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {
namespace {

const glm::vec3 kShade(0.25f, 0.4f, 0.6f);

// In the shadow of something that rays do not know, left of x = 0.
glm::vec3 light_at(const glm::dvec3& place) { return place.x < 0 ? kShade : glm::vec3(1); }

// Rays with that shadow.
class Shadowed final : public ForwardingSource {
 public:
  using ForwardingSource::ForwardingSource;
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    Result<CapturedPicture> captured = source_.capture(request);
    if (!captured) return captured;
    DepthImage& picture = captured->picture;
    for (int y = 0; y < picture.camera.height; ++y)
      for (int x = 0; x < picture.camera.width; ++x) {
        if (!picture.covered(x, y)) continue;
        const glm::dvec3 place =
            world_from_raster(picture.camera, {x + 0.5, y + 0.5}, picture.depth(x, y));
        picture.color(x, y) *= glm::vec4(light_at(place), 1);
      }
    return captured;
  }
};

// A wall with posts before it, of other colours.
struct LightStage {
  Scene scene;
  std::optional<RayScene> rays;
  std::optional<RaySource> plain, again;
  std::optional<Shadowed> shadowed;

  LightStage() {
    add({0, 0, -10}, {30, 20, 1}, {0.6f, 0.5f, 0.4f});
    for (int i = -6; i <= 6; ++i)
      add({1.5f * float(i) + 0.75f, 0, -5}, {0.2f, 20, 0.2f}, {0.2f, 0.6f, 0.3f});
    Light sun;
    sun.direction = glm::normalize(glm::vec3(0.3f, -0.5f, -1));
    scene.lights.push_back(sun);
    finish(scene);
    rays.emplace(*RayScene::create(scene));
    plain.emplace(*rays), again.emplace(*rays);
    shadowed.emplace(*plain);
  }
  void add(const glm::vec3& center, const glm::vec3& half, const glm::vec3& color) {
    test_shapes::add(scene, test_shapes::box(half), color, glm::translate(glm::mat4(1), center));
  }
  [[nodiscard]] static Camera eye_at(double x, int width = 320, int height = 200) {
    const glm::dvec3 eye(x, 0.4, 0);
    return look_at(eye, eye + glm::dvec3(0.1, 0, -1), {0, 1, 0}, 0.9, width, height, 0.1, 100);
  }
  [[nodiscard]] Keyframe keyframe_at(double x) {
    KeyframeRequest request;
    request.camera = eye_at(x);
    request.light_rays = &*again;
    return *make_keyframe(*shadowed, request);
  }
};

std::uint32_t bytes_of(const glm::vec3& linear) {
  std::uint32_t bytes = 0xFF000000u;
  for (int c = 0; c < 3; ++c)
    bytes |= std::uint32_t(srgb_from_linear(std::clamp(linear[c], 0.0f, 1.0f)) * 255 + 0.5f)
             << (8 * c);
  return bytes;
}

TEST(KeyframeLight, CellsHaveTheSourcesLightAndThatOfRays) {
  LightStage stage;
  const Keyframe key = stage.keyframe_at(0.3);
  ASSERT_EQ(key.light.cells.width(), 160);
  ASSERT_EQ(key.light.cells.height(), 100);
  int lit = 0, shaded = 0;
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 160; ++x) {
      const LightCell& cell = key.light.cells(x, y);
      if (cell.object == kNoObject) continue;
      // The cell's texels show the wall, on one side of the shadow's edge. Faces of a post, which
      // have several colours, may share a cell.
      bool whole = cell.object == 1, left = false, right = false;
      for (int i = 0; i < 4; ++i) {
        const int tx = 2 * x + i % 2, ty = 2 * y + i / 2;
        whole = whole && key.object(tx, ty) == cell.object;
        if (!(key.inverse_z(tx, ty) > 0)) continue;
        const glm::dvec3 place =
            world_from_raster(key.camera, {tx + 0.5, ty + 0.5}, 1 / key.inverse_z(tx, ty));
        left = left || place.x < 0.1, right = right || place.x > -0.1;
      }
      if (!whole || left == right) continue;
      (left ? shaded : lit) += 1;
      const glm::vec3 expected = cell.rays * (left ? kShade : glm::vec3(1));
      // Bytes, of which a step is 0.009 in the brightest colours.
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(cell.source[c], expected[c], 0.01) << x << ' ' << y;
    }
  EXPECT_GT(lit, 3000);
  EXPECT_GT(shaded, 3000);
}

// What is brighter than white is white in a keyframe, and by rays; so is nothing but a number.
TEST(KeyframeLight, OverexposedSurfacesStayAsTheyAre) {
  LightStage stage;
  stage.scene.lights[0].intensity = glm::vec3(40);
  stage.rays.emplace(*RayScene::create(stage.scene));
  KeyframeRequest request;
  request.camera = LightStage::eye_at(3);
  request.light_rays = &*stage.again;
  const Keyframe key = *make_keyframe(*stage.plain, request);
  const WarpedKeyframe warped[] = {{&key}};
  Relight light;
  light.begin(warped, request.camera);
  int white = 0;
  for (int y = 10; y < 190; y += 7)
    for (int x = 10; x < 310; x += 7) {
      const std::uint32_t color = key.color(2 * x, 2 * y) | 0xFF000000u;
      if (key.object(x, y) == kNoObject || (color & 0xFFFFFFu) != 0xFFFFFFu) continue;
      ++white;
      const std::uint32_t shown = light.shown(float(x) + 0.5f, float(y) + 0.5f, key.inverse_z(x, y),
                                              key.object(x, y) - 1, color);
      // Cells at edges have the mean of what is there. With radiance above 1 it was 120 and less.
      for (int c = 0; c < 24; c += 8) EXPECT_GE(shown >> c & 255, 250u);
    }
  EXPECT_GT(white, 100);
}

// As the second keyframe becomes one to spare, what is shown does not change.
TEST(KeyframeLight, AKeyframeToSpareTellsOnlyWhatNoOtherDoes) {
  LightStage stage;
  KeyframeRequest request;
  request.camera = LightStage::eye_at(0.6);
  request.light_rays = &*stage.again;
  const Keyframe plain = *make_keyframe(*stage.plain, request), shadowed = stage.keyframe_at(0.5);
  const WarpedKeyframe with[] = {{&shadowed, 1}, {&plain, 0.4f, true}}, alone[] = {{&shadowed, 1}},
                       spare[] = {{&plain, 0.4f, true}};
  Relight both, one, other;
  both.begin(with, request.camera), one.begin(alone, request.camera);
  other.begin(spare, request.camera);
  const std::uint32_t color = 0xFF808080u;
  for (int y = 20; y < 180; y += 5)
    for (int x = 20; x < 300; x += 5) {
      const float w = plain.inverse_z(x, y);
      const auto shown = [&](const Relight& light) {
        return light.shown(float(x) + 0.5f, float(y) + 0.5f, w, plain.object(x, y) - 1, color);
      };
      for (int c = 0; c < 24; c += 8)
        EXPECT_NEAR(int(shown(both) >> c & 255), int(shown(one) >> c & 255), 1);
      // Alone it tells all: rays' own light, but for the means of cells at edges.
      for (int c = 0; c < 24; c += 8) EXPECT_NEAR(int(shown(other) >> c & 255), 0x80, 8);
    }
}

TEST(KeyframeLight, ASourceThatKnowsNoMoreHasNone) {
  LightStage stage;
  KeyframeRequest request;
  request.camera = LightStage::eye_at(0);
  const Keyframe key = *make_keyframe(*stage.plain, request);
  EXPECT_TRUE(key.light.cells.empty());
  // Nor has one that takes the memory of another with light.
  KeyframeMaker maker;
  maker.begin(request, stage.keyframe_at(0.1));
  ASSERT_TRUE(maker.step(*stage.plain, 1 << 20));
  EXPECT_TRUE(maker.take().light.cells.empty());
  Relight light;
  const WarpedKeyframe warped[] = {{&key}};
  light.begin(warped, request.camera);
  EXPECT_FALSE(light.any());
}

// All cells of a keyframe, whether they are in reach, in double precision.
glm::dvec3 factor_by_all_cells(std::span<const Keyframe> keys, const glm::dvec3& place,
                               std::uint32_t object, const glm::dvec3& color) {
  glm::dvec3 source(0), rays(0);
  for (const Keyframe& key : keys) {
    const KeyframeLight& light = key.light;
    const glm::dvec3 raster = raster_from_world(light.camera, place);
    if (!(raster.z > 0)) continue;
    const int width = light.cells.width(), height = light.cells.height();
    const int cx = int(std::clamp(raster.x, 0.0, width - 1.0)),
              cy = int(std::clamp(raster.y, 0.0, height - 1.0));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const int dx = std::abs(x - cx), dy = std::abs(y - cy);
        const bool fine = std::max(dx, dy) <= 2;
        const bool far = dx % 4 == 0 && dy % 4 == 0 && std::max(dx, dy) <= 8 && dx + dy > 0;
        const LightCell& cell = light.cells(x, y);
        if ((!fine && !far) || cell.object == kNoObject) continue;
        const glm::dvec3 cell_color(cell.rays);
        const double unlike =
            0.01 +
            std::pow(glm::length(cell_color - color) / glm::length(cell_color + color + 0.02), 2);
        const double counts =
            (cell.object == object + 1 ? 1 : 0.02) / unlike / (4 + dx * dx + dy * dy);
        source += counts * glm::dvec3(cell.source), rays += counts * glm::dvec3(cell.rays);
      }
  }
  const double black = 0.005 * std::max({rays.x, rays.y, rays.z});
  return glm::min((source + black) / (rays + black), glm::dvec3(4));
}

TEST(KeyframeLight, WhatRaysFindIsShownInTheLightOfTheCellsAroundIt) {
  LightStage stage;
  std::vector<Keyframe> keys;
  keys.push_back(stage.keyframe_at(-0.5)), keys.push_back(stage.keyframe_at(0.6));
  const WarpedKeyframe warped[] = {{&keys[0]}, {&keys[1]}};
  Random random(7);
  int count = 0, far = 0, wrong = 0;
  for (int i = 0; i < 4000; ++i) {
    const Camera frame = LightStage::eye_at(random.between(-2, 2), 100, 60);
    Relight light;
    light.begin(warped, frame);
    ASSERT_TRUE(light.any());
    const glm::ivec2 pixel(int(random.between(0, 100)), int(random.between(0, 60)));
    CaptureRequest request;
    request.camera = camera_of_part(frame, pixel.x, pixel.y, 1, 1), request.samples = 1;
    const DepthImage seen = stage.again->capture(request)->picture;
    if (!seen.covered(0, 0)) continue;
    const double z = seen.depth(0, 0);
    const glm::dvec2 raster(pixel.x + 0.5, pixel.y + 0.5);
    const glm::dvec3 place = world_from_raster(frame, raster, z);
    const std::uint32_t by_rays = bytes_of(glm::vec3(seen.color(0, 0))),
                        object = seen.object(0, 0) - 1;
    const std::uint32_t shown =
        light.shown(float(raster.x), float(raster.y), float(1 / z), object, by_rays);
    ASSERT_EQ(shown >> 24, by_rays >> 24);
    glm::dvec3 linear;
    for (int c = 0; c < 3; ++c) linear[c] = linear_of_srgb_bytes()[by_rays >> (8 * c) & 255];
    const std::uint32_t expected =
        bytes_of(glm::vec3(linear * factor_by_all_cells(keys, place, object, linear)));
    const std::uint32_t truth = bytes_of(glm::vec3(linear) * light_at(place));
    ++count;
    // A place on the border of two cells is of either; colours come in steps.
    bool apart = false;
    for (int c = 0; c < 24; c += 8)
      apart = apart || std::abs(int(shown >> c & 255) - int(expected >> c & 255)) > 1;
    far += apart;
    // Within half a metre of the edge the light is a mean.
    if (std::abs(place.x) < 0.5) continue;
    for (int c = 0; c < 24; c += 8)
      if (std::abs(int(shown >> c & 255) - int(truth >> c & 255)) > 16) {
        ++wrong;
        break;
      }
  }
  EXPECT_GT(count, 3500);
  EXPECT_LT(far, count / 50);
  EXPECT_LT(wrong, count / 50);
}

}  // namespace
}  // namespace rilievo
