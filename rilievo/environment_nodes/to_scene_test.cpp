#include "rilievo/environment_nodes/to_scene.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/node_test_helpers.h"

namespace rilievo {
namespace {

TEST(SceneFromNode, every_point_has_the_texel_of_its_direction) {
  const glm::dvec3 place(2, 1, -1);
  const EnvironmentMap map = make_node(64, furnished_room(), nullptr, place);
  TriangulateOptions options;
  options.triangles = 200;
  const NodeMesh node = triangulate(map, options);
  const Scene scene = scene_from_node(map, node, {.skins = false});
  ASSERT_TRUE(validate(scene).ok());
  EXPECT_GT(count_triangles(scene), node.surface_triangles());
  Random random(3);
  double worst = 0;
  for (const Mesh& mesh : scene.meshes) {
    const FaceAxes& axes = face_axes()[std::size_t(mesh.material)];
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
      for (int i = 0; i < 4; ++i) {
        const float a = random.unit(), b = (1 - a) * random.unit(), c = 1 - a - b;
        const std::uint32_t* v = &mesh.indices[t];
        const glm::vec3 p = a * mesh.positions[v[0]] + b * mesh.positions[v[1]] +
                            c * mesh.positions[v[2]] - glm::vec3(place);
        const glm::vec2 uv = a * mesh.uv[0][v[0]] + b * mesh.uv[0][v[1]] + c * mesh.uv[0][v[2]];
        const float depth = glm::dot(p, glm::vec3(axes.forward));
        const glm::vec2 right(0.5f + 0.5f * glm::dot(p, glm::vec3(axes.right)) / depth,
                              0.5f - 0.5f * glm::dot(p, glm::vec3(axes.up)) / depth);
        worst = std::max(worst, 64.0 * double(glm::distance(uv, right)));
      }
  }
  // Half a texel along an edge; within a triangle two of them may add up.
  EXPECT_LT(worst, 1.0);
  EXPECT_GT(worst, 0.1);
}

TEST(SceneFromNode, a_closed_room_stays_closed) {
  const EnvironmentMap map = make_node(40, furnished_room());
  TriangulateOptions options;
  options.triangles = 500;
  const Scene scene = scene_from_node(map, triangulate(map, options));
  using Place = std::tuple<float, float, float>;
  std::map<std::pair<Place, Place>, int> edges;
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
      const auto at = [&](std::size_t k) {
        const glm::vec3& p = mesh.positions[mesh.indices[k]];
        return Place{p.x, p.y, p.z};
      };
      Place a = at(i), b = at(i % 3 == 2 ? i - 2 : i + 1);
      if (b < a) std::swap(a, b);
      if (a != b) ++edges[{a, b}];
    }
  for (const auto& [edge, count] : edges) EXPECT_EQ(count % 2, 0);
}

TEST(SceneFromNode, skins_are_few_and_have_area) {
  const EnvironmentMap map = make_node(64, furnished_room());
  const NodeMesh node = triangulate(map, {.triangles = 2000});
  ASSERT_GT(node.triangles(), node.surface_triangles());
  const Scene closed = scene_from_node(map, node),
              open = scene_from_node(map, node, {.skins = false});
  EXPECT_GT(count_triangles(closed), count_triangles(open));
  EXPECT_LE(count_triangles(closed), 2 * count_triangles(open));
  for (const Mesh& mesh : closed.meshes)
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
      const glm::dvec3 a(mesh.positions[mesh.indices[t]]), b(mesh.positions[mesh.indices[t + 1]]),
          c(mesh.positions[mesh.indices[t + 2]]);
      const double longest =
          std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
      ASSERT_GT(glm::length(glm::cross(b - a, c - a)), 1e-7 * glm::length(a) * longest);
    }
}

}  // namespace
}  // namespace rilievo
