#include "rilievo/environment_nodes/environment_drawable.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/environment_nodes/gl/node_textures.h"
#include "rilievo/environment_nodes/node_test_helpers.h"
#include "rilievo/environment_nodes/software/node_tiles.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

constexpr int kWidth = 96, kHeight = 64;

class EnvironmentDrawing : public gl::ContextTest {
 protected:
  void TearDown() override { EXPECT_TRUE(gl::check_errors("environment drawable").ok()); }
};

// A room around the origin, seen from `eye`; the wall at +x is object 2, all else 1.
DistanceAlong room_from(const glm::dvec3& eye) {
  return box_around(glm::dvec3(-4, -2, -3) - eye, glm::dvec3(4, 2, 3) - eye);
}
EnvironmentNodes room_nodes(const std::vector<glm::dvec3>& eyes, int size = 32,
                            bool with_objects = true) {
  std::vector<DepthImage> pictures;
  for (const glm::dvec3& eye : eyes) {
    EnvironmentMap map = make_node(
        size, room_from(eye),
        [&](const glm::dvec3& d, double distance) {
          const glm::vec3 at(eye + distance * d);
          return glm::vec4(0.5f + 0.1f * glm::sin(at), 1.0f);
        },
        eye);
    for (DepthImage& face : map.faces) {
      if (with_objects) face.object = Image<std::uint32_t>(size, size, 1u);
      for (int y = 0; with_objects && y < size; ++y)
        for (int x = 0; x < size; ++x)
          if (world_from_raster(face.camera, {x + 0.5, y + 0.5}, double(face.depth(x, y))).x > 3.99)
            face.object(x, y) = 2;
      pictures.push_back(std::move(face));
    }
  }
  return *make_environment_nodes(std::move(pictures), {});
}

std::vector<glm::dvec3> grid_of_eyes(int count) {
  std::vector<glm::dvec3> eyes;
  for (int i = 0; i < count; ++i)
    eyes.emplace_back(-3.5 + 7.0 * (i % 8) / 7, 0, -2 + 4.0 * (i / 8) / std::max(1, count / 8 - 1));
  return eyes;
}

TEST_F(EnvironmentDrawing, at_most_four_of_thirty_two_nodes_are_in_memory) {
  Result<NodeDrawer> drawer = NodeDrawer::create();
  ASSERT_TRUE(drawer.ok());
  Result<FrameTarget> target = FrameTarget::create(kWidth, kHeight, 1);
  ASSERT_TRUE(target.ok());
  EnvironmentDrawable nodes(room_nodes(grid_of_eyes(32), 16),
                            std::make_unique<NodeTextures>(*drawer), {});
  const Instance instance;
  std::vector<Rgba8Image> first;
  // The same walk twice: what is drawn follows from the eye, not from what was loaded before.
  for (int pass = 0; pass < 2; ++pass)
    for (int i = 0; i < 40; ++i) {
      const int step = pass == 0 ? i : 39 - i;
      const double x = -3.4 + 6.8 * step / 39;
      const Camera frame = look_at({x, 0.1, 1.5 * std::sin(step)}, {x + 1, 0, 0}, {0, 1, 0}, 1.0,
                                   kWidth, kHeight, 0.05, 50);
      target->begin();
      nodes.draw(frame, {&instance, 1}, Output::color);
      target->resolve();
      Rgba8Image picture = target->read();
      if (pass == 0)
        first.push_back(std::move(picture));
      else
        EXPECT_EQ(picture, first[std::size_t(step)]) << step;
    }
  EXPECT_EQ(nodes.most_in_memory(), 4u);
  EXPECT_FALSE(nodes.error().has_value());
}

TEST_F(EnvironmentDrawing, identifiers_are_those_of_what_is_seen) {
  Result<NodeDrawer> drawer = NodeDrawer::create();
  ASSERT_TRUE(drawer.ok());
  Result<ProbeTarget> target = ProbeTarget::create(kWidth, kHeight);
  ASSERT_TRUE(target.ok());
  EnvironmentDrawable nodes(room_nodes({{0, 0, 0}, {1, 0.5, -1}}, 64),
                            std::make_unique<NodeTextures>(*drawer), {});
  const Camera frame =
      look_at({0.5, 0.2, 0.3}, {4, 0.3, 1.9}, {0, 1, 0}, 1.0, kWidth, kHeight, 0.05, 50);
  for (const std::uint32_t asked : {std::uint32_t(kNoObject), 7u}) {
    Instance instance;
    instance.object = asked;
    target->begin();
    nodes.draw(frame, {&instance, 1}, Output::object_id);
    const Image<std::uint32_t> shown = target->read_objects();
    int wrong = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const glm::dvec3 eye = frame.position();
        const glm::dvec3 to = world_from_raster(frame, {x + 0.5, y + 0.5}, 1.0) - eye;
        const bool wall = (eye + room_from(eye)(to) * to).x > 3.99;
        wrong += shown(x, y) != (asked != kNoObject ? asked : wall ? 2u : 1u);
      }
    // Along the wall's edge within a texel, 1.4 degrees of 57 over 64 pixels.
    EXPECT_LT(wrong, 4 * kHeight);
  }
}

// Which of the node's six faces shows what a frame's pixel shows of the room? Its forward axis.
glm::ivec3 face_at(const Camera& frame, const glm::dvec3& node, double x, double y) {
  const glm::dvec3 eye = frame.position();
  const glm::dvec3 to = world_from_raster(frame, {x, y}, 1.0) - eye;
  const glm::dvec3 from_node = eye + room_from(eye)(to) * to - node;
  const glm::dvec3 size = glm::abs(from_node);
  const int axis = size.x > std::max(size.y, size.z) ? 0 : size.y > size.z ? 1 : 2;
  glm::ivec3 forward(0);
  forward[axis] = from_node[axis] > 0 ? 1 : -1;
  return forward;
}

TEST_F(EnvironmentDrawing, outlines_lie_where_the_six_pictures_of_a_node_meet) {
  Result<NodeDrawer> drawer = NodeDrawer::create();
  ASSERT_TRUE(drawer.ok());
  Result<FrameTarget> target = FrameTarget::create(kWidth, kHeight, 1);
  ASSERT_TRUE(target.ok());
  const glm::dvec3 node(0.7, 0.2, -0.4);
  const Camera frame =
      look_at({-1.5, 0.6, 1}, {4, -0.7, -1.5}, {0, 1, 0}, 1.2, kWidth, kHeight, 0.05, 50);
  EnvironmentDrawable by_opengl(room_nodes({node}, 64), std::make_unique<NodeTextures>(*drawer),
                                {});
  EnvironmentDrawable by_software(room_nodes({node}, 64), std::make_unique<NodeTiles>(), {});
  const Instance instance;
  const auto opengl = [&](bool outlines) {
    target->begin();
    by_opengl.draw(frame, {&instance, 1}, Output::color);
    if (outlines) by_opengl.draw_outlines(frame, {&instance, 1});
    target->resolve();
    return target->read();
  };
  SoftwareTarget memory(kWidth, kHeight, 1);
  const auto software = [&](bool outlines) {
    by_software.draw(frame, {&instance, 1}, Output::color);
    if (outlines) by_software.draw_outlines(frame, {&instance, 1});
    const TileDrawer* const drawers[] = {by_software.tiles(), by_software.outline_tiles()};
    memory.draw(frame.z_far, std::span(drawers).first(outlines ? 2 : 1));
    return memory.color();
  };
  for (const bool gl : {true, false}) {
    SCOPED_TRACE(gl ? "OpenGL" : "software");
    const Rgba8Image plain = gl ? opengl(false) : software(false),
                     outlined = gl ? opengl(true) : software(true);
    int lines = 0, astray = 0, borders = 0, missed = 0;
    for (int y = 2; y + 2 < kHeight; ++y)
      for (int x = 2; x + 2 < kWidth; ++x) {
        const auto changed = [&](int u, int v) { return outlined(u, v) != plain(u, v); };
        bool border = false, line_beside = false;
        for (int k = 0; k < 9; ++k) {
          const int dx = k % 3 - 1, dy = k / 3 - 1;
          border |= face_at(frame, node, x + 0.5 + 1.5 * dx, y + 0.5 + 1.5 * dy) !=
                    face_at(frame, node, x + 0.5, y + 0.5);
          line_beside |= changed(x + dx, y + dy);
        }
        // A border lies between this pixel and the next.
        const bool crossed =
            face_at(frame, node, x + 1.5, y + 0.5) != face_at(frame, node, x + 0.5, y + 0.5);
        lines += changed(x, y), astray += changed(x, y) && !border;
        borders += crossed, missed += crossed && !line_beside;
      }
    EXPECT_GT(lines, 100);
    EXPECT_GT(borders, 40);
    EXPECT_EQ(astray, 0);
    EXPECT_EQ(missed, 0);
  }
}

TEST_F(EnvironmentDrawing, outlines_of_a_node_end_where_something_is_nearer) {
  SoftwareTarget memory(kWidth, kHeight, 1);
  EnvironmentDrawable nodes(room_nodes({{0, 0, 0}}, 64), std::make_unique<NodeTiles>(), {});
  const Camera frame =
      look_at({-1.5, 0.6, 1}, {4, -0.7, -1.5}, {0, 1, 0}, 1.2, kWidth, kHeight, 0.05, 50);
  struct Wall final : TileDrawer {
    void draw_tile(FrameTile& tile) const override {
      for (int block = 0; block < FrameTile::kBlockCount; ++block)
        for (int s = 0; s < tile.planes(block); ++s)
          for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
            FrameTile::Plane& plane = tile.plane(block, s);
            plane.inverse_z[i] = 2, plane.content[i] = 0xff808080u;
          }
    }
  } wall;
  const Instance instance;
  nodes.draw(frame, {&instance, 1}, Output::color);
  nodes.draw_outlines(frame, {&instance, 1});
  const TileDrawer* const drawers[] = {nodes.tiles(), &wall, nodes.outline_tiles()};
  memory.draw(frame.z_far, drawers);
  for (const glm::u8vec4& pixel : memory.color().texels())
    ASSERT_EQ(pixel, glm::u8vec4(128, 128, 128, 255));
}

// Moved, turned and scaled as a whole, with the eye along, a frame stays what it was.
TEST_F(EnvironmentDrawing, an_instance_is_drawn_where_it_was_moved_to) {
  Result<NodeDrawer> drawer = NodeDrawer::create();
  ASSERT_TRUE(drawer.ok());
  Result<FrameTarget> target = FrameTarget::create(kWidth, kHeight, 1);
  ASSERT_TRUE(target.ok());
  EnvironmentDrawable nodes(room_nodes({{0, 0, 0}, {1, 0.5, -1}}),
                            std::make_unique<NodeTextures>(*drawer), {});
  const Camera frame =
      look_at({0.5, 0.2, 0.3}, {3, -0.3, 2}, {0, 1, 0}, 1.0, kWidth, kHeight, 0.05, 50);
  const auto picture = [&](const Camera& from, const glm::dmat4& motion) {
    Instance instance;
    instance.world_from_capture = motion;
    target->begin();
    nodes.draw(from, {&instance, 1}, Output::color);
    target->resolve();
    return target->read();
  };
  const Rgba8Image still = picture(frame, glm::dmat4(1));
  const double scale = 2.5, c = std::cos(0.7), s = std::sin(0.7);
  glm::dmat4 motion(glm::dvec4(scale * c, 0, scale * s, 0), glm::dvec4(0, scale, 0, 0),
                    glm::dvec4(-scale * s, 0, scale * c, 0), glm::dvec4(10, -3, 5, 1));
  Camera moved = frame;
  moved.world_from_eye = motion * frame.world_from_eye;
  for (int k = 0; k < 3; ++k) moved.world_from_eye[k] /= scale;
  moved.z_near *= scale, moved.z_far *= scale;
  const Rgba8Image with_motion = picture(moved, motion);
  int differ = 0;
  for (std::size_t i = 0; i < still.texels().size(); ++i)
    for (int k = 0; k < 3; ++k)
      differ += std::abs(int(still.texels()[i][k]) - int(with_motion.texels()[i][k])) > 2;
  // Rounding moves the edges of triangles by less than a pixel.
  EXPECT_LT(differ, kWidth * kHeight / 50);
}

TEST_F(EnvironmentDrawing, the_bound_is_known_before_anything_is_drawn_and_none_at_a_node) {
  Result<NodeDrawer> drawer = NodeDrawer::create();
  ASSERT_TRUE(drawer.ok());
  EnvironmentDrawable nodes(room_nodes({{0, 0, 0}, {1, 0.5, -1}}),
                            std::make_unique<NodeTextures>(*drawer), {});
  const ErrorModel model = nodes.error_model(0);
  const Camera frame =
      look_at({0.5, 0.2, 0.3}, {3, -0.3, 2}, {0, 1, 0}, 1.0, kWidth, kHeight, 0.05, 50);
  const double there = model.bound_px(glm::dmat4(1), frame);
  EXPECT_TRUE(std::isfinite(there));
  EXPECT_GT(there, 0);
  Camera at_node = frame;
  at_node.world_from_eye[3] = glm::dvec4(0, 0, 0, 1);
  EXPECT_EQ(model.bound_px(glm::dmat4(1), at_node), 0);
}

}  // namespace
}  // namespace rilievo
