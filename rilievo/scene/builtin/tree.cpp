// Trees: a trunk, branches, and leaves as lumpy blobs that overlap.
//
// Opaque geometry throughout, so that a picture of a tree has one depth a texel. The blobs carry
// nearly all triangles; their colour is darker inside and below, where less of the sky is seen.

#include <algorithm>
#include <cmath>

#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo {
namespace {

struct TreeShape {
  const char* name;
  float height, trunk_radius;
  float crown_bottom;  // share of the height
  float crown_radius;
  int blobs;
  float blob_radius;
  glm::vec3 leaves, bark;
};

TreeShape shape_of(TreeKind kind) {
  switch (kind) {
    case TreeKind::oak:
      return {
          "oak", 11, 0.42f, 0.25f, 4.2f, 46, 1.35f, {0.10f, 0.19f, 0.045f}, {0.13f, 0.10f, 0.07f}};
    case TreeKind::poplar:
      return {
          "poplar", 15, 0.3f, 0.1f, 1.7f, 40, 1.0f, {0.13f, 0.21f, 0.06f}, {0.17f, 0.15f, 0.12f}};
    case TreeKind::fir:
      return {
          "fir", 14, 0.3f, 0.08f, 3.2f, 40, 1.0f, {0.045f, 0.115f, 0.065f}, {0.12f, 0.08f, 0.05f}};
    case TreeKind::birch:
      return {
          "birch", 12, 0.2f, 0.3f, 2.7f, 38, 0.95f, {0.20f, 0.25f, 0.07f}, {0.55f, 0.53f, 0.48f}};
    case TreeKind::bush:
      return {"bush", 3, 0.12f, 0.0f, 1.7f, 24, 0.7f, {0.14f, 0.18f, 0.06f}, {0.13f, 0.10f, 0.07f}};
  }
  return {};
}

// Radius of the crown at height share `h` in [0, 1] of the crown, relative to the largest.
float crown_profile(TreeKind kind, float h) {
  switch (kind) {
    case TreeKind::fir:
      return 1.0f - 0.93f * h;
    case TreeKind::poplar:
      return std::sqrt(std::max(0.0f, std::sin(3.0f * (0.06f + 0.94f * h))));
    default:
      return std::sqrt(std::max(0.0f, 1.0f - (2 * h - 0.85f) * (2 * h - 0.85f) * 0.7f));
  }
}

// A lump of leaves: a ball pressed flat, with bumps whose size does not depend on its fineness.
void add_leaves(Mesh& mesh, int n, const glm::vec3& center, const glm::vec3& radii,
                const glm::vec3& color, float inner_light, std::uint64_t seed) {
  add_blob(mesh, n, [&](const glm::vec3& d) {
    const float bumps = noise(2.2f * d, seed) * 0.22f + noise(6.0f * d, seed + 1) * 0.09f;
    const float light = inner_light * (0.8f + 0.25f * d.y + 0.5f * bumps);
    return BuiltVertex{center + radii * d * (1.0f + bumps), color * light};
  });
}

// A fir's whorl: a cone whose sides sag towards a wavy rim; below it bulges a little.
void add_whorl(Mesh& mesh, int n, const glm::vec3& center, float radius, float height,
               const glm::vec3& color, std::uint64_t seed) {
  add_blob(mesh, n, [&](const glm::vec3& d) {
    const float out = std::sqrt(std::max(0.0f, 1 - d.y * d.y)), angle = std::atan2(d.x, d.z);
    const float reach = out * (1 + 0.16f * std::sin(7 * angle + float(seed % 7)) * out);
    const float y = d.y > 0 ? 1 - out - 0.35f * out * out : -0.35f - 0.15f * (1 - out);
    const float light = d.y > 0 ? 0.75f + 0.35f * out : 0.45f;
    const glm::vec3 flat = out > 1e-4f ? glm::vec3(d.x, 0, d.z) / out : glm::vec3(0);
    return BuiltVertex{center + flat * reach * radius + glm::vec3(0, height * y, 0), color * light};
  });
}

}  // namespace

Mesh make_tree(TreeKind kind, std::uint64_t seed, int triangles) {
  const TreeShape shape = shape_of(kind);
  Random random(combine(seed, int(kind)));
  Mesh mesh;
  mesh.name = shape.name;

  // Trunk and branches: a sixth of the triangles, but a small tree needs few.
  const int branches = kind == TreeKind::fir ? 0 : kind == TreeKind::bush ? 4 : 7;
  const double wood = std::clamp(triangles / 6.0, 60.0, 4000.0) / (branches + 1);
  const int sides = std::clamp(int(std::sqrt(wood / 3)), 4, 24);
  const int rings = std::max(1, int(std::lround(wood / (2 * sides))));
  const float crown_start = shape.crown_bottom * shape.height;
  add_tube(mesh, {0, -0.3f, 0}, {0, shape.height * 0.85f, 0}, shape.trunk_radius,
           shape.trunk_radius * 0.25f, sides, rings, shape.bark);
  for (int i = 0; i < branches; ++i) {
    const float angle = kTwoPi * (float(i) + random.between(-0.3f, 0.3f)) / float(branches);
    const float y = crown_start + random.between(0.0f, 0.3f) * (shape.height - crown_start);
    const float reach = shape.crown_radius * random.between(0.55f, 0.8f);
    add_tube(mesh, {0, y, 0}, {reach * std::sin(angle), y + 0.6f * reach, reach * std::cos(angle)},
             shape.trunk_radius * 0.45f, shape.trunk_radius * 0.15f, sides, rings, shape.bark);
  }

  // Leaves: blobs spread over the crown by a golden-angle spiral, most of them near its surface.
  TriangleBudget budget;
  const double leaves = std::max(0.0, double(triangles) - double(mesh.triangles()));
  // Fewer, finer blobs in a tree of few triangles: 8 * 2^2 is the least that looks round.
  const int count = std::clamp(int(leaves / 60), 6, shape.blobs);
  const float grow = std::cbrt(float(shape.blobs) / float(count));
  for (int i = 0; i < count; ++i) {
    const int n = budget.divide(leaves / count, 8, 0, 2);
    const float h = (float(i) + 0.5f) / float(count);
    const float y = crown_start + h * (shape.height - crown_start);
    const glm::vec3 tint = shape.leaves * random.between(0.88f, 1.12f);
    const std::uint64_t lump = random.next();
    if (kind == TreeKind::fir) {
      const float radius = shape.crown_radius * crown_profile(kind, h);
      const float tall = 2.6f * (shape.height - crown_start) / float(count) + 0.25f;
      add_whorl(mesh, n, {0, y, 0}, radius * random.between(0.92f, 1.05f), tall, tint, lump);
      continue;
    }
    const float angle = 2.39996f * float(i) + random.between(-0.3f, 0.3f);
    const float share = std::sqrt(random.between(0.2f, 1.0f));
    const float radius = std::max(
        0.0f, shape.crown_radius * crown_profile(kind, h) * share - 0.5f * shape.blob_radius);
    const float size = shape.blob_radius * grow * random.between(0.8f, 1.15f);
    const float light = 0.62f + 0.22f * share + 0.25f * h;
    const float top = shape.height - 0.6f * size;
    add_leaves(mesh, n, {radius * std::sin(angle), std::min(y, top), radius * std::cos(angle)},
               size * glm::vec3(1.1f, 0.8f, 1.1f), tint, light, lump);
  }
  return mesh;
}

}  // namespace rilievo
