#include "rilievo/scene/point_size.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

constexpr float kCloses = 1.6f, kMostOfCloud = 0.01f;

// The lowest 21 bits, with two zeros behind each.
std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffffu;
  v = (v | v << 16) & 0x001f0000ff0000ffu;
  v = (v | v << 8) & 0x100f00f00f00f00fu;
  v = (v | v << 4) & 0x10c30c30c30c30c3u;
  return (v | v << 2) & 0x1249249249249249u;
}

// The place on the curve of a point in the box of `min` whose longest side is 1 / scale.
std::uint64_t curve_place(const glm::vec3& p, const glm::vec3& min, double scale) {
  constexpr double kCells = 2097151;  // 2^21 - 1
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis)
    code |= spread_bits(std::uint64_t(kCells * scale * (double(p[axis]) - double(min[axis]))))
            << axis;
  return code;
}

Box box_of(const Mesh& mesh) {
  Box box;
  for (const std::uint32_t i : mesh.indices) box.add(mesh.positions[i]);
  return box;
}

template <class T>
void take(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  if (values.empty()) return;
  std::vector<T> taken(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) taken[i] = values[order[i]];
  values = std::move(taken);
}

// How the first object that shows a mesh stretches it least; 1 if none does.
std::vector<double> stretch_of_meshes(const Scene& scene) {
  std::vector<glm::mat4> poses;
  pose(scene, 0, poses);
  std::vector<double> stretch(scene.meshes.size(), 0);
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    for (const Part& part : scene.models[std::size_t(scene.objects[i].model)].parts) {
      double& of_mesh = stretch[std::size_t(part.mesh)];
      if (of_mesh == 0) of_mesh = smallest_stretch(poses[i] * part.model_from_mesh);
    }
  for (double& s : stretch)
    if (s == 0) s = 1;
  return stretch;
}

// A mesh's points alone, in the order of the curve.
Mesh sorted_places(const Mesh& mesh) {
  Mesh places;
  places.primitive = Primitive::points;
  places.positions = mesh.positions, places.indices = mesh.indices;
  sort_points(places);
  return places;
}

// Points and lines show no transparency.
void use_opaque_materials(Scene& scene) {
  std::map<int, int> opaque;
  for (Mesh& mesh : scene.meshes) {
    if (mesh.primitive == Primitive::triangles || mesh.material < 0) continue;
    const Material& from = scene.materials[std::size_t(mesh.material)];
    if (from.alpha_mode == AlphaMode::opaque) continue;
    const auto [known, fresh] = opaque.try_emplace(mesh.material, int(scene.materials.size()));
    if (fresh) {
      Material material = from;
      material.alpha_mode = AlphaMode::opaque;
      scene.materials.push_back(std::move(material));
    }
    mesh.material = known->second;
  }
}

}  // namespace

std::optional<PointSize> parse_point_size(std::string_view text) {
  if (text == "auto") return PointSize{};
  const bool pixels = text.ends_with("px");
  if (pixels) text.remove_suffix(2);
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!std::isfinite(value) || !(value > 0)) return std::nullopt;
  return pixels ? PointSize{0, value} : PointSize{value, 0};
}

void sort_points(Mesh& mesh) {
  RILIEVO_EXPECTS(mesh.primitive == Primitive::points);
  const Box box = box_of(mesh);
  if (box.empty()) return;
  const glm::vec3 extent = box.extent();
  const float longest = std::max({extent.x, extent.y, extent.z});
  const double scale = longest > 0 ? 1 / double(longest) : 0;
  struct Place {
    std::uint64_t code;
    std::uint32_t vertex;
    bool operator<(const Place& other) const {
      return code != other.code ? code < other.code : vertex < other.vertex;
    }
  };
  std::vector<Place> places(mesh.indices.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = {curve_place(mesh.positions[mesh.indices[i]], box.min, scale), mesh.indices[i]};
  std::sort(places.begin(), places.end());
  for (std::size_t i = 0; i < places.size(); ++i) mesh.indices[i] = places[i].vertex;
  places = {};
  take(mesh.positions, mesh.indices);
  take(mesh.normals, mesh.indices);
  take(mesh.tangents, mesh.indices);
  for (std::vector<glm::vec2>& uv : mesh.uv) take(uv, mesh.indices);
  take(mesh.colors, mesh.indices);
  std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
}

float point_diameter(const Mesh& mesh) {
  // Neighbours are sought along the curve: most of the nearest are not farther away on it.
  constexpr std::size_t kSamples = 1000, kReach = 128, kNearest = 6;
  const std::size_t count = mesh.indices.size();
  if (count < 2) return 0;
  std::vector<float> found, around;
  const std::size_t samples = std::min(kSamples, count);
  for (std::size_t k = 0; k < samples; ++k) {
    const std::size_t i = k * count / samples;
    const glm::vec3& p = mesh.positions[mesh.indices[i]];
    around.clear();
    for (std::size_t j = i - std::min(i, kReach); j < std::min(count, i + kReach + 1); ++j) {
      const float distance = glm::length(mesh.positions[mesh.indices[j]] - p);
      if (distance > 0) around.push_back(distance);  // files have points twice
    }
    if (around.empty()) continue;
    const std::size_t at = std::min(kNearest, around.size()) - 1;
    std::nth_element(around.begin(), around.begin() + std::ptrdiff_t(at), around.end());
    found.push_back(around[at]);
  }
  if (found.empty()) return 0;
  std::nth_element(found.begin(), found.begin() + std::ptrdiff_t(found.size() / 2), found.end());
  return std::min(kCloses * found[found.size() / 2], kMostOfCloud * 2 * box_of(mesh).radius());
}

void finish_points(Scene& scene, const PointSize& size, std::span<const int> bent) {
  std::vector<double> stretch;
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    Mesh& mesh = scene.meshes[i];
    if (mesh.primitive != Primitive::points) continue;
    const bool sorted = std::find(bent.begin(), bent.end(), int(i)) == bent.end();
    if (sorted) sort_points(mesh);
    constexpr float kSinglePoint = 4;  // pixels
    mesh.width = 0, mesh.width_px = size.pixels > 0 ? size.pixels : kSinglePoint;
    if (size.pixels > 0) continue;
    if (stretch.empty()) stretch = stretch_of_meshes(scene);
    if (size.metres > 0)
      mesh.width = float(double(size.metres) / stretch[i]);
    else
      mesh.width = sorted ? point_diameter(mesh) : point_diameter(sorted_places(mesh));
    if (!std::isfinite(mesh.width)) mesh.width = 0;
  }
  use_opaque_materials(scene);
}

}  // namespace rilievo
