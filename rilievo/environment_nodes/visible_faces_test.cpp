#include "rilievo/environment_nodes/visible_faces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/node_test_helpers.h"

namespace rilievo {
namespace {

// What is left of a triangle in the frustum, cut plane by plane in clip space.
bool in_view(const NodeMesh& mesh, const glm::dmat4& to_clip, std::size_t triangle) {
  std::vector<glm::dvec4> polygon;
  for (int k = 0; k < 3; ++k) {
    const NodeVertex& v = mesh.vertices[mesh.indices[3 * triangle + std::size_t(k)]];
    polygon.push_back(to_clip * glm::dvec4(glm::dvec3(v.direction), v.disparity));
  }
  const glm::dvec4 planes[] = {
      {1, 0, 0, 1}, {-1, 0, 0, 1}, {0, 1, 0, 1}, {0, -1, 0, 1}, {0, 0, 0, 1}};
  for (const glm::dvec4& plane : planes) {
    std::vector<glm::dvec4> left;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec4 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double da = glm::dot(plane, a), db = glm::dot(plane, b);
      if (da > 0) left.push_back(a);
      if ((da > 0) != (db > 0)) left.push_back(a + (b - a) * (da / (da - db)));
    }
    polygon = std::move(left);
  }
  return polygon.size() >= 3;
}

TEST(VisibleFaces, no_side_is_left_out_that_has_a_triangle_in_view) {
  TriangulateOptions options;
  options.triangles = 300;
  const NodeMesh mesh = triangulate(make_node(32, furnished_room()), options);
  const std::array<SideReach, 6> reaches = side_reaches(mesh);
  Random random(5);
  int drawn = 0, needed = 0;
  constexpr int kEyes = 400;
  for (int i = 0; i < kEyes; ++i) {
    const auto in = [&](float reach) { return double(random.between(-reach, reach)); };
    const bool at_node = i % 2 == 0;
    const glm::dvec3 eye = at_node ? glm::dvec3(0) : glm::dvec3(in(2.5f), in(1.2f), in(2.5f));
    const Camera frame = look_at(eye, eye + glm::dvec3(in(1), in(1), in(1)) + 1e-6, {0, 1, 0},
                                 double(random.between(0.2f, 1.2f)), 16, 9, 0.1, 10);
    const std::array<bool, 6> visible = visible_faces(mesh, reaches, frame);
    const glm::dmat4 to_clip = clip_from_node(mesh, frame);
    for (std::size_t f = 0; f < 6; ++f) {
      bool any = false;
      for (const TriangleRange& range : {mesh.surfaces[f], mesh.skins[f]})
        for (std::size_t t = range.first; t < range.first + range.count && !any; ++t)
          any = in_view(mesh, to_clip, t);
      EXPECT_TRUE(visible[f] || !any) << i << " " << f;
      drawn += visible[f];
      needed += any;
    }
  }
  // It does cull: half of the sides and more, and hardly more are drawn than need be.
  EXPECT_LT(drawn, 3 * kEyes);
  EXPECT_LT(drawn, 1.2 * needed);
}

}  // namespace
}  // namespace rilievo
