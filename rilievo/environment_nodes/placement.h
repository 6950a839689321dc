// Where should nodes stand so that they show what is visible from a region? (Left open by S3)
//
// The visible surface is sampled by rays in all directions from points of the region, or of the
// path that eyes take through it: what is seen from elsewhere in the region need not be held. A
// node covers a sample if nothing lies between them and it does not look along the surface, or no
// more so than the eye that saw the sample. Nodes are chosen greedily, each where it covers most in
// addition: no choice of the same number of candidates covers more than 1 / (1 - 1/e) times as
// much. The result does not depend on the number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/result.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

// The region, the number of nodes and of samples.
struct PlacementOptions {
  Box region;  // where eyes will be; not empty, can be flat
  // Places of an eye one after the other, between which it goes straight; empty: not known. Nodes
  // then stand on the way where they can, else in the region.
  std::vector<glm::vec3> path;
  int nodes = 8;           // at most
  double enough = 1.0;     // stop when this share is covered
  int candidates = 400;    // places to try
  int eyes = 500;          // points of the region from which rays are cast ...
  int rays = 100;          // ... in this number of directions each
  double clearance = 0.1;  // least distance of a node from surfaces, metres
  // Of the angle between a surface's normal and the line of sight, unless an eye saw it at less.
  double least_cosine = 0.05;
  std::uint64_t seed = 1;
};

// The chosen places.
struct Placement {
  std::vector<glm::dvec3> eyes;  // in the order of choice
  std::vector<double> share;     // of the visible surface that the first nodes cover together
};

// Chooses places. Fails if no candidate is free or no surface is visible.
[[nodiscard]] Result<Placement> place_nodes(const RayScene& scene, const PlacementOptions& options);

// The share of the same samples that nodes at `eyes` cover.
[[nodiscard]] Result<double> share_held(const RayScene& scene, const PlacementOptions& options,
                                        const std::vector<glm::dvec3>& eyes);

}  // namespace rilievo
