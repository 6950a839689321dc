#include "rilievo/environment_nodes/gl/node_drawer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/error.h"
#include "rilievo/environment_nodes/node_test_helpers.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {
namespace {

constexpr int kNodeWidth = 160, kNodeHeight = 90;

// Colours that tell directions apart, smooth enough to be interpolated.
glm::vec4 painted(const glm::dvec3& d, double) {
  const glm::dvec3 u = glm::normalize(d);
  const auto wave = [](double x) { return float(0.5 + 0.4 * std::sin(7 * x)); };
  return {wave(u.x), wave(u.y + 1), wave(u.z + 2), 1};
}

Camera random_frame(Random& random, const glm::dvec3& eye) {
  const auto in = [&] { return double(random.between(-1, 1)); };
  return look_at(eye, eye + glm::dvec3(in(), in(), in()) + 1e-3, {0, 1, 0}, 0.9, kNodeWidth,
                 kNodeHeight, 0.01, 100);
}

double psnr(const Rgba8Image& a, const std::function<glm::vec3(int, int)>& truth) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const glm::vec3 t = truth(x, y);
      for (int k = 0; k < 3; ++k) {
        const double off = double(a(x, y)[k]) - 255.0 * double(t[k]);
        sum += off * off;
      }
    }
  return 10 * std::log10(255 * 255 / std::max(1e-9, sum / (3.0 * a.width() * a.height())));
}

class NodeDrawing : public gl::ContextTest {
 protected:
  void SetUp() override {
    gl::ContextTest::SetUp();
    Result<NodeDrawer> drawer = NodeDrawer::create();
    ASSERT_TRUE(drawer.ok()) << drawer.error().message();
    drawer_.emplace(std::move(*drawer));
    Result<FrameTarget> target = FrameTarget::create(kNodeWidth, kNodeHeight, 1);
    ASSERT_TRUE(target.ok());
    target_.emplace(std::move(*target));
    directions_ = gl::make_texture_2d(GL_RGBA32F, kNodeWidth, kNodeHeight);
    depth_ = gl::make_texture_2d(GL_DEPTH_COMPONENT32F, kNodeWidth, kNodeHeight);
    probe_ = gl::make_framebuffer();
    glNamedFramebufferTexture(probe_, GL_COLOR_ATTACHMENT0, directions_, 0);
    glNamedFramebufferTexture(probe_, GL_DEPTH_ATTACHMENT, depth_, 0);
  }
  void TearDown() override {
    EXPECT_TRUE(gl::check_errors("node drawer").ok());
    drawer_.reset();
    target_.reset();
    directions_ = {}, depth_ = {}, probe_ = {};
  }

  Rgba8Image draw(const Camera& frame, std::vector<const StoredNode*> nodes,
                  const NodeDrawOptions& options) {
    target_->begin();
    const GLfloat magenta[] = {1, 0, 1, 1};
    glClearNamedFramebufferfv(target_->framebuffer(), GL_COLOR, 0, magenta);
    const Result<> drawn = drawer_->draw(frame, nodes, options);
    EXPECT_TRUE(drawn.ok());
    target_->resolve();
    return target_->read();
  }

  // Row 0 on top; w is 0 where nothing was drawn.
  Image<glm::vec4> directions(const Camera& frame, const StoredNode& node, bool skin) {
    glBindFramebuffer(GL_FRAMEBUFFER, probe_);
    glViewport(0, 0, kNodeWidth, kNodeHeight);
    const GLfloat nothing[] = {0, 0, 0, 0}, far = 1;
    glClearNamedFramebufferfv(probe_, GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(probe_, GL_DEPTH, 0, &far);
    drawer_->draw_directions(frame, node, skin);
    Image<glm::vec4> image(kNodeWidth, kNodeHeight);
    glReadPixels(0, 0, kNodeWidth, kNodeHeight, GL_RGBA, GL_FLOAT, image.texels().data());
    for (int y = 0; y < kNodeHeight / 2; ++y)
      std::swap_ranges(image.row(y).begin(), image.row(y).end(),
                       image.row(kNodeHeight - 1 - y).begin());
    return image;
  }

  std::optional<NodeDrawer> drawer_;
  std::optional<FrameTarget> target_;
  gl::Texture directions_, depth_;
  gl::Framebuffer probe_;
};

int count_magenta(const Rgba8Image& picture) {
  int count = 0;
  for (const glm::u8vec4& c : picture.texels()) count += c.r == 255 && c.g == 0 && c.b == 255;
  return count;
}

NodeMesh mesh_of(const EnvironmentMap& map, std::size_t triangles) {
  TriangulateOptions options;
  options.triangles = triangles;
  options.error_px = 0;
  return triangulate(map, options);
}

// The picture that a cube map gives, by the direction of each pixel.
TEST_F(NodeDrawing, from_its_own_eye_a_node_is_its_picture) {
  const glm::dvec3 place(3, 1, -2);
  const EnvironmentMap map = make_node(128, furnished_room(), painted, place);
  const NodeMesh mesh = mesh_of(map, 400);
  const StoredNode node = StoredNode::create(map, mesh);
  const EnvironmentMap other = make_node(32, furnished_room(), nullptr, {3.5, 1, -2});
  const StoredNode second = StoredNode::create(other, mesh_of(other, 200));
  Random random(1);
  for (int i = 0; i < 24; ++i) {
    const Camera frame = random_frame(random, place);
    NodeDrawOptions options;
    options.merge = NodeMerge(i % 4);
    const Rgba8Image picture = draw(frame, {&node, &second}, options);
    EXPECT_EQ(count_magenta(picture), 0) << i;
    const double db = psnr(picture, [&](int x, int y) {
      const glm::dvec3 to = world_from_raster(frame, {x + 0.5, y + 0.5}, 1) - place;
      const glm::vec4 linear = painted(to, 1);
      return glm::vec3(srgb_from_linear(linear.r), srgb_from_linear(linear.g),
                       srgb_from_linear(linear.b));
    });
    // 128 texels a face, waves of 7 radians: interpolation is what is left.
    EXPECT_GT(db, 45) << i;
  }
}

TEST_F(NodeDrawing, each_pixel_shows_its_own_direction) {
  // Figure 10: a floor, far along which one looks, in as few triangles as it has.
  const EnvironmentMap map = make_node(
      64, box_around({-20, -1, -30}, {20, 9, 30}), [](const glm::dvec3& d, double distance) {
        const glm::dvec3 p = d * distance;
        const int field = int(std::floor(p.x)) + int(std::floor(p.z));
        return field % 2 == 0 ? glm::vec4(1) : glm::vec4(0.01f, 0.01f, 0.01f, 1);
      });
  const StoredNode node = StoredNode::create(map, mesh_of(map, 100));
  const Camera frame =
      look_at({0, 0, 0}, {0.3, -0.2, -1}, {0, 1, 0}, 0.9, kNodeWidth, kNodeHeight, 0.1, 99);
  const Image<glm::vec4> shown = directions(frame, node, false);
  double worst = 0;
  for (int y = 0; y < kNodeHeight; ++y)
    for (int x = 0; x < kNodeWidth; ++x) {
      const glm::dvec3 raster = raster_from_world(frame, glm::dvec3(shown(x, y)));
      worst = std::max(worst, glm::distance(glm::dvec2(raster), glm::dvec2(x + 0.5, y + 0.5)));
    }
  EXPECT_LT(worst, 0.02);  // floats; what is asked for is 0.5
}

TEST_F(NodeDrawing, a_closed_room_has_no_cracks) {
  const EnvironmentMap map = make_node(64, furnished_room(), painted);
  for (const std::size_t triangles : {150, 900}) {
    const NodeMesh mesh = mesh_of(map, triangles);
    const StoredNode node = StoredNode::create(map, mesh);
    Random random(triangles);
    const DistanceAlong room = furnished_room();
    int off = 0;
    for (int i = 0; i < 60; ++i) {
      glm::dvec3 eye(0);
      if (i % 2) {
        // Seen from the node, with room to spare for what the triangles get wrong.
        const auto in = [&] { return double(random.between(-1, 1)); };
        eye = {2.5 * in(), 0.9 * in(), 2 * in()};
        if (room(eye) < 1.5) continue;
        ++off;
      }
      NodeDrawOptions options;
      options.skin = true;
      EXPECT_EQ(count_magenta(draw(random_frame(random, eye), {&node}, options)), 0) << i;
    }
    EXPECT_GT(off, 15);
  }
}

TEST_F(NodeDrawing, without_skins_gaps_stay_open) {
  const EnvironmentMap map = make_node(64, furnished_room(), painted);
  const StoredNode node = StoredNode::create(map, mesh_of(map, 900));
  const Camera frame =
      look_at({0.9, 0, 0.3}, {1.5, -0.6, -1.6}, {0, 1, 0}, 1.2, kNodeWidth, kNodeHeight, 0.01, 100);
  EXPECT_GT(count_magenta(draw(frame, {&node}, {})), 100);
  // Another node sees what lies behind the ball.
  const EnvironmentMap other =
      make_node(64,
                [](const glm::dvec3& d) {
                  return nearest_of({box_around({-4.9, -1.6, -3.3}, {4.1, 2, 3.7}),
                                     ball({0.6, -0.6, -1.7}, 0.6), ball({-2.1, 0.3, 1.6}, 0.5)})(d);
                },
                painted, {0.9, 0, 0.3});
  const StoredNode second = StoredNode::create(other, mesh_of(other, 900));
  Camera near_second = frame;
  near_second.world_from_eye[3] += glm::dvec4(0.05, 0, 0, 0);
  for (const NodeMerge merge :
       {NodeMerge::layering, NodeMerge::binary, NodeMerge::weighted, NodeMerge::positional}) {
    NodeDrawOptions options;
    options.merge = merge;
    EXPECT_LT(count_magenta(draw(near_second, {&second, &node}, options)), 40) << int(merge);
  }
}

// S3.8: where the first node shows a surface, no other one changes a pixel; its gaps are filled.
TEST_F(NodeDrawing, first_takes_from_other_nodes_what_the_first_has_not_seen) {
  const EnvironmentMap map = make_node(64, furnished_room(), painted);
  const StoredNode node = StoredNode::create(map, mesh_of(map, 900));
  const glm::dvec3 place(0.9, 0, 0.3);
  const EnvironmentMap other = make_node(
      64,
      [](const glm::dvec3& d) {
        return nearest_of({box_around({-4.9, -1.6, -3.3}, {4.1, 2, 3.7}),
                           ball({0.6, -0.6, -1.7}, 0.6), ball({-2.1, 0.3, 1.6}, 0.5)})(d);
      },
      [](const glm::dvec3&, double) { return glm::vec4(1, 1, 0, 1); }, place);
  const StoredNode second = StoredNode::create(other, mesh_of(other, 900));
  const Camera frame =
      look_at(place, {1.5, -0.6, -1.6}, {0, 1, 0}, 1.2, kNodeWidth, kNodeHeight, 0.01, 100);
  const Rgba8Image alone = draw(frame, {&node}, {});
  NodeDrawOptions options;
  options.merge = NodeMerge::first;
  const Rgba8Image both = draw(frame, {&node, &second}, options);
  const glm::u8vec4 magenta(255, 0, 255, 255), yellow(255, 255, 0, 255);
  int kept = 0, filled = 0;
  for (std::size_t i = 0; i < both.texels().size(); ++i) {
    const bool gap = alone.texels()[i] == magenta;
    if (!gap && both.texels()[i] == alone.texels()[i]) ++kept;
    if (gap && both.texels()[i] == yellow) ++filled;
    // A crack that the first node's own skin closes may be the second's as well.
    EXPECT_TRUE(both.texels()[i] == alone.texels()[i] || both.texels()[i] == yellow) << i;
  }
  const int gaps = count_magenta(alone);
  EXPECT_GT(gaps, 100);
  EXPECT_GT(filled, 0.9 * gaps);
  EXPECT_GT(kept, 0.97 * (kNodeWidth * kNodeHeight - gaps));
}

// Two nodes in front of one wall, one red, one blue.
// A wall with one side only, as in rooms that are modelled from inside: the second node stands
// behind it and sees it, the first one looks through.
TEST_F(NodeDrawing, what_another_node_saw_from_behind_covers_nothing) {
  const glm::dvec3 low(-4, -1.6, -3), high(5, 2, 4), behind(3, 0, 0);
  const EnvironmentMap map = make_node(64, box_around(low, high));
  const StoredNode node = StoredNode::create(map, mesh_of(map, 200));
  const DistanceAlong wall = [](const glm::dvec3& d) {
    const bool meets = d.x < 0 && std::abs(d.y) < -0.6 * d.x && std::abs(d.z) < -0.8 * d.x;
    return meets ? -1 / d.x : std::numeric_limits<double>::infinity();
  };
  const EnvironmentMap other = make_node(
      64, nearest_of({box_around(low - behind, high - behind), wall}),
      [&](const glm::dvec3& d, double) {
        return std::isfinite(wall(d)) ? glm::vec4(1, 0, 0, 1) : glm::vec4(0.5, 0.5, 0.5, 1);
      },
      behind);
  const StoredNode second = StoredNode::create(other, mesh_of(other, 400));
  const auto count_red = [](const Rgba8Image& picture) {
    int count = 0;
    for (const glm::u8vec4& c : picture.texels()) count += c.r > 200 && c.g < 60 && c.b < 60;
    return count;
  };
  const auto towards_wall = [](const glm::dvec3& eye) {
    return look_at(eye, {2, 0, 0}, {0, 1, 0}, 0.9, kNodeWidth, kNodeHeight, 0.01, 100);
  };
  for (const NodeMerge merge : {NodeMerge::layering, NodeMerge::binary, NodeMerge::weighted,
                                NodeMerge::positional, NodeMerge::first}) {
    const NodeDrawOptions options{merge, true};
    const Rgba8Image through = draw(towards_wall({0.2, 0.1, 0}), {&node, &second}, options);
    EXPECT_EQ(count_red(through), 0) << int(merge);
    EXPECT_EQ(count_magenta(through), 0);
    // From its own side it is there.
    if (merge != NodeMerge::first) {
      const Rgba8Image at = draw(towards_wall({3.3, 0.1, 0}), {&second, &node}, options);
      EXPECT_GT(count_red(at), 1000) << int(merge);
    }
  }
}

TEST_F(NodeDrawing, merges_take_the_best_or_the_mean_as_they_are_named) {
  const auto in_color = [](const glm::vec3& c) {
    return [=](const glm::dvec3&, double) { return glm::vec4(c, 1); };
  };
  const glm::dvec3 place[] = {{-1, 0, 0}, {1, 0, 0}};
  const EnvironmentMap maps[] = {
      make_node(32, box_around({-8, -9, -2}, {10, 9, 9}), in_color({1, 0, 0}), place[0]),
      make_node(32, box_around({-10, -9, -2}, {8, 9, 9}), in_color({0, 0, 1}), place[1])};
  const StoredNode red = StoredNode::create(maps[0], mesh_of(maps[0], 60));
  const StoredNode blue = StoredNode::create(maps[1], mesh_of(maps[1], 60));
  const auto pixel = [&](double x, NodeMerge merge) {
    const Camera frame =
        look_at({x, 0, 0}, {x, 0, -1}, {0, 1, 0}, 0.9, kNodeWidth, kNodeHeight, 0.1, 50);
    NodeDrawOptions options;
    options.merge = merge;
    std::vector<const StoredNode*> nodes{&red, &blue};
    if (x > 0) std::swap(nodes[0], nodes[1]);
    const glm::u8vec4 c = draw(frame, nodes, options)(kNodeWidth / 2, kNodeHeight / 2);
    EXPECT_EQ(c.g, 0);
    return glm::ivec2(c.r, c.b);
  };
  for (const NodeMerge merge :
       {NodeMerge::layering, NodeMerge::binary, NodeMerge::weighted, NodeMerge::positional}) {
    EXPECT_EQ(pixel(-1, merge), glm::ivec2(255, 0));
    EXPECT_EQ(pixel(1, merge), glm::ivec2(0, 255));
    const glm::ivec2 between = pixel(-0.5, merge);
    if (merge == NodeMerge::layering || merge == NodeMerge::binary)
      EXPECT_TRUE(between == glm::ivec2(255, 0) || between == glm::ivec2(0, 255));
    else
      EXPECT_NEAR(between.x + between.y, 255, 2);
  }
  // Positional: the weights of distances 1/2 and 3/2 are 9 : 1; qualities of a wall seen from
  // (-1, 0) and (1, 0) at x = -1/2 are cosines of atan(1/4) and atan(3/4), of its few triangles
  // only roughly.
  const glm::ivec2 mean = pixel(-0.5, NodeMerge::positional),
                   even = pixel(0, NodeMerge::positional);
  EXPECT_GT(mean.x, 0.86 * 255);
  EXPECT_LT(mean.x, 0.96 * 255);
  EXPECT_NEAR(even.x, even.y, 25);
}

TEST_F(NodeDrawing, depth_is_that_of_what_is_shown) {
  const EnvironmentMap map = make_node(64, box_around({-3, -2, -4}, {3, 2, 4}), painted);
  const EnvironmentMap other =
      make_node(64, box_around({-3.5, -2, -4}, {2.5, 2, 4}), painted, {0.5, 0, 0});
  const StoredNode node = StoredNode::create(map, mesh_of(map, 300));
  const StoredNode second = StoredNode::create(other, mesh_of(other, 300));
  const Camera frame =
      look_at({0.2, 0.1, 0}, {0.2, 0.1, -1}, {0, 1, 0}, 0.5, kNodeWidth, kNodeHeight, 0.1, 50);
  for (const NodeMerge merge : {NodeMerge::layering, NodeMerge::positional}) {
    NodeDrawOptions options;
    options.merge = merge;
    target_->begin();
    ASSERT_TRUE(drawer_->draw(frame, std::vector{&node, &second}, options).ok());
    std::vector<float> depth(std::size_t(kNodeWidth) * kNodeHeight);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target_->framebuffer());
    glReadPixels(0, 0, kNodeWidth, kNodeHeight, GL_DEPTH_COMPONENT, GL_FLOAT, depth.data());
    for (const float window_z : depth)
      // The wall is 4 m away everywhere along the axis; floats of window depth.
      EXPECT_NEAR(eye_z_from(DepthKind::window_z, window_z, frame, {0, 0}), 4, 0.02);
  }
}

// What is drawn, against the true room: each sample within the bound of where it belongs.
TEST_F(NodeDrawing, samples_are_drawn_within_the_bound) {
  const int n = 48;
  const DistanceAlong room = furnished_room();
  const EnvironmentMap map = make_node(n, room);
  double worst_share = 0;
  int pixels = 0, near_centres = 0;
  for (const std::size_t triangles : {150, 500}) {
    const NodeMesh mesh = mesh_of(map, triangles);
    const StoredNode node = StoredNode::create(map, mesh);
    const NodeErrorModel model = make_error_model(map, mesh);
    const CubeGrid grid(map, {});
    std::array<Image<float>, 6> seen;
    for (int f = 0; f < 6; ++f) seen[std::size_t(f)] = seen_disparity(mesh, f);
    Random random(triangles);
    for (int i = 0; i < 150; ++i) {
      const auto in = [&] { return double(random.between(-1, 1)); };
      const glm::dvec3 eye(1.2 * in(), 0.8 * in(), 0.8 * in());
      const Camera frame = random_frame(random, eye);
      const double limit = bound_px(model, frame).error;
      const Image<glm::vec4> shown = directions(frame, node, false);
      for (int y = 0; y < kNodeHeight; ++y)
        for (int x = 0; x < kNodeWidth; ++x) {
          if (shown(x, y).w == 0) continue;
          const glm::dvec3 c = glm::dvec3(shown(x, y)) /
                               double(std::max({std::abs(shown(x, y).x), std::abs(shown(x, y).y),
                                                std::abs(shown(x, y).z)}));
          int f = 0;
          while (glm::dot(c, glm::dvec3(face_axes()[std::size_t(f)].forward)) < 1 - 1e-6) ++f;
          const FaceAxes& axes = face_axes()[std::size_t(f)];
          const glm::dvec2 raster = 0.5 * n *
                                    glm::dvec2(1 + glm::dot(c, glm::dvec3(axes.right)),
                                               1 - glm::dot(c, glm::dvec3(axes.up)));
          const glm::ivec2 texel = glm::clamp(glm::ivec2(raster), 0, n - 1);
          const glm::dvec2 off = raster - glm::dvec2(texel) - 0.5;
          // Next to a sample's own centre. How far from that the pixel is: by the mesh, which is
          // steep where a silhouette was left out, and near where the eye is.
          if (std::max(std::abs(off.x), std::abs(off.y)) > 0.05) continue;
          const glm::dvec3 centre = glm::dvec3(grid.key(f, 2 * texel + 1)) / double(n);
          const double d = grid.at(f, texel), drawn = seen[std::size_t(f)](texel.x, texel.y);
          const glm::dvec3 truth = raster_from_world(frame, centre / d);
          const glm::dvec3 there = raster_from_world(frame, centre / drawn);
          if (truth.z <= 0.01 || there.z <= 0.01) continue;
          const glm::dvec2 pixel(x + 0.5, y + 0.5);
          const double beside = glm::distance(glm::dvec2(there), pixel);
          near_centres += beside < 2;
          const double moved = glm::distance(glm::dvec2(truth), pixel);
          // A hundredth of a pixel is the rasteriser's.
          EXPECT_LE(moved, limit + beside + 0.01);
          if (limit > 1) worst_share = std::max(worst_share, moved / limit);
          ++pixels;
        }
    }
  }
  EXPECT_GT(pixels, 5000);
  EXPECT_GT(near_centres, 0.9 * pixels);
  EXPECT_GT(worst_share, 0.1);  // it does say something
}

}  // namespace
}  // namespace rilievo
