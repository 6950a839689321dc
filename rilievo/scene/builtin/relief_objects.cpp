// The objects that [Parilov, Stuerzlinger 2002, section 6] measured with: a fern, which hides
// itself many times over; a fish with a fine pattern; a cube with sharp edges. Layered reliefs of
// 512 x 512 texels have 140 000 to 250 000 samples of each (bench/relief_objects.h), as the
// paper's.

#include <algorithm>
#include <cmath>

#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo {
namespace {

// One object of one mesh, and a slow circle around it.
BuiltinScene one_object(Mesh mesh, Material material, const char* name) {
  BuiltinScene built;
  built.scene.name = name;
  material.name = name;
  built.scene.materials.push_back(std::move(material));
  const int model = add_model(built.scene, std::move(mesh), 0);
  add_object(built.scene, name, model, glm::mat4(1.0f));
  finish(built.scene);
  built.path = orbit_path(world_bounds(built.scene), 960);
  return built;
}

// A line that rises, leans out and hangs: position at t in [0, 1] in the plane of `out` and up.
struct Frond {
  glm::vec3 root, out;
  float length, rise, droop;
  [[nodiscard]] glm::vec3 at(float t) const {
    const float away = length * (0.85f * t - 0.12f * t * t);
    return root + away * out + glm::vec3(0, rise * t - droop * t * t, 0);
  }
};

// A leaflet: a pointed blade from `base` along `along`, bent down, its flat side facing `up`.
void add_leaflet(Mesh& mesh, int cells, const glm::vec3& base, const glm::vec3& along,
                 const glm::vec3& up, float length, const glm::vec3& color) {
  const glm::vec3 across = glm::normalize(glm::cross(up, along));
  GridShape shape;
  shape.nu = 2, shape.nv = cells;
  add_grid(mesh, shape, [&](float u, float v) {
    // Teeth along the edges.
    const float teeth = 1 + 0.15f * std::sin(40 * v);
    const float width = 0.084f * length * std::sin(kPi * (0.06f + 0.9f * v)) * teeth;
    const float side = 2 * u - 1;
    const glm::vec3 p = base + along * (length * v) + across * (width * side) +
                        up * (0.12f * length * std::abs(side) * 0.3f - 0.18f * length * v * v);
    return BuiltVertex{p, color * (0.75f + 0.35f * v - 0.2f * (1 - std::abs(side)))};
  });
}

}  // namespace

BuiltinScene make_fern(std::uint64_t triangles, std::uint64_t seed) {
  constexpr int kFronds = 14, kPairs = 26;
  Random random(combine(seed, 4711));
  Mesh mesh;
  mesh.name = "fern";
  // Each frond is a stalk and pairs of leaflets of 4 cells triangles each.
  const int sides = 5, rings = 14;
  const double stalks = double(kFronds) * 2 * sides * rings;
  const int cells = std::max(
      2, int(std::lround((double(triangles) - stalks) / (double(kFronds) * kPairs * 2 * 4))));
  for (int i = 0; i < kFronds; ++i) {
    const float angle = 2.39996f * float(i) + random.between(-0.2f, 0.2f);
    const float inner = float(i) / kFronds;  // the inner fronds stand steeper
    Frond frond;
    frond.out = {std::sin(angle), 0, std::cos(angle)};
    frond.root = 0.02f * frond.out;
    frond.length = random.between(0.85f, 1.1f) * (1 - 0.35f * inner);
    frond.rise = random.between(0.9f, 1.1f) * (0.55f + 0.6f * inner);
    frond.droop = frond.rise * random.between(0.55f, 0.75f) * (1 - 0.4f * inner);
    const glm::vec3 tint = glm::vec3(0.075f, 0.20f, 0.045f) * random.between(0.8f, 1.35f);
    GridShape stalk;
    stalk.nu = sides, stalk.nv = rings, stalk.closed_u = true;
    const glm::vec3 side = glm::cross(frond.out, glm::vec3(0, 1, 0));
    add_grid(mesh, stalk, [&](float u, float v) {
      const float turn = 2 * kPi * u, radius = 0.008f * (1.1f - v);
      return BuiltVertex{
          frond.at(v) + radius * (std::cos(turn) * side + glm::vec3(0, std::sin(turn), 0)),
          {0.14f, 0.15f, 0.05f}};
    });
    for (int pair = 0; pair < kPairs; ++pair) {
      const float t = 0.12f + 0.87f * float(pair) / float(kPairs - 1);
      const glm::vec3 base = frond.at(t);
      const glm::vec3 ahead = glm::normalize(frond.at(t + 0.01f) - frond.at(t - 0.01f));
      const float length =
          0.24f * frond.length * std::pow(std::sin(kPi * (0.18f + 0.80f * t)), 0.8f);
      for (const float way : {-1.0f, 1.0f}) {
        const glm::vec3 along = glm::normalize(way * side + 0.35f * ahead +
                                               glm::vec3(0, random.between(-0.15f, 0.1f), 0));
        const glm::vec3 flat =
            glm::normalize(way * glm::cross(along, ahead) * -1.0f + 0.1f * glm::vec3(0, 1, 0));
        // Twisted, one to the left and the next to the right, else it has twice as many samples
        // from above as from beside.
        const float twist = way * (pair % 2 ? 1.0f : -1.0f) * random.between(0.6f, 0.9f);
        const glm::vec3 up = std::cos(twist) * (flat.y < 0 ? -flat : flat) +
                             std::sin(twist) * glm::cross(along, flat);
        add_leaflet(mesh, cells, base, along, up, length, tint * random.between(0.85f, 1.15f));
      }
    }
  }
  Material material;
  material.double_sided = true;
  material.roughness = 0.7f;
  return one_object(std::move(mesh), std::move(material), "fern");
}

BuiltinScene make_fish(std::uint64_t triangles, std::uint64_t) {
  Mesh mesh;
  mesh.name = "fish";
  // Body: nu by nv cells with a pole at each end, nv = nu; five fins of a tenth of the rest each.
  const int nu = std::max(8, int(std::lround(std::sqrt(double(triangles) * 0.4))));
  const int n = std::max(2, int(std::lround(std::sqrt(double(triangles) * 0.2 / 5 / 2))));
  // Round, so that it covers enough of a picture from all sides.
  const auto half_height = [](float v) {
    return 0.6f * std::pow(std::max(0.0f, std::sin(kPi * std::pow(v, 0.8f))), 0.65f) *
               (1 - 0.28f * v) +
           0.05f * v * (1 - v);
  };
  // Scales in rows, stripes across, an eye: fine detail everywhere.
  const auto paint = [&](float v, float height) {
    const float row = 46 * v, column = 30 * height + 0.5f * std::floor(row);
    const float du = row - std::floor(row) - 0.5f, dv = column - std::floor(column) - 0.5f;
    const float scale =
        0.65f + 0.5f * std::clamp(1.1f - 2.4f * std::sqrt(du * du + dv * dv), 0.0f, 1.0f);
    const float stripe = 0.5f + 0.5f * std::sin(26 * v + 3 * height * height);
    glm::vec3 color =
        glm::mix(glm::vec3(0.75f, 0.30f, 0.06f), glm::vec3(0.85f, 0.80f, 0.65f), stripe);
    color = glm::mix(color, glm::vec3(0.9f, 0.85f, 0.75f), std::clamp(-1.5f * height, 0.0f, 1.0f));
    const glm::vec2 eye = glm::vec2(v - 0.11f, 0.25f * (height - 0.25f)) / 0.028f;
    const float r = glm::length(eye);
    if (r < 0.55f) return glm::vec3(0.01f);
    if (r < 1) return glm::vec3(0.9f, 0.85f, 0.4f);
    return color * scale;
  };
  GridShape body;
  body.nu = nu, body.nv = nu, body.closed_u = true;
  body.pole_at_start = body.pole_at_end = true;
  add_grid(mesh, body, [&](float u, float v) {
    const float turn = 2 * kPi * u, h = half_height(v);
    const float y = std::sin(turn), z = -std::cos(turn);
    return BuiltVertex{{2 * v - 1, h * y, 0.88f * h * z}, paint(v, y)};
  });
  // Fins: fans with rays, from a line on the body outwards.
  const auto fin = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& tip_a,
                       const glm::vec3& tip_b) {
    GridShape shape;
    shape.nu = n, shape.nv = n;
    add_grid(mesh, shape, [&](float u, float v) {
      const glm::vec3 p = glm::mix(glm::mix(a, b, u), glm::mix(tip_a, tip_b, u), v);
      const float ray = 0.6f + 0.4f * std::abs(std::sin(36 * u));
      return BuiltVertex{p + glm::vec3(0, 0, 0.02f * v * std::sin(20 * u)),
                         glm::vec3(0.8f, 0.35f, 0.1f) * ray * (1 - 0.4f * v)};
    });
  };
  fin({0.9f, 0.08f, 0}, {0.9f, -0.08f, 0}, {1.22f, 0.55f, 0}, {1.22f, -0.55f, 0});
  fin({-0.45f, 0.48f, 0}, {0.6f, 0.24f, 0}, {-0.2f, 0.84f, 0}, {0.85f, 0.6f, 0});
  fin({0.1f, -0.42f, 0}, {0.6f, -0.18f, 0}, {0.3f, -0.81f, 0}, {0.85f, -0.6f, 0});
  for (const float side : {-1.0f, 1.0f})
    fin({-0.45f, -0.02f, 0.45f * side}, {-0.25f, -0.16f, 0.45f * side},
        {-0.25f, -0.05f, 0.82f * side}, {0.35f, -0.25f, 0.74f * side});
  Material material;
  material.double_sided = true;
  material.roughness = 0.5f;
  return one_object(std::move(mesh), std::move(material), "fish");
}

BuiltinScene make_cube(std::uint64_t triangles, std::uint64_t) {
  Mesh mesh;
  mesh.name = "cube";
  const int n = std::max(1, int(std::lround(std::sqrt(double(triangles) / 12))));
  constexpr glm::vec3 kPaints[6] = {{0.75f, 0.16f, 0.12f}, {0.85f, 0.75f, 0.25f},
                                    {0.15f, 0.35f, 0.70f}, {0.80f, 0.45f, 0.10f},
                                    {0.20f, 0.55f, 0.25f}, {0.70f, 0.70f, 0.72f}};
  for (int face = 0; face < 6; ++face) {
    // A piece of its own: normals are not smoothed over the edges.
    BoxShape shape{glm::ivec3(n), false, false, false, false, false, false};
    bool* const sides[6] = {&shape.left, &shape.right, &shape.bottom,
                            &shape.top,  &shape.back,  &shape.front};
    *sides[face] = true;
    const glm::vec3 paint = kPaints[face];
    add_box(mesh, shape, [&](const glm::vec3& cube) { return BuiltVertex{0.5f * cube, paint}; });
  }
  Material material;
  material.roughness = 0.9f;
  return one_object(std::move(mesh), std::move(material), "cube");
}

}  // namespace rilievo
