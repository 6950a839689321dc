// Meshes that bend by time: skins and morph targets, posed at any time.
//
// A loader keeps what bends them if it is asked to (LoadOptions::deformations); objects' own motion
// is pose()'s. Pure; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/scene/scene.h"

namespace rilievo {

// Nodes and curves that bend meshes; apart from those that place objects.
struct Rig {
  std::vector<Node> nodes;
  std::vector<Channel> channels;
  float duration = 0.0f;  // seconds; it repeats
};

// How a mesh bends by time: morph targets, then a skin.
struct Deformation {
  int mesh = 0;  // index into Scene::meshes
  // The vertices before they are bent; normals and tangents only if the file has them.
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec4> tangents;
  // Without normals: the vertex of each corner of the mesh, all of whose triangles are flat.
  std::vector<std::uint32_t> corners;
  // `weight` times these is added. If `weights` has keys, they are the weight, in x.
  struct Target {
    std::vector<glm::vec3> positions, normals, tangents;
    float weight = 0;
    Channel weights;
  };
  std::vector<Target> targets;
  // A skin: vertices move by the weighted mean of world_from_joint joint_from_mesh.
  struct Joint {
    int node = 0;  // of the rig
    glm::mat4 joint_from_mesh{1.0f};
  };
  std::vector<Joint> joints;
  // Vertex i has influences [first_influence[i], first_influence[i + 1]); weights add up to 1.
  struct Influence {
    std::uint32_t joint = 0;
    float weight = 0;
  };
  std::vector<std::uint32_t> first_influence;
  std::vector<Influence> influences;
};

// The deformations of a scene's meshes.
struct Deformations {
  Rig rig;
  std::vector<Deformation> meshes;
};

// Bends the meshes of `scene` as they are at `time` (seconds), whatever they were bent to before;
// with their bounds and those of their models.
void bend(const Deformations& deformations, double time, Scene& scene);

// A copy that is bent.
[[nodiscard]] Scene pose_at(const Scene& scene, const Deformations& deformations, double time);

// How a model's surface can move, besides its objects' own motion. Model space.
struct DeformationBounds {
  double speed = 0;   // of any point at most, metres a second; 0: it does not bend
  double jump = 0;    // of any point at most, metres, where the animation begins again
  double period = 0;  // seconds after which it begins again; 0: never
  Box bounds;         // of the surface, at all times
};

// Bounds for each of Scene::models. `speed` and `bounds` are bounds at all times, not at some that
// were tried: from the curves' greatest speeds, interval by interval, and the lengths of bones. At
// most kSteppedSpeed. Slow: bends each mesh up to 257 times.
[[nodiscard]] std::vector<DeformationBounds> deformation_bounds(const Scene& scene,
                                                                const Deformations& deformations);

// The greatest length of the matrix' linear part times a unit vector, at most; exact for rotations
// and scales.
[[nodiscard]] double stretch_at_most(const glm::mat4& m);

// The speed of curves with steps, metres a second.
constexpr double kSteppedSpeed = 1e9;

// scene_from_node of each node at `time` (seconds, not repeated), into as many matrices. pose() is
// made of it.
void pose_nodes(std::span<const Node> nodes, std::span<const Channel> channels, double time,
                std::span<glm::dmat4> scene_from_node);

}  // namespace rilievo
