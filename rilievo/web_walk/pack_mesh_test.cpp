#include "rilievo/web_walk/pack_mesh.h"

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <array>
#include <cstring>
#include <map>
#include <tuple>

#include "rilievo/environment_nodes/node_test_helpers.h"

namespace rilievo {
namespace {

struct UnpackedSide {
  std::vector<NodeVertex> vertices;
  std::vector<std::uint32_t> indices;
};

// What a browser makes of the bytes.
UnpackedSide unpack(const PackedMesh& packed, int size, bool skins) {
  const WalkMesh& mesh = packed.mesh;
  const WalkMesh::Stream& of_vertices = skins ? mesh.skin_vertices : mesh.surface_vertices;
  const WalkMesh::Stream& of_indices = skins ? mesh.skin_indices : mesh.surface_indices;
  const std::size_t first =
      skins ? mesh.surface_vertices.bytes + mesh.surface_indices.bytes : std::size_t(0);
  const std::size_t stride = skins ? 16 : 8;
  std::vector<std::uint8_t> raw(stride * of_vertices.count);
  UnpackedSide out;
  out.indices.resize(of_indices.count);
  EXPECT_EQ(meshopt_decodeVertexBuffer(raw.data(), of_vertices.count, stride,
                                       packed.bytes.data() + first, of_vertices.bytes),
            0);
  EXPECT_EQ(
      meshopt_decodeIndexBuffer(out.indices.data(), of_indices.count, 4,
                                packed.bytes.data() + first + of_vertices.bytes, of_indices.bytes),
      0);
  for (std::size_t v = 0; v < of_vertices.count; ++v) {
    std::array<std::int16_t, 8> s{};
    std::memcpy(s.data(), raw.data() + stride * v, stride);
    NodeVertex vertex;
    vertex.direction = glm::vec3(s[0], s[1], s[2]) / float(size);
    vertex.disparity = float(double(std::uint16_t(s[3])) * mesh.disparity_step);
    vertex.texture = skins ? glm::vec3(s[4], s[5], s[6]) / (4.0f * float(size)) : vertex.direction;
    if (skins) vertex.stretch = s[7] == 0 ? NodeVertex::kAlways : float(s[7] - 1) / 8.0f;
    out.vertices.push_back(vertex);
  }
  return out;
}

// Triangles by their corners' places, whatever corner comes first.
using PackedCorner = std::tuple<float, float, float, int>;
using PackedTriangle = std::array<PackedCorner, 3>;

PackedCorner corner_of(const NodeVertex& v, double step) {
  return {v.direction.x, v.direction.y, v.direction.z, int(std::lround(v.disparity / step))};
}

PackedTriangle turned(PackedTriangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

TEST(PackMesh, KeepsEveryTriangleOnItsSideAndRoundsDisparitiesAlone) {
  const EnvironmentMap map = make_node(48, furnished_room());
  const NodeMesh mesh = triangulate(map, {});
  const double step = disparity_step(mesh, 0.05, 1.0);
  const PackedMesh packed = pack_mesh(mesh, step);
  EXPECT_EQ(packed.bytes.size(),
            packed.mesh.surface_vertices.bytes + packed.mesh.surface_indices.bytes +
                packed.mesh.skin_vertices.bytes + packed.mesh.skin_indices.bytes);
  for (const bool skins : {false, true}) {
    const UnpackedSide side = unpack(packed, 48, skins);
    const auto& ranges = skins ? mesh.skins : mesh.surfaces;
    const auto& counts = skins ? packed.mesh.skins : packed.mesh.surfaces;
    std::size_t at = 0;
    for (std::size_t f = 0; f < 6; ++f) {
      ASSERT_EQ(counts[f], ranges[f].count);
      std::map<PackedTriangle, int> expected, found;
      for (std::uint32_t t = 0; t < counts[f]; ++t) {
        PackedTriangle a, b;
        for (std::size_t k = 0; k < 3; ++k) {
          a[k] = corner_of(mesh.vertices[mesh.indices[3 * (ranges[f].first + t) + k]], step);
          b[k] = corner_of(side.vertices[side.indices[at++]], step);
        }
        ++expected[turned(a)];
        ++found[turned(b)];
      }
      EXPECT_EQ(found, expected) << "side " << f;
    }
  }
}

// From the definition: the raster position of a point seen from an eye beside the node.
TEST(PackMesh, MovesNoTexelFartherThanAsked) {
  for (const double px : {0.01, 0.05, 0.5}) {
    NodeMesh mesh;
    mesh.face_size = 512;
    mesh.vertices.push_back({{0, 0, 1}, 0.7f, {0, 0, 1}});
    const double reach = 0.8, step = disparity_step(mesh, px, reach);
    for (double d = 0; d < 0.7; d += 0.0137) {
      const double rounded = std::round(d / step) * step;
      // The eye moves sideways, where parallax is largest.
      EXPECT_LE(std::abs(reach * rounded - reach * d) * mesh.face_size / 2, px * (1 + 1e-9));
    }
  }
}

TEST(PackMesh, KeepsTheSkyInfinitelyFarAndNothingElse) {
  NodeMesh mesh;
  mesh.face_size = 8;
  for (const float d : {0.0f, 1e-9f, 1.0f}) mesh.vertices.push_back({{0, 0, 1}, d, {0, 0, 1}});
  mesh.indices = {0, 1, 2};
  mesh.surfaces[4] = {0, 1};
  const PackedMesh packed = pack_mesh(mesh, 0.01);
  const UnpackedSide side = unpack(packed, 8, false);
  std::vector<float> all;
  for (const NodeVertex& v : side.vertices) all.push_back(v.disparity);
  std::sort(all.begin(), all.end());
  EXPECT_EQ(all, (std::vector<float>{0.0f, 0.01f, 1.0f}));
}

}  // namespace
}  // namespace rilievo
