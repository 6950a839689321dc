#include "rilievo/scene/builtin/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace rilievo {
namespace {

std::uint32_t add_vertex(Mesh& mesh, const BuiltVertex& vertex) {
  mesh.positions.push_back(vertex.position);
  mesh.normals.push_back(glm::vec3(0.0f));
  mesh.colors.push_back(glm::vec4(vertex.color, 1.0f));
  return std::uint32_t(mesh.positions.size() - 1);
}

// Adds a triangle and its area vector to the normals of its corners; none if two corners are one.
void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (a == b || b == c || c == a) return;
  mesh.indices.insert(mesh.indices.end(), {a, b, c});
  const glm::vec3& p = mesh.positions[a];
  const glm::vec3 area = glm::cross(mesh.positions[b] - p, mesh.positions[c] - p);
  for (std::uint32_t i : {a, b, c}) mesh.normals[i] += area;
}

// The diagonal starts at a.
void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

void normalize_normals(Mesh& mesh, std::size_t first) {
  for (std::size_t i = first; i < mesh.normals.size(); ++i) {
    const float length = glm::length(mesh.normals[i]);
    mesh.normals[i] = length > 0 ? mesh.normals[i] / length : glm::vec3(0, 1, 0);
  }
}

// -1 ... 1 at grid line i of n.
float grid_line(int i, int n) { return 2.0f * float(i) / float(n) - 1.0f; }

}  // namespace

void add_grid(Mesh& mesh, const GridShape& shape,
              const std::function<BuiltVertex(float u, float v)>& place) {
  const std::size_t first = mesh.positions.size();
  const int columns = shape.nu + (shape.closed_u ? 0 : 1);
  const int rows = shape.nv + (shape.closed_v ? 0 : 1);
  std::vector<std::uint32_t> row_start(std::size_t(rows), 0);
  std::vector<bool> pole(std::size_t(rows), false);
  pole.front() = shape.pole_at_start;
  if (shape.pole_at_end) pole.back() = true;
  for (int r = 0; r < rows; ++r) {
    row_start[r] = std::uint32_t(mesh.positions.size());
    for (int c = 0; c < (pole[r] ? 1 : columns); ++c)
      add_vertex(mesh, place(float(c) / float(shape.nu), float(r) / float(shape.nv)));
  }
  const auto at = [&](int c, int r) {
    r = shape.closed_v ? r % rows : r;
    return row_start[r] + (pole[r] ? 0u : std::uint32_t(shape.closed_u ? c % columns : c));
  };
  for (int r = 0; r < shape.nv; ++r)
    for (int c = 0; c < shape.nu; ++c)
      add_quad(mesh, at(c, r), at(c + 1, r), at(c + 1, r + 1), at(c, r + 1));
  normalize_normals(mesh, first);
}

void add_blob(Mesh& mesh, int n,
              const std::function<BuiltVertex(const glm::vec3& direction)>& place) {
  // An octahedron, each face cut into n^2 triangles: ring k = 0 ... 2n from the top to the bottom,
  // 4 min(k, 2n - k) vertices each, one at the poles. Seen from above the rings run
  // counter-clockwise: +z, +x, -z, -x.
  const std::size_t first = mesh.positions.size();
  const glm::vec3 corners[4] = {{0, 0, 1}, {1, 0, 0}, {0, 0, -1}, {-1, 0, 0}};
  const auto side = [&](int k) { return std::min(k, 2 * n - k); };
  std::vector<std::uint32_t> ring(std::size_t(2 * n + 1));
  for (int k = 0; k <= 2 * n; ++k) {
    ring[k] = std::uint32_t(mesh.positions.size());
    const int m = side(k);
    const float y = 1.0f - float(k) / float(n);
    if (m == 0) add_vertex(mesh, place({0, y, 0}));
    for (int i = 0; i < 4 * m; ++i) {
      const float t = float(i % m) / float(m);
      const glm::vec3 around = glm::mix(corners[i / m], corners[(i / m + 1) % 4], t);
      add_vertex(mesh, place(glm::normalize(glm::vec3(0, y, 0) + (1 - std::abs(y)) * around)));
    }
  }
  const auto at = [&](int k, int i) {
    const int m = side(k);
    return ring[k] + (m == 0 ? 0u : std::uint32_t(i % (4 * m)));
  };
  for (int k = 0; k < n; ++k)
    for (int q = 0; q < 4; ++q)
      for (int i = 0; i <= k; ++i) {
        // The upper half, and its mirror image with the opposite turn.
        const int in = q * k + i, out = q * (k + 1) + i, low = 2 * n - k;
        add_triangle(mesh, at(k, in), at(k + 1, out), at(k + 1, out + 1));
        add_triangle(mesh, at(low, in), at(low - 1, out + 1), at(low - 1, out));
        if (i == k) continue;
        add_triangle(mesh, at(k, in), at(k + 1, out + 1), at(k, in + 1));
        add_triangle(mesh, at(low, in), at(low, in + 1), at(low - 1, out + 1));
      }
  normalize_normals(mesh, first);
}

int BoxShape::triangles() const {
  return 2 * ((int(left) + int(right)) * n.y * n.z + (int(bottom) + int(top)) * n.z * n.x +
              (int(back) + int(front)) * n.x * n.y);
}

void add_box(Mesh& mesh, const BoxShape& shape,
             const std::function<BuiltVertex(const glm::vec3& cube)>& place) {
  const std::size_t first = mesh.positions.size();
  constexpr std::uint32_t kNone = ~0u;
  const glm::ivec3 n = shape.n, points = n + 1;
  std::vector<std::uint32_t> index(std::size_t(points.x) * points.y * points.z, kNone);
  const auto at = [&](const glm::ivec3& p) {
    std::uint32_t& i = index[(std::size_t(p.z) * points.y + p.y) * points.x + p.x];
    if (i == kNone)
      i = add_vertex(mesh, place({grid_line(p.x, n.x), grid_line(p.y, n.y), grid_line(p.z, n.z)}));
    return i;
  };
  const bool wanted[3][2] = {
      {shape.left, shape.right}, {shape.bottom, shape.top}, {shape.back, shape.front}};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;  // u x v points along +axis
    for (int positive = 0; positive < 2; ++positive) {
      if (!wanted[axis][positive]) continue;
      for (int j = 0; j < n[v]; ++j)
        for (int i = 0; i < n[u]; ++i) {
          glm::ivec3 p{0};
          p[axis] = positive ? n[axis] : 0;
          const auto corner = [&](int du, int dv) {
            glm::ivec3 q = p;
            q[u] = i + du, q[v] = j + dv;
            return at(q);
          };
          // One after the other: each may add a vertex, and arguments of one call have no order.
          const std::uint32_t last = positive ? corner(0, 1) : corner(1, 0);
          const std::uint32_t opposite = corner(1, 1);
          const std::uint32_t second = positive ? corner(1, 0) : corner(0, 1);
          add_quad(mesh, corner(0, 0), second, opposite, last);
        }
    }
  }
  normalize_normals(mesh, first);
}

glm::vec3 rounded_box(const glm::vec3& cube, const glm::vec3& half, float radius,
                      const glm::ivec3& n) {
  glm::vec3 p = cube * half;
  for (int k = 0; k < 3; ++k) {
    // The grid lines next to the rim move to where the rounding begins.
    const float inner = half[k] - radius, rim = grid_line(n[k] - 1, n[k]);
    if (n[k] >= 3 && std::abs(cube[k]) <= rim + 1e-4f) p[k] = cube[k] / rim * inner;
  }
  const glm::vec3 core = glm::clamp(p, radius - half, half - radius);
  const glm::vec3 out = p - core;
  const float length = glm::length(out);
  return length > 0 ? core + out * (radius / length) : p;
}

void add_tube(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, float ra, float rb, int sides,
              int rings, const glm::vec3& color) {
  const glm::vec3 axis = glm::normalize(b - a);
  const glm::vec3 other = std::abs(axis.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 x = glm::normalize(glm::cross(other, axis)), y = glm::cross(axis, x);
  GridShape shape;
  shape.nu = sides, shape.nv = rings, shape.closed_u = true;
  add_grid(mesh, shape, [&](float u, float v) {
    const float angle = 6.2831853f * u;
    return BuiltVertex{
        glm::mix(a, b, v) + glm::mix(ra, rb, v) * (std::cos(angle) * x + std::sin(angle) * y),
        color};
  });
}

int TriangleBudget::divide(double wanted, double square, double linear, int least) {
  const double target = std::max(wanted + owed_, 0.0);
  const double root = (std::sqrt(linear * linear + 4 * square * target) - linear) / (2 * square);
  const int n = std::max(least, int(std::lround(root)));
  owed_ += wanted - (square * n + linear) * n;
  return n;
}

int add_model(Scene& scene, Mesh mesh, int material) {
  mesh.material = material;
  Model model;
  model.name = mesh.name;
  model.parts.push_back({int(scene.meshes.size()), glm::mat4(1.0f)});
  scene.meshes.push_back(std::move(mesh));
  scene.models.push_back(std::move(model));
  return int(scene.models.size()) - 1;
}

void add_object(Scene& scene, std::string name, int model, const glm::mat4& world_from_model) {
  Object object;
  object.name = std::move(name);
  object.model = model;
  object.placement = world_from_model;
  scene.objects.push_back(std::move(object));
}

}  // namespace rilievo
