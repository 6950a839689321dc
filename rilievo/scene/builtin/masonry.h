// Walls, vaults, pavements and roofs out of single stones.
//
// A wall is described over s (along), t (up) and d (outwards), metres; a callback bends it into
// place. Each stone is a pillow of its own colour, cut where the wall's edge cuts it. Behind the
// stones lies a bed of mortar, so that nothing shows through the joints.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>

#include "rilievo/scene/builtin/mesh_builder.h"

namespace rilievo {

struct Wall {
  float length = 1, height = 1;
  float course = 0.42f;                    // height of a row of stones
  float shortest = 0.55f, longest = 1.0f;  // stones
  float joint = 0.02f;                     // half the gap between stones
  float bulge = 0.05f;                     // how far a stone's middle stands out from its rim
  float depth = 0.12f;                     // from the rim inwards
  bool two_sided = false;                  // has an outer face at d = -depth, too, and no bed
  glm::vec3 color{0.35f, 0.33f, 0.29f};
  float tints = 0.12f;                                   // spread of the stones' colours, relative
  std::function<glm::vec3(const glm::vec3& std)> place;  // s x t must point along d
  std::function<float(float s)> lower, upper;            // edges in t; none: 0 and height
  std::function<bool(float s, float t)> hole;            // leaves out stones with this centre
};

// Adds the wall to `mesh` with `density` triangles per square metre, stones made larger where
// otherwise they would have too few.
void add_wall(Mesh& mesh, const Wall& wall, double density, std::uint64_t seed,
              TriangleBudget& budget);

}  // namespace rilievo
