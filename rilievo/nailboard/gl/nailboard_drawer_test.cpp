// The GPU against the formulas of nailboard/nailboard.h, pixel by pixel.
#include "rilievo/nailboard/gl/nailboard_drawer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/nailboard/gl/board_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/wall_test_helpers.h"

namespace rilievo {
namespace {

constexpr int kWidth = 96, kHeight = 64;

class NailboardDrawerTest : public gl::ContextTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(ContextTest::SetUp());
    auto made = NailboardDrawer::create();
    ASSERT_TRUE(made.ok()) << made.error().message();
    drawer.emplace(std::move(*made));
    auto target = ProbeTarget::create(kWidth, kHeight);
    ASSERT_TRUE(target.ok()) << target.error().message();
    probe.emplace(std::move(*target));
  }

  std::optional<NailboardDrawer> drawer;
  std::optional<ProbeTarget> probe;
};

struct Expected {
  bool covered = false;
  double depth = 1;
  bool near_an_edge = false;  // of a texel: rounding may pick the neighbour
};

// What the nailboard shows at a pixel, by definition.
Expected at_pixel(const Nailboard& board, const Camera& frame, DepthMode mode, int px, int py) {
  const Camera& c = board.geometry.capture;
  const glm::dvec3 eye = frame.position();
  const glm::dvec3 direction = world_from_raster(frame, {px + 0.5, py + 0.5}, 1) - eye;
  const double t = (board.geometry.plane_z - glm::dot(c.forward(), eye - c.position())) /
                   glm::dot(c.forward(), direction);
  const glm::dvec3 on_polygon = eye + t * direction;
  const glm::dvec3 raster = raster_from_world(c, on_polygon);
  Expected e;
  const auto edge = [](double v) { return std::abs(v - std::round(v)) < 2e-3; };
  e.near_an_edge = edge(raster.x) || edge(raster.y);
  const int x = int(std::floor(raster.x)), y = int(std::floor(raster.y));
  if (x < 0 || y < 0 || x >= c.width || y >= c.height) return e;
  const int bits = board.geometry.delta_bits;
  if (board.delta(x, y) == delta_transparent(bits)) return e;
  e.covered = true;
  const double delta = decode_delta(board.delta(x, y), bits);
  e.depth =
      mode == DepthMode::exact    ? exact_depth(board.geometry, frame, {raster.x, raster.y}, delta)
      : mode == DepthMode::linear ? linear_depth(board.geometry, frame, {raster.x, raster.y}, delta)
                                  : flat_depth(board.geometry, frame, {raster.x, raster.y});
  return e;
}

TEST_F(NailboardDrawerTest, writes_the_depth_that_the_formulas_give) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int bits : {2, 4, 6, 8, 16}) {
    auto atlas = NailboardAtlas::create({64u << 20, bits, 1});
    ASSERT_TRUE(atlas.ok()) << atlas.error().message();
    // Not the first layer: interpolated, its number must not round down.
    for (int layer = 0; layer < 3; ++layer) ASSERT_TRUE(atlas->allocate(1024, 1024));
    for (DepthMode mode : {DepthMode::flat, DepthMode::linear, DepthMode::exact}) {
      const Nailboard board = random_board(rng, bits);
      const auto slot = atlas->allocate(board.color.width(), board.color.height());
      ASSERT_TRUE(slot);
      atlas->write(*slot, board);
      const Camera frame =
          look_at(board.geometry.capture.position() + 0.5 * glm::dvec3(u(rng), u(rng), u(rng)),
                  {0, 0, 0}, {0.05, 1, 0}, 0.5, kWidth, kHeight, 0.5, 20);
      probe->begin();
      NailboardInstance instance{*slot, board.geometry, glm::dmat4(1), 7};
      drawer->draw_objects(*atlas, frame, mode, {&instance, 1});
      ASSERT_TRUE(gl::check_errors("draw").ok());
      const auto objects = probe->read_objects();
      const auto depth = probe->read_eye_z(frame);

      int covered = 0, compared = 0;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          const Expected e = at_pixel(board, frame, mode, x, y);
          if (e.near_an_edge) continue;
          ++compared;
          // Where alpha, interpolated, passes one half next to a transparent texel is the sampler's
          // affair: a texel that is drawn must be covered, not the reverse.
          if (objects(x, y) != kNoObject) {
            ASSERT_TRUE(e.covered) << x << " " << y;
            ++covered;
            const double seen = depth_from_eye_z(DepthKind::window_z, depth(x, y), frame, {});
            // Floats: a few parts in 2^24 of numbers near 1, through one division.
            ASSERT_NEAR(seen, e.depth, 4e-6) << bits << " bits, mode " << int(mode);
          }
        }
      EXPECT_GT(covered, kWidth * kHeight / 4);
      EXPECT_GT(compared, kWidth * kHeight * 9 / 10);
      atlas->free(*slot);
    }
  }
}

TEST_F(NailboardDrawerTest, writes_right_depths_where_the_polygon_reaches_behind_the_eye) {
  auto atlas = NailboardAtlas::create({64u << 20, 8, 1});
  ASSERT_TRUE(atlas.ok());
  std::mt19937 rng(4);
  Nailboard board = random_board(rng, 8);
  // 143 degrees wide; the frame looks 60 degrees to the side: two corners are behind its eye.
  Camera& capture = board.geometry.capture;
  capture.window = {-3, 3, -1, 1};
  capture.z_near = 4, capture.z_far = 8;
  board.geometry = picture_geometry(capture);
  board.geometry.delta_bits = 8;
  const auto slot = atlas->allocate(40, 33);
  atlas->write(*slot, board);
  const NailboardInstance instance{*slot, board.geometry, glm::dmat4(1), 7};
  const glm::dvec3 eye = capture.position() + glm::dvec3(0.1, -0.05, 0.15);
  const glm::dvec3 gaze = 0.5 * capture.forward() + 0.866 * glm::dvec3(capture.world_from_eye[0]);
  const Camera frame = look_at(eye, eye + gaze, {0, 1, 0}, 0.5, kWidth, kHeight, 0.5, 40);
  const glm::dvec3 left_corner = world_from_raster(capture, {0, 0}, board.geometry.plane_z);
  ASSERT_LT(raster_from_world(frame, left_corner).z, 0);
  for (DepthMode mode : {DepthMode::flat, DepthMode::linear, DepthMode::exact}) {
    probe->begin();
    drawer->draw_objects(*atlas, frame, mode, {&instance, 1});
    const auto objects = probe->read_objects();
    const auto depth = probe->read_eye_z(frame);
    int covered = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        if (objects(x, y) == kNoObject) continue;
        const Expected e = at_pixel(board, frame, mode, x, y);
        if (e.near_an_edge) continue;
        ASSERT_TRUE(e.covered) << x << " " << y;
        const double seen = depth_from_eye_z(DepthKind::window_z, depth(x, y), frame, {});
        // As above; eye_z and window_z were rounded once more on the way.
        ASSERT_NEAR(seen, e.depth, 4e-6) << "mode " << int(mode) << " at " << x << " " << y;
        ++covered;
      }
    EXPECT_GT(covered, kWidth * kHeight / 2) << "mode " << int(mode);
  }
}

TEST_F(NailboardDrawerTest, an_object_that_moved_is_an_eye_that_moved_the_other_way) {
  auto atlas = NailboardAtlas::create({64u << 20, 8, 1});
  ASSERT_TRUE(atlas.ok());
  std::mt19937 rng(2);
  const Nailboard board = random_board(rng, 8);
  const auto slot = atlas->allocate(40, 33);
  atlas->write(*slot, board);
  // Powers of two, so that both ways round alike.
  glm::dmat4 motion(1.0);
  motion[3] = {0.25, -0.125, 0.5, 1};
  Camera frame = look_at({0.5, 1, 5}, {0, 0, 0}, {0, 1, 0}, 0.5, kWidth, kHeight, 0.5, 20);
  NailboardInstance instance{*slot, board.geometry, motion, 7};
  probe->begin();
  drawer->draw_objects(*atlas, frame, DepthMode::exact, {&instance, 1});
  const auto moved = probe->read_eye_z(frame);
  frame.world_from_eye = glm::inverse(motion) * frame.world_from_eye;
  instance.world_now_from_capture = glm::dmat4(1);
  probe->begin();
  drawer->draw_objects(*atlas, frame, DepthMode::exact, {&instance, 1});
  const auto still = probe->read_eye_z(frame);
  int same = 0, drawn = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      drawn += still(x, y) != kNoDepth;
      same += moved(x, y) == still(x, y) ||
              std::abs(moved(x, y) - still(x, y)) < 1e-4f;  // floats at 5 m
    }
  EXPECT_GT(drawn, 1000);
  // A pixel centre on a texel's edge may round either way.
  EXPECT_GT(same, kWidth * kHeight - 20);
}

TEST_F(NailboardDrawerTest, shares_of_polygons_and_of_pictures_complement_each_other) {
  // A wall before the eye, and a picture of a wall in the same place.
  Material unlit;
  unlit.unlit = true;
  Scene scene = wall_scene(18, unlit);
  finish(scene);
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  auto atlas = NailboardAtlas::create({64u << 20, 8, 1});
  auto target = FrameTarget::create(kWidth, kHeight, 1);
  ASSERT_TRUE(atlas.ok() && target.ok());
  const Camera frame = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.5, kWidth, kHeight, 0.5, 20);
  Box box;
  box.add(glm::vec3(-9, -9, -0.5f)), box.add(glm::vec3(9, 9, 0.5f));
  Nailboard board;
  Camera capture = *tight_camera(Projection::perspective, {0, 0, 5}, {0, 1, 0}, box);
  capture.width = capture.height = 64;
  board.geometry = picture_geometry(capture);
  board.geometry.delta_bits = 8;
  board.color = Rgba8Image(64, 64, glm::u8vec4(255));
  board.delta = Image<std::uint16_t>(64, 64, 127);
  const auto slot = atlas->allocate(64, 64);
  atlas->write(*slot, board);

  const auto white = [&] {
    target->resolve();
    int count = 0;
    const Rgba8Image image = target->read();
    for (const glm::u8vec4& texel : image.texels()) count += texel.r == 255;
    return count;
  };
  const int all = kWidth * kHeight;
  for (float part : {0.0f, 0.3f, 0.5f, 0.9f}) {
    target->begin();
    const CrossFade polygons{0, 0, part};
    renderer->draw_cross_fades(frame, {&polygons, 1}, OutputEncoding::srgb);
    // The hash is evenly spread: a share of the hash is that share of the pixels, to 1 %.
    EXPECT_NEAR(white(), part * all, 0.01 * all);
    NailboardInstance instance{*slot, board.geometry, glm::dmat4(1), 1, part, 1};
    drawer->draw(*atlas, frame, DepthMode::exact, {&instance, 1});
    EXPECT_EQ(white(), all);
  }
}

// A sample at the edge may be covered though the pixel's centre is not on the polygon.
TEST_F(NailboardDrawerTest, shows_nothing_of_its_neighbours_in_the_atlas) {
  auto atlas = NailboardAtlas::create({64u << 20, 8, 1});
  ASSERT_TRUE(atlas.ok());
  auto target = FrameTarget::create(kWidth, kHeight, 4);
  ASSERT_TRUE(target.ok());
  // Pictures that fill their cells, so that nothing lies between them; the middle one is drawn.
  constexpr int kSize = AtlasAllocator::kCell;
  const Camera camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.4, kSize, kSize, 4, 6);
  Nailboard board;
  board.geometry = picture_geometry(camera);
  board.geometry.delta_bits = 8;
  board.delta = Image<std::uint16_t>(kSize, kSize, std::uint16_t(127));
  std::vector<AtlasSlot> slots;
  for (int i = 0; i < 4 * AtlasAllocator::kCells; ++i) {
    const auto slot = atlas->allocate(kSize, kSize);
    ASSERT_TRUE(slot.has_value());
    board.color = Rgba8Image(kSize, kSize, glm::u8vec4(0, 255, 0, 255));
    atlas->write(*slot, board);
    if (slot->x == 5 * kSize && slot->y == kSize && slot->layer == 0) slots.push_back(*slot);
  }
  ASSERT_EQ(slots.size(), 1u);
  board.color = Rgba8Image(kSize, kSize, glm::u8vec4(255, 0, 0, 255));
  atlas->write(slots[0], board);
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> u(-1, 1);
  int drawn = 0;
  for (int i = 0; i < 50; ++i) {
    const Camera frame = look_at({u(rng), u(rng), 5 + u(rng)}, {0.2 * u(rng), 0.2 * u(rng), 0},
                                 {0.3 * u(rng), 1, 0}, 0.6, kWidth, kHeight, 0.5, 20);
    const NailboardInstance instance{slots[0], board.geometry, glm::dmat4(1), 7};
    for (const DepthMode mode : {DepthMode::flat, DepthMode::linear, DepthMode::exact}) {
      target->begin();
      drawer->draw(*atlas, frame, mode, {&instance, 1});
      target->resolve();
      const Rgba8Image frame_drawn = target->read();
      for (const glm::u8vec4& pixel : frame_drawn.texels()) {
        ASSERT_EQ(pixel.g, 0);
        drawn += pixel.r == 255;
      }
    }
  }
  EXPECT_GT(drawn, 50 * 3 * 500);
}

}  // namespace
}  // namespace rilievo
