#include "rilievo/scene/polygons/polygon_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

#include "rilievo/core/expects.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

// For every position, the first one with the same coordinates: files repeat them at will.
std::vector<std::uint32_t> same_place(const PolygonSoup& soup) {
  std::vector<std::uint32_t> order(soup.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t k) {
    const glm::vec3 a = soup.place(i), b = soup.place(k);
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    if (a.z != b.z) return a.z < b.z;
    return i < k;
  });
  std::vector<std::uint32_t> first(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && soup.place(order[k]) == soup.place(order[k - 1]);
    first[order[k]] = same ? first[order[k - 1]] : order[k];
  }
  return first;
}

// Corners around each place: those of place p are corners[begin[p] ... begin[p + 1]).
struct Around {
  std::vector<std::uint32_t> begin, corners;
};

Around corners_around(const PolygonSoup& soup, const std::vector<std::uint32_t>& place) {
  Around around;
  around.begin.assign(place.size() + 1, 0);
  for (const Corner& c : soup.triangles) ++around.begin[place[c.position] + 1];
  std::partial_sum(around.begin.begin(), around.begin.end(), around.begin.begin());
  around.corners.resize(soup.triangles.size());
  std::vector<std::uint32_t> next(around.begin.begin(), around.begin.end() - 1);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    around.corners[next[place[soup.triangles[i].position]]++] = std::uint32_t(i);
  return around;
}

// Twice each triangle's area along its normal.
std::vector<glm::dvec3> area_normals(const PolygonSoup& soup) {
  std::vector<glm::dvec3> normals(soup.parts.size());
  for (std::size_t t = 0; t < normals.size(); ++t) {
    glm::dvec3 p[3];
    for (int k = 0; k < 3; ++k) p[k] = glm::dvec3(soup.place(soup.triangles[3 * t + k].position));
    normals[t] = glm::cross(p[1] - p[0], p[2] - p[0]);
  }
  return normals;
}

struct HashCorner {
  std::size_t operator()(const Corner& c) const {
    std::uint64_t h = c.position * 0x9E3779B97F4A7C15u;
    h = (h ^ h >> 32 ^ c.uv) * 0xBF58476D1CE4E5B9u;
    h = (h ^ h >> 29 ^ c.normal) * 0x94D049BB133111EBu;
    h = (h ^ h >> 31 ^ c.color) * 0x9E3779B97F4A7C15u;
    return h ^ h >> 32;
  }
};

// Does a triangle's normal `n` count for the corner of one with the normal `own`, at one place?
bool smooths(const glm::dvec3& own, std::uint32_t own_group, const glm::dvec3& n,
             std::uint32_t group) {
  // cos 45 degrees: an octagonal prism's sides just come out smooth, a box's edges sharp.
  constexpr double kCrease = 0.70710678;
  // Of a group all count, but for the back of a sheet that has two sides.
  constexpr double kOpposite = -0.999;
  if (own_group != group || group == PolygonSoup::kFlat) return false;
  const double cosine = glm::dot(n, own), lengths = glm::length(own) * glm::length(n);
  return group == PolygonSoup::kCreased ? cosine >= kCrease * lengths
                                        : cosine >= kOpposite * lengths;
}

}  // namespace

bool is_finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

const Corner* corner_that_is_not_finite(const PolygonSoup& soup, std::span<const Corner> polygon) {
  for (const Corner& c : polygon)
    if (!is_finite(glm::vec3(soup.positions[c.position]))) return &c;
  return nullptr;
}

void add_missing_normals(PolygonSoup& soup, MemoryBudget& budget) {
  for (glm::dvec3& p : soup.positions)
    if (!is_finite(glm::vec3(p))) p = soup.origin;
  const auto bare = [](const Corner& c) { return c.normal == Corner::kNone; };
  if (std::none_of(soup.triangles.begin(), soup.triangles.end(), bare)) return;
  budget.borrow(soup.positions.size(), 4 * sizeof(std::uint32_t));
  budget.borrow(soup.triangles.size(), sizeof(std::uint32_t) + sizeof(glm::dvec3));

  const auto group_of = [&](std::size_t triangle) {
    return soup.smoothing.empty() ? PolygonSoup::kCreased : soup.smoothing[triangle];
  };
  // Places where more triangles meet than this (the tip of a fan) are smooth all around, but for
  // flat triangles and other groups: comparing all pairs there would take forever.
  constexpr std::size_t kMaxCount = 64;
  const std::vector<glm::dvec3> normal = area_normals(soup);
  const Around around = corners_around(soup, same_place(soup));
  std::vector<std::pair<glm::vec3, std::uint32_t>> made;  // at one place
  std::map<std::uint32_t, glm::dvec3> group_normals;      // the sums at a crowded place
  for (std::size_t p = 0; p + 1 < around.begin.size(); ++p) {
    const std::span<const std::uint32_t> here(around.corners.data() + around.begin[p],
                                              around.begin[p + 1] - around.begin[p]);
    made.clear();
    const bool crowded = here.size() > kMaxCount;
    group_normals.clear();
    if (crowded)
      for (std::uint32_t other : here) group_normals[group_of(other / 3)] += normal[other / 3];
    for (std::uint32_t corner : here) {
      if (!bare(soup.triangles[corner])) continue;
      const glm::dvec3& own = normal[corner / 3];
      const std::uint32_t group = group_of(corner / 3);
      glm::dvec3 sum = own;
      if (crowded && group != PolygonSoup::kFlat) {
        sum = group_normals[group];
      } else if (group != PolygonSoup::kFlat) {
        sum = glm::dvec3(0.0);
        for (std::uint32_t other : here)
          if (smooths(own, group, normal[other / 3], group_of(other / 3))) sum += normal[other / 3];
      }
      const glm::vec3 mean = unit_or_up(sum);
      // Only the last few are looked for: at crowded places all may be flat.
      const std::size_t looked = std::min<std::size_t>(made.size(), kMaxCount);
      auto known = std::find_if(made.end() - std::ptrdiff_t(looked), made.end(),
                                [&](const auto& m) { return m.first == mean; });
      if (known == made.end()) {
        budget.take(sizeof(glm::vec3));
        made.emplace_back(mean, std::uint32_t(soup.normals.size()));
        soup.normals.push_back(mean);
        known = made.end() - 1;
      }
      soup.triangles[corner].normal = known->second;
    }
  }
}

std::vector<Mesh> weld(const PolygonSoup& soup, std::size_t parts, MemoryBudget& budget) {
  std::vector<Mesh> meshes(parts);
  std::vector<std::unordered_map<Corner, std::uint32_t, HashCorner>> vertices(parts);
  // A vertex, its place in the map, and what vectors keep in reserve.
  const std::size_t each = 2 * (sizeof(glm::vec3) * 2 + (soup.uv.empty() ? 0 : sizeof(glm::vec2)) +
                                (soup.colors.empty() ? 0 : sizeof(glm::vec4))) +
                           sizeof(Corner) + 32;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const Corner& c = soup.triangles[i];
    RILIEVO_EXPECTS(c.normal != Corner::kNone);
    const std::uint32_t part = soup.parts[i / 3];
    Mesh& mesh = meshes[part];
    const auto [at, fresh] = vertices[part].try_emplace(c, std::uint32_t(mesh.positions.size()));
    if (fresh) {
      budget.take(each);
      mesh.positions.push_back(soup.place(c.position));
      mesh.normals.push_back(soup.normals[c.normal]);
      if (!soup.uv.empty())
        mesh.uv[0].push_back(c.uv == Corner::kNone ? glm::vec2(0) : soup.uv[c.uv]);
      if (!soup.colors.empty())
        mesh.colors.push_back(soup.colors[c.color == Corner::kNone ? c.position : c.color]);
    }
    budget.take(2 * sizeof(std::uint32_t));
    mesh.indices.push_back(at->second);
  }
  return meshes;
}

}  // namespace rilievo
