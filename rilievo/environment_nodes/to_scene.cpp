// Along an edge of L texels whose ends are w and w' deep, the texel at a share s of its length in
// space is the one at the share s w' / ((1 - s) w + s w') of its picture. The two differ by at most
// (sqrt(r) - 1) / (sqrt(r) + 1), r = w' / w: where s has the square root of the ratio.
#include "rilievo/environment_nodes/to_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {
namespace {

// Direction of the node's space and disparity; where on the face it takes its colour, texels.
struct Corner {
  glm::vec4 place;
  glm::vec2 texel;
};

struct Triangle {
  Corner corner[3];
  int face = 0;
  // May edge k, from corner k to the next one, be halved? Those of surfaces, and of skins those
  // that they share with surfaces: what a skin shows within itself is nobody's texel.
  bool halved[3] = {true, true, true};
};

using Place = std::tuple<float, float, float, float>;
Place place_of(const Corner& c) { return {c.place.x, c.place.y, c.place.z, c.place.w}; }
using Edge = std::pair<Place, Place>;
Edge edge_of(const Corner& a, const Corner& b) {
  const Place p = place_of(a), q = place_of(b);
  return p < q ? Edge{p, q} : Edge{q, p};
}
// Edge k of a triangle.
Edge edge_of(const Triangle& t, int k) { return edge_of(t.corner[k], t.corner[(k + 1) % 3]); }

// From the node.
glm::dvec3 point_of(const Corner& c) { return glm::dvec3(c.place) / double(c.place.w); }
double length_of(const Triangle& t, int k) {
  return glm::distance(point_of(t.corner[k]), point_of(t.corner[(k + 1) % 3]));
}

// Has it no area but by rounding?
bool is_flat(const Triangle& t) {
  const glm::dvec3 a = point_of(t.corner[0]), b = point_of(t.corner[1]), c = point_of(t.corner[2]);
  const double longest = std::max({length_of(t, 0), length_of(t, 1), length_of(t, 2)});
  return glm::length(glm::cross(b - a, c - a)) <= 1e-6 * glm::length(a) * longest;
}

glm::vec2 texel_of(int f, const glm::vec3& direction, int n) {
  const FaceAxes& axes = face_axes()[std::size_t(f)];
  const float depth = glm::dot(direction, glm::vec3(axes.forward));
  const glm::vec2 along(glm::dot(direction, glm::vec3(axes.right)) / depth,
                        -glm::dot(direction, glm::vec3(axes.up)) / depth);
  return 0.5f * float(n) * glm::clamp(1.0f + along, 0.0f, 2.0f);
}

// The same from both ends.
Corner middle(const Corner& a, const Corner& b) {
  return {0.5f * (a.place + b.place), 0.5f * (a.texel + b.texel)};
}

// Lengths are those of directions, which a skin shares with its surfaces; `most` in their units.
double wrong_by(const Corner& a, const Corner& b) {
  const double low = std::min(a.place.w, b.place.w), high = std::max(a.place.w, b.place.w);
  const double root = std::sqrt(high / low);
  return double(glm::distance(glm::vec3(a.place), glm::vec3(b.place))) * (root - 1) / (root + 1);
}

// Halves the worst edge again and again; whatever the order, an edge ends in the same pieces.
void divide(const Triangle& triangle, double most, int depth, std::vector<Triangle>& out) {
  int worst = -1;
  double wrong = most;
  for (int k = 0; k < 3; ++k) {
    if (!triangle.halved[k]) continue;
    const double here = wrong_by(triangle.corner[k], triangle.corner[(k + 1) % 3]);
    if (here > wrong) wrong = here, worst = k;
  }
  if (worst < 0 || depth > 24) {
    out.push_back(triangle);
    return;
  }
  const Corner &a = triangle.corner[worst], &b = triangle.corner[(worst + 1) % 3],
               &c = triangle.corner[(worst + 2) % 3];
  const Corner m = middle(a, b);
  const bool next = triangle.halved[(worst + 1) % 3], last = triangle.halved[(worst + 2) % 3];
  // Of a surface the new edge may be halved, too.
  const bool within = next && last;
  divide({{a, m, c}, triangle.face, {true, within, last}}, most, depth + 1, out);
  divide({{m, b, c}, triangle.face, {true, next, within}}, most, depth + 1, out);
}

// Where three surfaces meet on a line of sight, the ends of their skins leave a triangle without
// area. It goes, and the skin along its longest edge gets its third corner.
void remove_flat(std::vector<Triangle>& skins) {
  std::multimap<Edge, std::size_t> users;
  std::vector<bool> gone(skins.size());
  const auto note = [&](std::size_t i) {
    for (int k = 0; k < 3; ++k) users.emplace(edge_of(skins[i], k), i);
  };
  for (std::size_t i = 0; i < skins.size(); ++i) note(i);
  for (std::size_t i = 0; i < skins.size(); ++i) {
    if (gone[i] || !is_flat(skins[i])) continue;
    gone[i] = true;
    const Triangle flat = skins[i];
    int longest = 0;
    for (int k = 1; k < 3; ++k)
      if (length_of(flat, k) > length_of(flat, longest)) longest = k;
    const Corner& third = flat.corner[(longest + 2) % 3];
    const Edge edge = edge_of(flat, longest);
    // Two corners in one place: the other two edges are one.
    if (place_of(third) == edge.first || place_of(third) == edge.second) continue;
    const auto [begin, end] = users.equal_range(edge);
    const auto other =
        std::find_if(begin, end, [&](const auto& user) { return !gone[user.second]; });
    if (other == end) continue;
    const Triangle split = skins[other->second];
    gone[other->second] = true;
    int k = 0;
    while (edge_of(split, k) != edge) ++k;
    const Corner &a = split.corner[k], &b = split.corner[(k + 1) % 3],
                 &c = split.corner[(k + 2) % 3];
    const double share = glm::distance(point_of(a), point_of(third)) / length_of(split, k);
    const Corner m{third.place, glm::mix(a.texel, b.texel, float(share))};
    const bool next = split.halved[(k + 1) % 3], last = split.halved[(k + 2) % 3];
    for (const Triangle& half : {Triangle{{a, m, c}, split.face, {false, false, last}},
                                 Triangle{{m, b, c}, split.face, {false, next, false}}}) {
      skins.push_back(half);
      gone.push_back(false);
      note(skins.size() - 1);
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < skins.size(); ++i)
    if (!gone[i]) skins[kept++] = skins[i];
  skins.resize(kept);
}

// Those of a face, with the sky at disparity `sky`.
void add_triangles(const NodeMesh& node, const TriangleRange& range, int face, float sky,
                   std::vector<Triangle>& out) {
  for (std::size_t t = range.first; t < std::size_t(range.first) + range.count; ++t) {
    Triangle triangle;
    triangle.face = face;
    for (std::size_t k = 0; k < 3; ++k) {
      const NodeVertex& v = node.vertices[node.indices[3 * t + k]];
      triangle.corner[k] = {glm::vec4(v.direction, std::max(v.disparity, sky)),
                            texel_of(face, v.texture, node.face_size)};
    }
    out.push_back(triangle);
  }
}

// The triangles of each face, halved until their texels are right.
std::array<std::vector<Triangle>, 6> divided_faces(const NodeMesh& node,
                                                   const NodeSceneOptions& options) {
  float least = INFINITY;
  for (const NodeVertex& v : node.vertices)
    if (v.disparity > 0) least = std::min(least, v.disparity);
  const float sky = std::isfinite(least) ? least / float(options.sky_distance) : 0.01f;
  std::vector<Triangle> all, skins;
  for (int f = 0; f < 6; ++f) add_triangles(node, node.surfaces[std::size_t(f)], f, sky, all);
  if (options.skins) {
    std::set<Edge> of_surfaces;
    for (const Triangle& triangle : all)
      for (int k = 0; k < 3; ++k) of_surfaces.insert(edge_of(triangle, k));
    for (int f = 0; f < 6; ++f) add_triangles(node, node.skins[std::size_t(f)], f, sky, skins);
    for (Triangle& triangle : skins)
      for (int k = 0; k < 3; ++k) triangle.halved[k] = of_surfaces.contains(edge_of(triangle, k));
    remove_flat(skins);
    all.insert(all.end(), skins.begin(), skins.end());
  }
  std::array<std::vector<Triangle>, 6> pieces;
  for (const Triangle& triangle : all)
    divide(triangle, options.texture_error * 2 / node.face_size, 0,
           pieces[std::size_t(triangle.face)]);
  return pieces;
}

}  // namespace

Scene scene_from_node(const EnvironmentMap& map, const NodeMesh& node,
                      const NodeSceneOptions& options) {
  const int n = node.face_size;
  const std::array<std::vector<Triangle>, 6> divided = divided_faces(node, options);
  Scene scene;
  scene.name = map.name;
  for (int f = 0; f < 6; ++f) {
    const std::string name = "face" + std::to_string(f);
    Texture texture;
    texture.name = name;
    texture.image = f;
    scene.images.push_back(srgb8_from_linear(map.faces[std::size_t(f)].color));
    for (glm::u8vec4& texel : scene.images.back().texels()) texel.a = 255;
    texture.wrap_u = texture.wrap_v = Wrap::clamp_to_edge;
    scene.textures.push_back(std::move(texture));
    Material material;
    material.name = name, material.unlit = true, material.double_sided = true;
    material.roughness = 1;
    material.base_color_texture.texture = f;
    scene.materials.push_back(material);

    const std::vector<Triangle>& pieces = divided[std::size_t(f)];
    if (pieces.empty()) continue;
    Mesh mesh;
    mesh.name = name, mesh.material = f;
    std::map<std::tuple<float, float, float, float, float, float>, std::uint32_t> known;
    const glm::dmat3 turn(node.world_from_node);
    const glm::dvec3 eye(node.world_from_node[3]);
    for (const Triangle& piece : pieces)
      for (const Corner& c : piece.corner) {
        const auto [found, fresh] =
            known.try_emplace({c.place.x, c.place.y, c.place.z, c.place.w, c.texel.x, c.texel.y},
                              std::uint32_t(mesh.positions.size()));
        mesh.indices.push_back(found->second);
        if (!fresh) continue;
        const glm::dvec3 away = turn * (glm::dvec3(c.place) / double(c.place.w));
        mesh.positions.emplace_back(eye + away);
        mesh.normals.emplace_back(-glm::normalize(away));
        mesh.uv[0].push_back(c.texel / float(n));
      }
    scene.meshes.push_back(std::move(mesh));
    Model model;
    model.name = name, model.parts.push_back({int(scene.meshes.size()) - 1});
    scene.models.push_back(std::move(model));
    Object object;
    object.name = name, object.model = int(scene.models.size()) - 1;
    scene.objects.push_back(std::move(object));
  }
  finish(scene);
  return scene;
}

}  // namespace rilievo
