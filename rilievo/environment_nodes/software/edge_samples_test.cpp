// Pixels of merged nodes that silhouettes cross have four samples.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "rilievo/core/count_allocations_test_helpers.h"
#include "rilievo/environment_nodes/mesh_edges.h"
#include "rilievo/environment_nodes/software/slow_nodes_test_helpers.h"
#include "rilievo/environment_nodes/visible_faces.h"

namespace rilievo {
namespace {

constexpr int kEdgeTestSamples = 4;

class EdgeSamplesTest : public DrawnNodesTest {
 protected:
  static glm::dvec2 place_of(const Camera& frame, int x, int y, int s) {
    return {x + double(FrameTile::kSampleX[s]), frame.height - y - double(FrameTile::kSampleY[s])};
  }
  // What a place of the frame shows of each node, and of all.
  struct Looked {
    std::array<SlowSample, 3> of;
    SlowPixel merged;
    bool only_skins = true;
  };
  static Looked look(const SlowNodes& slow, const glm::dvec2& place) {
    Looked out;
    for (std::size_t n = 0; n < 3; ++n) {
      out.of[n] = slow.look(n, place);
      out.only_skins = out.only_skins && (out.of[n].inverse_z == 0 || out.of[n].skin);
    }
    out.merged = slow.merged(place);
    return out;
  }
  static bool are_near(double a, double b, double share) {
    return (a == 0) == (b == 0) && std::max(a, b) <= (1 + share) * std::min(a, b);
  }
  // The same surfaces: within half of the tolerance, as where nodes agree.
  static bool alike(const Looked& a, const Looked& b) {
    if (a.only_skins || b.only_skins) return a.only_skins == b.only_skins;
    for (std::size_t n = 0; n < 3; ++n)
      if (!are_near(a.of[n].skin ? 0 : a.of[n].inverse_z, b.of[n].skin ? 0 : b.of[n].inverse_z,
                    0.016))
        return false;
    return true;
  }
  static bool has_silhouette(std::span<const Looked> looks) {
    for (std::size_t n = 0; n < 3; ++n) {
      double nearest = 0, farthest = 1e30;
      for (const Looked& one : looks) {
        nearest = std::max(nearest, one.of[n].skin ? 0 : one.of[n].inverse_z);
        farthest = std::min(farthest, one.of[n].skin ? 0 : one.of[n].inverse_z);
      }
      if (farthest > 0 && nearest > 1.2 * farthest) return true;
    }
    return false;
  }
  static bool is_at(const FrameTile::Plane& drawn, int pixel, const Looked& place) {
    return are_near(double(drawn.inverse_z[pixel]), place.merged.inverse_z, 0.02);
  }
  static glm::dvec3 color_of(std::uint32_t content) {
    return glm::dvec3(content & 0xff, content >> 8 & 0xff, content >> 16 & 0xff);
  }
};

// The slow twin draws all samples of all pixels, as so many frames with shifted pixels would. It is
// asked where a node's surface ends before another of its surfaces.
TEST_F(EdgeSamplesTest, silhouettes_are_what_four_slow_frames_show) {
  Random random(11);
  for (const NodeMerge merge :
       {NodeMerge::binary, NodeMerge::weighted, NodeMerge::positional, NodeMerge::first}) {
    SCOPED_TRACE(int(merge));
    int samples = 0, wrong = 0, wrong_of_one = 0;
    double error = 0, error_of_one = 0;
    for (int i = 0; i < 12; ++i) {
      const Camera frame = random_camera(random);
      const NodeDrawOptions options{.merge = merge, .skin = true};
      const SlowNodes slow(frame, first(3), options);
      const auto one = drawn(frame, 3, options, 1, Output::color);
      const auto four = drawn(frame, 3, options, kEdgeTestSamples, Output::color);
      for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
          // The samples, and the centre.
          std::array<Looked, kEdgeTestSamples + 1> looks;
          for (int s = 0; s <= kEdgeTestSamples; ++s)
            looks[std::size_t(s)] =
                look(slow, s < kEdgeTestSamples ? place_of(frame, x, y, s)
                                                : glm::dvec2(x + 0.5, frame.height - y - 0.5));
          if (!has_silhouette(looks)) continue;
          const TilePixel at(*four, x, y);
          glm::dvec3 truth(0.0), mean(0.0);
          for (int s = 0; s < kEdgeTestSamples; ++s) {
            const Looked& right = looks[std::size_t(s)];
            const FrameTile::Plane &plane = four->plane(at.block, four->expanded[at.block] ? s : 0),
                                   &only = one->first[at.block];
            // Of a surface one sample stands for all.
            bool found = false, found_of_one = false;
            for (const Looked& like : looks) {
              if (!alike(like, right)) continue;
              found = found || is_at(plane, at.pixel, like);
              found_of_one = found_of_one || is_at(only, at.pixel, like);
            }
            ++samples, wrong += !found, wrong_of_one += !found_of_one;
            truth += 0.25 * right.merged.color;
            mean += 0.25 * color_of(plane.content[at.pixel]);
          }
          error += glm::distance(mean, truth);
          error_of_one += glm::distance(color_of(one->first[at.block].content[at.pixel]), truth);
        }
    }
    EXPECT_GT(samples, 400);
    // Where a sample lies within 1/256 of a pixel of an edge either side is right.
    EXPECT_LE(wrong, samples / 50) << "of " << samples;
    EXPECT_GT(wrong_of_one, samples / 4) << "of " << samples;
    // Textures change within a pixel, of which a surface has one colour.
    EXPECT_LT(error, 0.4 * error_of_one);
  }
}

// Two nodes see a cable of two thirds of a texel, which is a quarter of the frame's pixels wide.
TEST_F(EdgeSamplesTest, a_cable_thinner_than_a_pixel_has_no_gap) {
  const auto cable_of = [](const glm::dvec3& eye) {
    return [eye](const glm::dvec3& d) {
      if (d.z >= 0) return double(INFINITY);
      const double t = (-2 - eye.z) / d.z;
      const glm::dvec3 at = eye + t * d;
      return std::abs(at.y - 0.137 * at.x - 0.05) < 0.012 ? t : double(INFINITY);
    };
  };
  for (std::size_t k = 0; k < 2; ++k) {
    const glm::dvec3 eye(k == 0 ? -0.1 : 0.15, 0, 0);
    const DistanceAlong cable = cable_of(eye),
                        room = box_around(glm::dvec3(-4, -3, -4) - eye, glm::dvec3(4, 3, 4) - eye);
    const EnvironmentMap map = make_node(
        192, nearest_of({cable, room}),
        [&](const glm::dvec3& d, double) {
          return std::isfinite(cable(d)) ? glm::vec4(0, 0, 0, 1) : glm::vec4(1);
        },
        eye);
    tiles_.keep(k, map, triangulate(map, {}));
  }
  const glm::dvec3 eye(0.02, 0.03, 0.1);
  const Camera frame =
      look_at(eye, eye + glm::dvec3(0, 0, -1), {0, 1, 0}, 1.0, kShadeWidth, kShadeHeight, 0.05, 40);
  const auto gaps = [&](int samples) {
    const auto tile = drawn(frame, 2, {.skin = true}, samples, Output::color);
    int count = 0;
    for (int x = 0; x < frame.width; ++x) {
      bool any = false;
      for (int y = 0; y < frame.height; ++y) {
        const TilePixel at(*tile, x, y);
        for (int s = 0; s < tile->planes(at.block); ++s)
          any = any || tile->plane(at.block, s).inverse_z[at.pixel] > 0.4f;
      }
      count += !any;
    }
    return count;
  };
  EXPECT_EQ(gaps(4), 0);
  EXPECT_GT(gaps(1), 3);
}

TEST_F(EdgeSamplesTest, threads_change_nothing_and_a_second_frame_allocates_nothing) {
  Random random(12);
  const Camera frame = random_camera(random);
  const NodeDrawOptions options{.skin = true};
  const auto many = drawn(frame, 3, options, kEdgeTestSamples, Output::color);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const auto alone = drawn(frame, 3, options, kEdgeTestSamples, Output::color);
    for (int block = 0; block < FrameTile::kBlockCount; ++block) {
      ASSERT_EQ(many->expanded[block], alone->expanded[block]);
      for (int s = 0; s < many->planes(block); ++s)
        EXPECT_EQ(
            std::memcmp(&many->plane(block, s), &alone->plane(block, s), sizeof(FrameTile::Plane)),
            0);
    }
  }
#ifndef RILIEVO_OPERATORS_ARE_TAKEN
  const std::size_t all[] = {0, 1, 2};
  const auto place = [&] {
    tiles_.begin();
    tiles_.draw(frame, 1.0, all, Output::color, kNoObject, options);
  };
  place();
  const std::size_t before = allocations_here;
  place();
  EXPECT_EQ(allocations_here - before, 0u);
#endif
}

// Of all edges those are kept that end a surface, the nearer one where two end on the same lines of
// sight, and for the others how far the eye must be from the node to see one side from behind.
TEST_F(EdgeSamplesTest, edges_are_borders_or_turn_away_from_eyes_beyond_their_reach) {
  const NodeMesh& mesh = nodes_[0].mesh;
  const auto place = [&](std::uint32_t v) {
    return glm::dvec3(mesh.vertices[v].direction) /
           std::max(1e-9, double(mesh.vertices[v].disparity));
  };
  // From the front: counter-clockwise.
  const auto front = [&](const glm::dvec3& eye, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return glm::dot(glm::cross(place(a) - eye, place(b) - eye), place(c) - eye);
  };
  Random random(13);
  const std::array<std::vector<MeshEdge>, 6> found = find_mesh_edges(mesh);
  int inner = 0, borders = 0, turned = 0;
  for (const std::vector<MeshEdge>& face : found)
    for (const MeshEdge& edge : face) {
      if (edge.outer == MeshEdge::kNone) {
        EXPECT_EQ(edge.reach, 0);
        ++borders;
        continue;
      }
      ++inner;
      for (int i = 0; i < 4; ++i) {
        const glm::dvec3 to = glm::normalize(
            glm::dvec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)));
        // At the node all are seen from one side.
        const auto folds = [&](double distance) {
          const glm::dvec3 eye = distance * to;
          return (front(eye, edge.from, edge.to, edge.inner) > 0) !=
                 (front(eye, edge.to, edge.from, edge.outer) > 0);
        };
        EXPECT_FALSE(folds(0.999 * std::min(double(edge.reach), 1e6)));
        turned += folds(3.0 * double(edge.reach));
      }
    }
  EXPECT_GT(borders, 20);
  EXPECT_GT(inner, 100);
  EXPECT_GT(turned, 50);
  // Each inner edge once; of the others some lie behind.
  EXPECT_GE(3 * int(mesh.surface_triangles()) - 2 * inner, borders);
}

// Where two faces of the cube meet, an edge is one face's, and the other may be visible alone.
TEST_F(EdgeSamplesTest, no_edge_is_in_view_of_a_face_that_is_not_visible) {
  const NodeMesh& mesh = nodes_[0].mesh;
  const std::array<SideReach, 6> reaches = side_reaches(mesh);
  const std::array<std::vector<MeshEdge>, 6> found = find_mesh_edges(mesh);
  const auto between_faces = [&](const MeshEdge& edge) {
    const glm::vec3 middle =
        glm::abs(mesh.vertices[edge.from].direction) + glm::abs(mesh.vertices[edge.to].direction);
    const float most = std::max(middle.x, std::max(middle.y, middle.z));
    return edge.outer != MeshEdge::kNone &&
           int(middle.x == most) + int(middle.y == most) + int(middle.z == most) > 1;
  };
  Random random(17);
  const auto in = [&](float reach) { return double(random.between(-reach, reach)); };
  int hidden = 0, seen = 0;
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 eye = i % 2 == 0 ? glm::dvec3(0) : glm::dvec3(in(1.5f), in(1), in(1.5f));
    const Camera frame = look_at(eye, eye + glm::dvec3(in(1), in(1), in(1)) + 1e-6, {0, 1, 0},
                                 double(random.between(0.2f, 1.2f)), 16, 9, 0.1, 10);
    const std::array<bool, 6> visible = visible_faces(mesh, reaches, frame);
    const glm::dmat4 to_clip = clip_from_node(mesh, frame);
    for (std::size_t f = 0; f < 6; ++f)
      for (const MeshEdge& edge : found[f]) {
        const auto corner = [&](std::uint32_t v) {
          return to_clip *
                 glm::dvec4(glm::dvec3(mesh.vertices[v].direction), mesh.vertices[v].disparity);
        };
        const glm::dvec4 a = corner(edge.from), b = corner(edge.to);
        double low = 0, high = 1;
        for (const glm::dvec4& plane : {glm::dvec4(1, 0, 0, 1), glm::dvec4(-1, 0, 0, 1),
                                        glm::dvec4(0, 1, 0, 1), glm::dvec4(0, -1, 0, 1)}) {
          const double at_a = glm::dot(plane, a), at_b = glm::dot(plane, b);
          if (at_a < 0 && at_b < 0) high = -1;
          if (at_a < 0 && at_b >= 0) low = std::max(low, at_a / (at_a - at_b));
          if (at_a >= 0 && at_b < 0) high = std::min(high, at_a / (at_a - at_b));
        }
        const bool in_view = low + 1e-9 < high;
        EXPECT_TRUE(visible[f] || !in_view) << i << " " << f;
        if (between_faces(edge)) (visible[f] ? seen : hidden) += visible[f] ? in_view : 1;
      }
  }
  EXPECT_GT(seen, 100);
  EXPECT_GT(hidden, 100);
}

}  // namespace
}  // namespace rilievo
