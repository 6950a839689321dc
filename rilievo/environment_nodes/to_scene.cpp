// Along an edge of L texels whose ends are w and w' deep, the texel at a share s of its length in
// space is the one at the share s w' / ((1 - s) w + s w') of its picture. The two differ by at most
// (sqrt(r) - 1) / (sqrt(r) + 1), r = w' / w: where s has the square root of the ratio.
#include "rilievo/environment_nodes/to_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
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
};

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
  divide({{a, m, c}}, most, depth + 1, out);
  divide({{m, b, c}}, most, depth + 1, out);
}

}  // namespace

Scene scene_from_node(const EnvironmentMap& map, const NodeMesh& node,
                      const NodeSceneOptions& options) {
  const int n = node.face_size;
  float least = INFINITY;
  for (const NodeVertex& v : node.vertices)
    if (v.disparity > 0) least = std::min(least, v.disparity);
  const float sky = std::isfinite(least) ? least / float(options.sky_distance) : 0.01f;
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

    std::vector<Triangle> pieces;
    for (const bool skins : {false, true}) {
      if (skins && !options.skins) continue;
      const TriangleRange range = (skins ? node.skins : node.surfaces)[std::size_t(f)];
      for (std::size_t t = range.first; t < std::size_t(range.first) + range.count; ++t) {
        Triangle triangle;
        for (std::size_t k = 0; k < 3; ++k) {
          const NodeVertex& v = node.vertices[node.indices[3 * t + k]];
          triangle.corner[k] = {glm::vec4(v.direction, std::max(v.disparity, sky)),
                                texel_of(f, v.texture, n)};
        }
        divide(triangle, options.texture_error * 2 / n, 0, pieces);
      }
    }
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
