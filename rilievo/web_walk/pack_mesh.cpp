// A disparity that is off by half a step s moves by reach * s / 2 on the plane at distance 1 of a
// face, whose texel is 2 / N wide: by reach * s * N / 4 texels.
#include "rilievo/web_walk/pack_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

constexpr double kMostCode = 65535;
// Texture directions are finer than the lattice: they point beside it.
constexpr float kTextureSteps = 4;
constexpr float kStretchSteps = 8;

struct SurfaceVertex {
  std::int16_t direction[3];
  std::uint16_t disparity;
};
static_assert(sizeof(SurfaceVertex) == 8);

struct SkinVertex {
  SurfaceVertex surface;
  std::int16_t texture[3];
  std::uint16_t stretch;
};
static_assert(sizeof(SkinVertex) == 16);

class MeshPacker {
 public:
  MeshPacker(const NodeMesh& mesh, double step) : mesh_(mesh), step_(step) {}

  PackedMesh run() && {
    WalkMesh& made = packed_.mesh;
    made.disparity_step = step_;
    pack<SurfaceVertex>(mesh_.surfaces, made.surfaces, made.surface_vertices, made.surface_indices);
    pack<SkinVertex>(mesh_.skins, made.skins, made.skin_vertices, made.skin_indices);
    return std::move(packed_);
  }

 private:
  std::int16_t rounded(float value, float scale) const {
    return std::int16_t(std::lround(std::clamp(value * scale, -32767.0f, 32767.0f)));
  }

  void write(const NodeVertex& v, SurfaceVertex& out) const {
    for (int k = 0; k < 3; ++k) out.direction[k] = rounded(v.direction[k], float(mesh_.face_size));
    const double code = std::round(double(v.disparity) / step_);
    // What is not the sky must not become it.
    out.disparity = std::uint16_t(std::clamp(code, v.disparity > 0 ? 1.0 : 0.0, kMostCode));
  }

  void write(const NodeVertex& v, SkinVertex& out) const {
    write(v, out.surface);
    for (int k = 0; k < 3; ++k)
      out.texture[k] = rounded(v.texture[k], kTextureSteps * float(mesh_.face_size));
    out.stretch = v.stretch == NodeVertex::kAlways
                      ? std::uint16_t(0)
                      : std::uint16_t(1 + std::lround(v.stretch * kStretchSteps));
  }

  // Triangles stay with their side; within it, and vertices, in the order that compresses best.
  template <typename Vertex>
  void pack(const std::array<TriangleRange, 6>& sides, std::array<std::uint32_t, 6>& counts,
            WalkMesh::Stream& of_vertices, WalkMesh::Stream& of_indices) {
    std::vector<std::uint32_t> indices;
    for (std::size_t f = 0; f < 6; ++f) {
      counts[f] = sides[f].count;
      const std::size_t first = indices.size();
      const auto begin = mesh_.indices.begin() + std::ptrdiff_t(3 * std::size_t(sides[f].first));
      indices.insert(indices.end(), begin, begin + std::ptrdiff_t(3 * std::size_t(sides[f].count)));
      if (sides[f].count > 0)
        meshopt_optimizeVertexCache(indices.data() + first, indices.data() + first,
                                    indices.size() - first, mesh_.vertices.size());
    }
    if (indices.empty()) return;
    std::vector<std::uint32_t> remap(mesh_.vertices.size());
    const std::size_t count = meshopt_optimizeVertexFetchRemap(remap.data(), indices.data(),
                                                               indices.size(), remap.size());
    std::vector<Vertex> vertices(count);
    for (std::size_t v = 0; v < remap.size(); ++v)
      if (remap[v] != ~0u) write(mesh_.vertices[v], vertices[remap[v]]);
    for (std::uint32_t& index : indices) index = remap[index];

    std::vector<std::uint8_t>& out = packed_.bytes;
    const auto append = [&](WalkMesh::Stream& stream, std::size_t elements, std::size_t bound,
                            auto encode) {
      const std::size_t first = out.size();
      out.resize(first + bound);
      stream = {encode(out.data() + first, bound), elements};
      RILIEVO_EXPECTS(stream.bytes > 0);
      out.resize(first + stream.bytes);
    };
    append(of_vertices, count, meshopt_encodeVertexBufferBound(count, sizeof(Vertex)),
           [&](std::uint8_t* to, std::size_t bound) {
             return meshopt_encodeVertexBuffer(to, bound, vertices.data(), count, sizeof(Vertex));
           });
    append(of_indices, indices.size(), meshopt_encodeIndexBufferBound(indices.size(), count),
           [&](std::uint8_t* to, std::size_t bound) {
             return meshopt_encodeIndexBuffer(to, bound, indices.data(), indices.size());
           });
  }

  const NodeMesh& mesh_;
  double step_;
  PackedMesh packed_;
};

}  // namespace

double disparity_step(const NodeMesh& mesh, double rounding_px, double reach) {
  float most = 0;
  for (const NodeVertex& v : mesh.vertices) most = std::max(most, v.disparity);
  const double least = std::max(double(most), 1e-30) / kMostCode;
  const double wanted = 4 * rounding_px / (std::max(reach, 1e-30) * mesh.face_size);
  return std::isfinite(wanted) ? std::max(least, wanted) : least;
}

PackedMesh pack_mesh(const NodeMesh& mesh, double step) {
  RILIEVO_EXPECTS(step > 0);
  return MeshPacker(mesh, step).run();
}

}  // namespace rilievo
