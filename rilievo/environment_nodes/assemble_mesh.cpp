// A point where several surfaces meet becomes a vertex for each of them, all on one line of sight.
// Along a silhouette from u to w the surfaces 1 and 2 end in edges u1-w1 and u2-w2; a skin is the
// quadrangle between them. Where three or more surfaces meet, the skins' ends leave a triangle that
// has no area, and is drawn all the same: rounding may give it one.
//
// A triangle beside a silhouette can be narrower than a texel and span metres of depth: its edge on
// the silhouette is straight where the surface is not. No texel's centre lies within it, so that
// the triangulation does not meet its error, and other eyes would see it stand in the air. It is a
// skin too.
#include "rilievo/environment_nodes/assemble_mesh.h"

#include <map>
#include <tuple>
#include <unordered_set>
#include <utility>

namespace rilievo {
namespace {

using Key = std::tuple<int, int, int>;

// Triangles whose normal makes a larger cosine with the line of sight are surfaces in any case.
constexpr float kEdgeOn = 0.05f;

class Assembler {
 public:
  Assembler(const CubeGrid& grid, const std::array<const FaceMesh*, 6>& faces)
      : grid_(grid), faces_(faces) {}

  NodeMesh run() {
    mesh_.face_size = grid_.size();
    for (int f = 0; f < 6; ++f) place_points(f);
    for (int f = 0; f < 6; ++f) add_surfaces(f);
    for (int f = 0; f < 6; ++f) {
      const std::size_t first = mesh_.triangles();
      add_skins(f);
      if (f == 5) close_joints();
      mesh_.skins[std::size_t(f)] = {std::uint32_t(first),
                                     std::uint32_t(mesh_.triangles() - first)};
    }
    mesh_.quality.resize(mesh_.triangles(), 0.0f);
    drop_unused();
    return std::move(mesh_);
  }

 private:
  struct Placed {
    std::uint32_t vertex;
    glm::vec3 anchor;
  };
  struct Side {
    Placed from, to;
  };
  struct Stretched {
    Placed placed;
    float stretch;
  };

  // Numbers vertices: as many for a point as surfaces may meet there.
  void place_points(int f) {
    const FaceMesh& face = *faces_[std::size_t(f)];
    const int end = 2 * grid_.size();
    first_[f].resize(face.mesh().points().size());
    for (std::uint32_t p = 0; p < face.mesh().points().size(); ++p) {
      const glm::ivec2 at = face.mesh().points()[p];
      const glm::ivec3 key = grid_.key(f, at);
      const bool border = at.x == 0 || at.y == 0 || at.x == end || at.y == end;
      if (border) {
        const auto [found, fresh] =
            border_.try_emplace({key.x, key.y, key.z}, std::uint32_t(mesh_.vertices.size()));
        first_[f][p] = found->second;
        if (!fresh) continue;
      } else {
        first_[f][p] = std::uint32_t(mesh_.vertices.size());
      }
      const glm::vec3 direction = glm::vec3(key) / float(grid_.size());
      const int copies = face.copies(p);
      if (copies > 2) joints_.push_back({first_[f][p], copies});
      for (int c = 0; c < copies; ++c) mesh_.vertices.push_back({direction, 0, direction});
    }
  }

  Placed placed(int f, std::uint32_t triangle, int i) {
    const FaceMesh& face = *faces_[std::size_t(f)];
    const FaceMesh::Corner corner = face.corner(triangle, i);
    const std::uint32_t vertex =
        first_[f][face.mesh().triangles()[triangle].v[i]] + std::uint32_t(corner.copy);
    mesh_.vertices[vertex].disparity = corner.disparity;
    const FaceAxes& axes = face_axes()[std::size_t(f)];
    const float n = float(grid_.size());
    const glm::vec2 along = (corner.anchor - n) / n;
    return {vertex, glm::vec3(axes.forward) + along.x * glm::vec3(axes.right) -
                        along.y * glm::vec3(axes.up)};
  }

  void add_surfaces(int f) {
    const FaceMesh& face = *faces_[std::size_t(f)];
    const std::size_t first = mesh_.triangles();
    for (std::uint32_t t = 0; t < face.mesh().triangles().size(); ++t) {
      if (!face.shows_something(t)) continue;
      std::uint32_t v[3];
      for (int i = 0; i < 3; ++i) v[i] = placed(f, t, i).vertex;
      const float quality =
          triangle_quality(mesh_.vertices[v[0]], mesh_.vertices[v[1]], mesh_.vertices[v[2]]);
      if (quality < kEdgeOn && !shows_texel(face, t)) {
        slivers_[f].push_back(t);
        continue;
      }
      // Counter-clockwise on the lattice, whose y runs down: clockwise as seen.
      mesh_.indices.insert(mesh_.indices.end(), {v[0], v[2], v[1]});
      mesh_.quality.push_back(quality);
    }
    mesh_.surfaces[std::size_t(f)] = {std::uint32_t(first),
                                      std::uint32_t(mesh_.triangles() - first)};
  }

  // Is the centre of a texel within the triangle? Those on its sides belong to its neighbours too.
  static bool shows_texel(const FaceMesh& face, std::uint32_t triangle) {
    glm::ivec2 p[3];
    for (int i = 0; i < 3; ++i) p[i] = face.mesh().points()[face.mesh().triangles()[triangle].v[i]];
    const glm::ivec2 low = glm::min(p[0], glm::min(p[1], p[2])) | 1;
    const glm::ivec2 high = glm::max(p[0], glm::max(p[1], p[2]));
    for (int y = low.y; y <= high.y; y += 2)
      for (int x = low.x; x <= high.x; x += 2)
        if (orientation(p[0], p[1], {x, y}) > 0 && orientation(p[1], p[2], {x, y}) > 0 &&
            orientation(p[2], p[0], {x, y}) > 0)
          return true;
    return false;
  }

  // It stretches from its longest side to the corner opposite, as it is seen from the node, where
  // it is narrower than a texel, which can be some pixels. It is a crack at a multiple of a skin's
  // width, and has the colours of its own place.
  void add_sliver(int f, std::uint32_t triangle) {
    const FaceMesh& face = *faces_[std::size_t(f)];
    const auto point = [&](int i) {
      return face.mesh().points()[face.mesh().triangles()[triangle].v[i % 3]];
    };
    int corner = 0, longest = 0;
    for (int i = 0; i < 3; ++i) {
      const glm::ivec2 side = point(i + 2) - point(i + 1);
      const int length = side.x * side.x + side.y * side.y;
      if (length > longest) longest = length, corner = i;
    }
    const auto at = [&](int i) {
      const std::uint32_t vertex = placed(f, triangle, i).vertex;
      return Stretched{{vertex, mesh_.vertices[vertex].direction},
                       i == corner ? NodeVertex::kSliver : NodeVertex::kSliverSide};
    };
    add_skin_triangle(at(0), at(2), at(1));
  }

  void add_skins(int f) {
    for (const std::uint32_t triangle : slivers_[f]) add_sliver(f, triangle);
    const FaceMesh& face = *faces_[std::size_t(f)];
    const auto& triangles = face.mesh().triangles();
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      if (!face.shows_something(t)) continue;
      for (int side = 0; side < 3; ++side) {
        const int u = (side + 1) % 3, w = (side + 2) % 3;
        const std::uint32_t other = triangles[t].next[side];
        if (other == Delaunay::kNone) {
          meet_across(f, {placed(f, t, u), placed(f, t, w)}, triangles[t].v[u], triangles[t].v[w]);
          continue;
        }
        if (other < t || !((triangles[t].fixed >> side) & 1) || !face.shows_something(other))
          continue;
        int j = 0;
        while (triangles[other].next[j] != t) ++j;
        add_skin({placed(f, t, u), placed(f, t, w)},
                 {placed(f, other, (j + 2) % 3), placed(f, other, (j + 1) % 3)});
      }
    }
  }

  // An edge of a face's border: the second face that comes to it adds the skin between them.
  void meet_across(int f, const Side& side, std::uint32_t u, std::uint32_t w) {
    const std::uint32_t a = first_[f][u], b = first_[f][w];
    const auto [found, fresh] = waiting_.try_emplace({std::min(a, b), std::max(a, b)}, side);
    if (fresh) return;
    // The first face runs the other way.
    add_skin(side, {found->second.to, found->second.from});
    waiting_.erase(found);
  }

  void add_skin(const Side& one, const Side& two) {
    const auto nearness = [&](const Side& side) {
      return mesh_.vertices[side.from.vertex].disparity + mesh_.vertices[side.to.vertex].disparity;
    };
    const float of_one = nearness(one) < nearness(two) ? 1.0f : 0.0f, of_two = 1.0f - of_one;
    // A skin that begins or ends in a point begins there in the middle. All of it has the colours
    // of the farther surface, which is more likely to go on behind the nearer one than that is to
    // go on beside itself.
    const auto at = [](const Placed& p, const Placed& other, float stretch) {
      Stretched corner{p, p.vertex == other.vertex ? 0.5f : stretch};
      if (stretch == 0) corner.placed.anchor = other.anchor;
      return corner;
    };
    const Stretched corners[] = {at(one.to, two.to, of_one), at(one.from, two.from, of_one),
                                 at(two.from, one.from, of_two), at(two.to, one.to, of_two)};
    add_skin_triangle(corners[0], corners[1], corners[2]);
    add_skin_triangle(corners[0], corners[2], corners[3]);
  }

  void add_skin_triangle(const Stretched& a, const Stretched& b, const Stretched& c) {
    const std::uint32_t i = a.placed.vertex, j = b.placed.vertex, k = c.placed.vertex;
    if (i == j || j == k || i == k) return;
    // The sky is not joined to anything: where it was hidden, the frame's own is seen.
    for (const std::uint32_t v : {i, j, k})
      if (mesh_.vertices[v].disparity <= 0) return;
    for (const Stretched* s : {&a, &b, &c}) mesh_.indices.push_back(skin_vertex(*s));
    for (const std::uint32_t surface : {i, j, k}) skinned_.insert(surface);
  }

  // At the very place of the surface's own.
  std::uint32_t skin_vertex(const Stretched& s) {
    const auto [found, fresh] = skin_of_.try_emplace(std::pair(s.placed.vertex, s.stretch),
                                                     std::uint32_t(mesh_.vertices.size()));
    if (fresh) {
      const NodeVertex& v = mesh_.vertices[s.placed.vertex];
      mesh_.vertices.push_back({v.direction, v.disparity, s.placed.anchor, s.stretch});
    }
    return found->second;
  }

  void close_joints() {
    for (const auto& [first, copies] : joints_) {
      std::vector<Stretched> met;
      for (int c = 0; c < copies; ++c) {
        const std::uint32_t surface = first + std::uint32_t(c);
        if (skinned_.count(surface))
          met.push_back({{surface, mesh_.vertices[surface].direction}, NodeVertex::kAlways});
      }
      for (std::size_t i = 2; i < met.size(); ++i) add_skin_triangle(met[0], met[i - 1], met[i]);
    }
  }

  void drop_unused() {
    std::vector<std::uint32_t> number(mesh_.vertices.size(), 0);
    for (const std::uint32_t i : mesh_.indices) number[i] = 1;
    std::vector<NodeVertex> kept;
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (!number[i]) continue;
      number[i] = std::uint32_t(kept.size());
      kept.push_back(mesh_.vertices[i]);
    }
    for (std::uint32_t& i : mesh_.indices) i = number[i];
    mesh_.vertices = std::move(kept);
  }

  const CubeGrid& grid_;
  const std::array<const FaceMesh*, 6>& faces_;
  NodeMesh mesh_;
  std::vector<std::uint32_t> first_[6];  // by face and point: its first vertex
  std::vector<std::uint32_t> slivers_[6];
  std::map<Key, std::uint32_t> border_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Side> waiting_;
  std::map<std::pair<std::uint32_t, float>, std::uint32_t> skin_of_;
  std::unordered_set<std::uint32_t> skinned_;  // surfaces' vertices that skins begin at
  std::vector<std::pair<std::uint32_t, int>> joints_;
};

}  // namespace

NodeMesh assemble_mesh(const CubeGrid& grid, const std::array<const FaceMesh*, 6>& faces) {
  return Assembler(grid, faces).run();
}

}  // namespace rilievo
