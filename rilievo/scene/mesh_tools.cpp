#include "rilievo/scene/mesh_tools.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

template <int N>
bool finite(const glm::vec<N, float>& v) {
  for (int i = 0; i < N; ++i)
    if (!std::isfinite(v[i])) return false;
  return true;
}

// Twice the area along the normal. Doubles: floats overflow from 1e19 metres and vanish below
// 1e-19.
glm::dvec3 area_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
}

template <class T>
void unweld(std::vector<T>& values, const std::vector<std::uint32_t>& indices) {
  if (values.empty()) return;
  std::vector<T> out(indices.size());
  for (std::size_t i = 0; i < indices.size(); ++i) out[i] = values[indices[i]];
  values = std::move(out);
}

template <class T>
void repair(std::vector<T>& values, const T& with, std::size_t& repaired) {
  for (T& v : values)
    if (!finite(v)) v = with, ++repaired;
}

}  // namespace

glm::vec3 unit_or_none(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? glm::vec3(v / length) : glm::vec3(0);
}

glm::vec3 unit_or_up(const glm::dvec3& v) {
  const glm::vec3 unit = unit_or_none(v);
  return unit == glm::vec3(0) ? glm::vec3(0, 1, 0) : unit;
}

void make_flat(Mesh& mesh) {
  unweld(mesh.positions, mesh.indices);
  unweld(mesh.uv[0], mesh.indices);
  unweld(mesh.uv[1], mesh.indices);
  unweld(mesh.colors, mesh.indices);
  mesh.tangents.clear();
  mesh.normals.resize(mesh.indices.size());
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) mesh.indices[i] = std::uint32_t(i);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::vec3 normal =
        unit_or_up(area_normal(mesh.positions[i], mesh.positions[i + 1], mesh.positions[i + 2]));
    for (std::size_t k = 0; k < 3; ++k) mesh.normals[i + k] = normal;
  }
}

void repair_normals(Mesh& mesh) {
  RILIEVO_EXPECTS_EQ(mesh.normals.size(), mesh.positions.size());
  bool good = true;
  for (glm::vec3& n : mesh.normals) {
    const float length = glm::length(n);
    const bool usable = std::isfinite(length) && length > 1e-12f;
    n = usable ? n / length : glm::vec3(0);
    good = good && usable;
  }
  if (good) return;

  std::vector<glm::dvec3> mean(mesh.positions.size(), glm::dvec3(0));
  const std::size_t end = mesh.triangles() * 3;  // points and lines have none of their own
  for (std::size_t i = 0; i < end; i += 3) {
    const std::uint32_t* const v = &mesh.indices[i];
    const glm::dvec3 n =
        area_normal(mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]);
    for (int k = 0; k < 3; ++k) mean[v[k]] += n;
  }
  for (std::size_t i = 0; i < mean.size(); ++i)
    if (mesh.normals[i] == glm::vec3(0)) mesh.normals[i] = unit_or_up(mean[i]);
}

std::size_t repair_attributes(Mesh& mesh) {
  std::size_t repaired = 0;
  repair(mesh.uv[0], glm::vec2(0), repaired);
  repair(mesh.uv[1], glm::vec2(0), repaired);
  repair(mesh.colors, glm::vec4(1), repaired);
  repair(mesh.tangents, glm::vec4(1, 0, 0, 1), repaired);
  return repaired;
}

void flip_winding(Mesh& mesh) {
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
}

}  // namespace rilievo
