#include "rilievo/render/raster/near_clip.h"

#include <algorithm>
#include <array>

#include "rilievo/render/raster/clip_polygon.h"

namespace rilievo {
namespace {

// The frame reaches from -1 to 1; cuts at the sides lie this far outside, where nobody sees that
// they do not lie on the neighbour's edge.
constexpr float kGuardBand = 16;

struct ClipVertex {
  glm::vec3 position, frame;  // frame: x and y from -w to w within the frame, and w
  glm::vec2 uv;
  glm::vec4 color;
};

// Of planes 0 to 4: how far inside is the vertex?
float inside(const ClipVertex& v, int plane, float z_near) {
  switch (plane) {
    case 0:
      return v.frame.z - z_near;
    case 1:
      return kGuardBand * v.frame.z - v.frame.x;
    case 2:
      return kGuardBand * v.frame.z + v.frame.x;
    case 3:
      return kGuardBand * v.frame.z - v.frame.y;
    default:
      return kGuardBand * v.frame.z + v.frame.y;
  }
}

ClipVertex between(const ClipVertex& in, const ClipVertex& out, float share) {
  return {glm::mix(in.position, out.position, share), glm::mix(in.frame, out.frame, share),
          glm::mix(in.uv, out.uv, share), glm::mix(in.color, out.color, share)};
}

// May a triangle within the box reach through the near plane? Twice as far to both sides, for
// rounding.
bool has_both_sides(const RasterInstance& instance, const Box& bounds, float z_near) {
  bool before = false, beyond = false;
  for (const glm::vec3& corner : bounds.corners()) {
    const float w = glm::dot(instance.row_w, glm::vec4(corner, 1));
    before |= w <= 2 * z_near, beyond |= w > 0.5f * z_near;
  }
  return before && beyond;
}

}  // namespace

void NearClip::clear() {
  used_ = 0;
  instances_.clear();
}

bool NearClip::crosses(const RasterInstance& instance, const Box& bounds, float z_near) {
  // Twice as far, for rounding.
  for (const glm::vec3& corner : bounds.corners())
    if (glm::dot(instance.row_w, glm::vec4(corner, 1)) <= 2 * z_near) return true;
  return false;
}

bool NearClip::cut(const Mesh& mesh, int width, int height, float z_near,
                   RasterInstance& instance) {
  instance.min_w = z_near;
  const RasterMask* mask = instance.mask;
  const auto vertex = [&](std::uint32_t i) {
    const glm::vec4 p(mesh.positions[i], 1);
    const float w = glm::dot(instance.row_w, p);
    const float x = 2 * glm::dot(instance.row_x, p) / float(width) - w;
    const float y = 2 * glm::dot(instance.row_y, p) / float(height) - w;
    return ClipVertex{mesh.positions[i],
                      {x, y, w},
                      mask && mask->uv ? mask->uv[i] : glm::vec2(0),
                      mask && mask->colors ? mask->colors[i] : glm::vec4(0)};
  };
  std::vector<ClipVertex> polygon, clipped;
  if (used_ == pieces_.size()) pieces_.emplace_back();
  Pieces& pieces = pieces_[used_];
  pieces.positions.clear(), pieces.uv.clear(), pieces.colors.clear();
  pieces.indices.clear(), pieces.numbers.clear();
  for (std::uint32_t t = 0; t < instance.triangles; ++t) {
    if (t % Mesh::kRun == 0 && !mesh.run_bounds.empty() &&
        !has_both_sides(instance, mesh.run_bounds[t / Mesh::kRun], z_near)) {
      t += Mesh::kRun - 1;
      continue;
    }
    const std::uint32_t* corner = &mesh.indices[3 * std::size_t(t)];
    int beyond = 0;
    for (int k = 0; k < 3; ++k)
      beyond += glm::dot(instance.row_w, glm::vec4(mesh.positions[corner[k]], 1)) > z_near;
    if (beyond == 0 || beyond == 3) continue;
    polygon.assign({vertex(corner[0]), vertex(corner[1]), vertex(corner[2])});
    for (int plane = 0; plane < 5 && !polygon.empty(); ++plane)
      clip_polygon(
          polygon, clipped, [&](const ClipVertex& v) { return inside(v, plane, z_near); }, between);
    if (polygon.size() < 3) continue;
    const auto first = std::uint32_t(pieces.positions.size());
    for (const ClipVertex& v : polygon) {
      pieces.positions.push_back(v.position);
      pieces.uv.push_back(v.uv);
      pieces.colors.push_back(v.color);
    }
    for (std::uint32_t k = 2; k < polygon.size(); ++k) {
      pieces.indices.insert(pieces.indices.end(), {first, first + k - 1, first + k});
      pieces.numbers.push_back(instance.first_triangle + t);
    }
  }
  if (pieces.indices.empty()) return false;
  ++used_;
  RasterInstance cut = instance;
  cut.positions = pieces.positions.data();
  cut.indices = pieces.indices.data();
  cut.triangles = std::uint32_t(pieces.indices.size() / 3);
  cut.numbers = pieces.numbers.data();
  cut.min_w = 0;
  cut.boxes = {};  // they are those of the whole mesh's triangles
  if (mask) {
    pieces.mask = *mask;
    if (mask->uv) pieces.mask.uv = pieces.uv.data();
    if (mask->colors) pieces.mask.colors = pieces.colors.data();
    cut.mask = &pieces.mask;
  }
  instances_.push_back(cut);
  return true;
}

}  // namespace rilievo
