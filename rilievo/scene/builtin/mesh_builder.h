// Meshes out of curved pieces: grids, blobs, boxes.
//
// Each function adds one piece to a mesh: a callback places and colours every vertex, normals are
// the area-weighted mean of the triangles around a vertex, within the piece. Vertices are shared
// within a piece, so that it is closed where its surface is. Counter-clockwise from outside.
#pragma once

#include <functional>
#include <glm/glm.hpp>

#include "rilievo/scene/scene.h"

namespace rilievo {

inline constexpr float kPi = 3.14159265f, kTwoPi = 6.2831853f;

struct BuiltVertex {
  glm::vec3 position;
  glm::vec3 color{1.0f};  // linear; multiplies the material's
};

// A surface over u, v in [0, 1]; outside is where u x v points.
struct GridShape {
  int nu = 1, nv = 1;                               // cells; nu >= 3 if u is closed
  bool closed_u = false, closed_v = false;          // is u = 1 the same line as u = 0?
  bool pole_at_start = false, pole_at_end = false;  // is v = 0 (v = 1) a single point?
  [[nodiscard]] int triangles() const {
    return nu * (2 * nv - int(pole_at_start) - int(pole_at_end));
  }
};
void add_grid(Mesh& mesh, const GridShape& shape,
              const std::function<BuiltVertex(float u, float v)>& place);

// A ball-like shape over all directions; 8 n^2 triangles of about equal size. The callback's
// position must keep the ball's orientation.
void add_blob(Mesh& mesh, int n,
              const std::function<BuiltVertex(const glm::vec3& direction)>& place);

// A box-like shape over the surface of the cube [-1, 1]^3 in n.x * n.y * n.z cells.
struct BoxShape {
  glm::ivec3 n{1};
  bool left = true, right = true, bottom = true, top = true, back = true, front = true;
  [[nodiscard]] int triangles() const;
};
void add_box(Mesh& mesh, const BoxShape& shape,
             const std::function<BuiltVertex(const glm::vec3& cube)>& place);

// The point of a box with half extents `half` and edges rounded with `radius` that belongs to
// `cube` on the surface of [-1, 1]^3. Cells at the edges should be about as wide as the radius;
// `n` tells how many cells there are, to put the outermost grid line on the round edge.
[[nodiscard]] glm::vec3 rounded_box(const glm::vec3& cube, const glm::vec3& half, float radius,
                                    const glm::ivec3& n);

// A tube around the line from `a` to `b` whose ends have radius `ra`, `rb`; open ends.
void add_tube(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, float ra, float rb, int sides,
              int rings, const glm::vec3& color);

// How finely to divide pieces so that their triangles add up to a target: what rounding takes from
// one piece is given to the next.
class TriangleBudget {
 public:
  // n for a piece of `square` * n^2 + `linear` * n triangles that should have `wanted` of them; at
  // least `least`.
  int divide(double wanted, double square, double linear, int least);

 private:
  double owed_ = 0.0;
};

// Appends `mesh`, with a model of one part that shows it, and returns the model's index.
int add_model(Scene& scene, Mesh mesh, int material);
// Appends an object that stands still.
void add_object(Scene& scene, std::string name, int model, const glm::mat4& world_from_model);

}  // namespace rilievo
