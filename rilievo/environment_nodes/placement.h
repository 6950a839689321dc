// Where should nodes stand so that they hold what can be seen from a region? (S3, left open there)
//
// What can be seen is sampled: rays in all directions from points of the region. A node holds a
// sample if nothing lies between, and if it does not look along the surface. Nodes are chosen one
// by one, each where it adds most to what is held: no choice of as many nodes holds more than
// 1 / (1 - 1/e) of that of these candidates. The same places for any number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/result.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

struct PlacementOptions {
  Box region;                  // where eyes will be; not empty, may be flat
  int nodes = 8;               // at most
  double enough = 1.0;         // stop when this share is held
  int candidates = 400;        // places that are tried
  int eyes = 200;              // points of the region from which is looked ...
  int rays = 200;              // ... in as many directions each
  double clearance = 0.1;      // metres that a node keeps from surfaces
  double least_cosine = 0.05;  // of the angle between a surface's normal and the line of sight
  std::uint64_t seed = 1;
};

struct Placement {
  std::vector<glm::dvec3> eyes;  // in the order of their worth
  std::vector<double> share;     // of the visible surface that the first nodes hold together
};

// Fails if no candidate is free, or nothing is to be seen.
[[nodiscard]] Result<Placement> place_nodes(const RayScene& scene, const PlacementOptions& options);

// Share of the same samples that nodes at `eyes` hold.
[[nodiscard]] Result<double> share_held(const RayScene& scene, const PlacementOptions& options,
                                        const std::vector<glm::dvec3>& eyes);

}  // namespace rilievo
