#include "rilievo/render/shading/seen_triangles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "rilievo/render/shading/sample_buffer.h"
#include "rilievo/render/shading/stroke_points.h"

namespace rilievo {
namespace {

// Where the middle of each set of a pixel's samples lies, from the pixel's centre. Of all of them:
// there.
std::array<glm::vec2, 16> middles_of(int samples) {
  std::array<glm::vec2, 16> middles{};
  for (unsigned set = 1; set + 1 < 1u << samples; ++set) {
    for (int s = 0; s < samples; ++s)
      if (set >> s & 1) middles[set] += sample_position(s, samples) - 0.5f;
    middles[set] /= float(std::popcount(set));
  }
  return middles;
}

// Entries are written so many at a time, by one store. Most triangles have fewer pixels, and a loop
// would cost more than what it spares the others.
constexpr std::size_t kFill = 4;
static_assert(TriangleRays::kMaxCount + kFill <= TriangleRays::kCapacity);

void fill(float* field, float value) {
  const float values[kFill] = {value, value, value, value};
  std::memcpy(field, values, sizeof values);
}

// The corners of one triangle into kFill entries.
template <std::size_t kAxes, class Vertices>
void fill_corners(float (&field)[3][kAxes][TriangleRays::kCapacity], const Vertices& vertices,
                  const std::uint32_t* corner, std::size_t from) {
  for (int k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < kAxes; ++axis)
      fill(&field[k][axis][from], vertices[corner[k]][glm::length_t(axis)]);
}

// All of its attributes that the material uses.
void fill_triangle(const Mesh& mesh, const SurfacePlacement& surface, std::uint32_t triangle,
                   std::size_t from, TriangleRays& rays) {
  const std::uint32_t* corner = &mesh.indices[3 * std::size_t(triangle)];
  fill_corners(rays.position, mesh.positions, corner, from);
  if (surface.has_normals) fill_corners(rays.normal, mesh.normals, corner, from);
  if (surface.has_colors) fill_corners(rays.color, mesh.colors, corner, from);
  if (surface.has_colors && surface.material->blended)
    for (int k = 0; k < 3; ++k) fill(&rays.alpha[k][from], mesh.colors[corner[k]].a);
  for (int set = 0; set < 2; ++set) {
    if (!surface.material->uses_uv[set]) continue;
    const std::vector<glm::vec2>& uv = mesh.uv[set];
    static constexpr std::uint32_t kFirst[3] = {0, 0, 0};
    static const std::vector<glm::vec2> kNone(1, glm::vec2(0.0f));
    fill_corners(rays.uv[set], uv.empty() ? kNone : uv, uv.empty() ? kFirst : corner, from);
  }
}

// A point or line where ray `at` meets it, as a triangle around that place which faces the ray and
// has the attributes of the place all over.
void fill_stroke(const ShadedScene& scene, const PlacedMesh& placed, std::uint32_t index,
                 std::size_t at, TriangleRays& rays) {
  const Mesh& mesh = *placed.mesh;
  const glm::vec3 ray(rays.ray[0][at], rays.ray[1][at], rays.ray[2][at]);
  const StrokePoint met = stroke_at(scene.rays, ray, mesh, placed.surface, index);
  const FacingCorners corners = facing_corners(scene.rays, met.relative);
  const auto mixed = [&](const auto& values) {
    return glm::mix(values[met.vertex[0]], values[met.vertex[1]], met.share);
  };
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis) rays.position[k][axis][at] = corners.at[k][axis];
  const auto put = [&](auto& field, const auto& value, int axes) {
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < axes; ++axis) field[k][axis][at] = value[axis];
  };
  if (placed.surface.has_normals) put(rays.normal, mixed(mesh.normals), 3);
  if (placed.surface.has_colors) put(rays.color, mixed(mesh.colors), 3);
  for (int set = 0; set < 2; ++set)
    if (placed.surface.material->uses_uv[set])
      put(rays.uv[set], mesh.uv[set].empty() ? glm::vec2(0.0f) : mixed(mesh.uv[set]), 2);
}

}  // namespace

std::size_t mesh_of_triangle(std::span<const PlacedMesh> meshes, std::uint32_t triangle) {
  const auto after = std::upper_bound(
      meshes.begin(), meshes.end(), triangle,
      [](std::uint32_t t, const PlacedMesh& placed) { return t < placed.first_triangle; });
  return std::size_t(after - meshes.begin()) - 1;
}

void SeenTriangles::find_mesh(std::span<const PlacedMesh> meshes, std::uint32_t triangle) {
  if (first_of_.size() < meshes.size()) first_of_.resize(meshes.size(), kNone);
  mesh_ = std::uint32_t(mesh_of_triangle(meshes, triangle));
  first_triangle_ = meshes[mesh_].first_triangle, triangles_ = meshes[mesh_].triangles;
  if (first_of_[mesh_] == kNone) met_.push_back(mesh_);
}

std::uint32_t SeenTriangles::gather(const ShadedScene& scene, const PlacedMesh& placed,
                                    std::uint32_t first) {
  Pixel* pixels = waiting_ + surfaces_.count;
  std::size_t count = 0;
  std::uint32_t next = first;
  for (; next != kNone && count < TriangleRays::kMaxCount; next = seen_[next].next)
    pixels[count++] = seen_[next].pixel;
  rays_.count = count;
  static const std::array<glm::vec2, 16> kMiddles[] = {middles_of(1), middles_of(4)};
  const std::array<glm::vec2, 16>& middles = kMiddles[scene.samples == 4 ? 1 : 0];
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec2 at = scene.staggered ? staggered_position(pixels[i].x, pixels[i].y) - 0.5f
                                         : middles[pixels[i].samples];
    const glm::vec3 ray = scene.rays.first + (float(pixels[i].x) + at.x) * scene.rays.per_x +
                          (float(pixels[i].y) + at.y) * scene.rays.per_y;
    for (int axis = 0; axis < 3; ++axis) rays_.ray[axis][i] = ray[axis];
  }
  if (placed.mesh->primitive != Primitive::triangles) {
    for (std::size_t i = 0; i < count; ++i)
      fill_stroke(scene, placed, pixels[i].triangle - placed.first_triangle, i, rays_);
    append_surfaces(rays_, scene.rays, unplaced(placed.surface), surfaces_);
    return next;
  }
  // A triangle that several pixels in a row show is read once for kFill of them.
  for (std::size_t from = 0, to; from < count; from = to) {
    const std::uint32_t triangle = pixels[from].triangle;
    const std::size_t end = std::min(count, from + kFill);
    for (to = from + 1; to < end && pixels[to].triangle == triangle;) ++to;
    fill_triangle(*placed.mesh, placed.surface, triangle - placed.first_triangle, from, rays_);
  }
  append_surfaces(rays_, scene.rays, placed.surface, surfaces_);
  return next;
}

}  // namespace rilievo
