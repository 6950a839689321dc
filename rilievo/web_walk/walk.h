// A walk for browsers: a folder of static files that any web host serves (schema `rilievo-walk-1`).
//
//   walk.json          the manifest: what there is, where it stands, which files hold it
//   pictures/NAME.EXT  one file for each picture or mesh; NAME is the beginning of its SHA-256
//   index.html         a page that walks it, with
//   viewer.js          its program
//   headset.js         a part of it that browsers with a headset load
//   pictures.js        a part for walks of pictures; or reliefs.js for those of reliefs
//
// All paths are relative. docs/formats.md describes the manifest, and the npm package in web/ reads
// it. World space, metres; disparities are 1 / eye_z of a node's face, 1/m.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/scene/scene.h"
#include "rilievo/warp/texel_links.h"

namespace rilievo {

// A file of a walk.
struct WalkFile {
  std::string name;  // relative to the walk's folder
  std::size_t bytes = 0;
};

// A node's mesh in a file: four streams of meshoptimizer, one behind the other.
struct WalkMesh {
  WalkFile file;
  // Bytes, and elements: vertices or indices.
  struct Stream {
    std::size_t bytes = 0, count = 0;
  };
  Stream surface_vertices, surface_indices, skin_vertices, skin_indices;
  // The triangles of each side, in the order of the indices.
  std::array<std::uint32_t, 6> surfaces{}, skins{};
  // A vertex's disparity is its code times this, 1/m.
  double disparity_step = 0;
};

// What texels count is stored in so many steps: finer ones cost bytes and cannot be seen.
inline constexpr int kWalkWeightSteps = 15;

// A node in one resolution.
struct WalkLevel {
  int face_size = 0;  // texels
  // One WebP of 3 x 2 faces, +x -x +y / -y +z -z, each with its bottom row first.
  WalkFile colors;
  double psnr_db = 0;  // of the colours against the pictures
  WalkMesh mesh;
  // Of any texel, in pixels of a frame as fine as the faces, for an eye `reach` metres from the
  // node: of the triangles and of the rounding of disparities together.
  double error_px = 0, reach = 0;
  // A plane of texel_weights() in steps from 0 to kWalkWeightSteps, laid out as the colours.
  WalkFile weights;
  WalkFile objects;  // a plane of 16-bit identifiers laid out as the colours; or no name
};

// A node.
struct WalkNode {
  glm::dmat4 world_from_node{1.0};
  double covered = 0;             // the share of its texels that show a surface
  Box bounds;                     // of these surfaces
  std::vector<WalkLevel> levels;  // the coarsest first
};

// What a node sees in each direction, in low resolution (NodeSketch), for all nodes in one plane.
struct WalkSketches {
  WalkFile file;
  int size = 0;  // texels a side of a face
  // A code c from 1 to 65534 is the distance near (far / near)^((c - 1) / 65533), metres; 0 is
  // nothing, 65535 is infinity.
  double near = 1, far = 1;
};

// A picture with depth.
struct WalkPicture {
  Camera camera;
  WalkFile colors;     // a WebP, sRGB, with alpha; row 0 on top
  double psnr_db = 0;  // of the colours over black
  // A plane of 16-bit numbers: 0 is nothing, c > 0 the disparity (1 / eye_z of the camera)
  // least_disparity + (c - 1) disparity_step, 1/m.
  WalkFile depths;
  double least_disparity = 0, disparity_step = 0;
  bool complete = true, sees_through = false;  // as LayeredImpostor's; of surfaces
  glm::dvec3 direction{0};  // unit, towards the viewers whom it serves; of surfaces
  double plane_z = 1;       // eye_z of its polygon; of nailboards
};

// Pictures that are drawn together; none: the walk has others.
struct WalkPictures {
  // surfaces: of an object, for viewers all around, as LayeredMethod::surfaces draws them;
  // nailboards: each on its polygon
  enum class Drawn { surfaces, nailboards };
  Drawn drawn = Drawn::surfaces;
  Box bounds;
  double handover = 0;  // radians, in which pictures fade into each other
  LinkOptions links;
  std::vector<WalkPicture> pictures;
};

// A layered relief. Its samples lie in a sheet of blocks of kReliefBlock texels a side: first the
// nearest samples of all blocks of the picture that have any, row by row, then the second ones of
// those that have two on a line of sight, and so on.
inline constexpr int kReliefBlock = 16;
struct WalkRelief {
  Camera camera;  // parallel or perspective
  // A code c > 0 of a sample is the displacement first_d + (c - 1) d_step from the plane at eye_z
  // == plane_z, or -1 / eye_z of a perspective one (LayeredRelief).
  double plane_z = 1, first_d = 0, d_step = 0;
  double splat_scale = 1;                 // as LayeredRelief's
  int sheet_width = 0, sheet_height = 0;  // texels
  std::size_t samples = 0;
  WalkFile colors;     // a WebP of the sheet, sRGB, with alpha; row 0 on top
  double psnr_db = 0;  // of the colours over black
  WalkFile codes;      // a plane of the sheet; 0 is nothing
  WalkFile layers;     // a plane: how many blocks of the sheet each block of the picture has
  std::vector<glm::dvec3> hull;  // as LayeredRelief's
};

// Reliefs of one object, of which the one that faces the eye most is drawn.
struct WalkReliefs {
  Box bounds;
  double splat = 1, resolution = 1;  // as PrewarpOptions'
  int max_size = 1024;
  std::vector<WalkRelief> reliefs;
};

// What the manifest says.
struct WalkManifest {
  std::string name;
  glm::dvec3 up{0, 1, 0};
  glm::dvec3 origin{0.0};  // of the walk's space, in the world
  // Where a walk begins, which way it looks; vertical field of view, radians.
  glm::dvec3 eye{0.0}, target{0, 0, -1};
  double vertical_fov = 0.9;
  double z_near = 0.1, z_far = 1000;
  std::vector<WalkNode> nodes;  // with their sketches, or none
  WalkSketches sketches;
  std::optional<Sky> sky;  // behind what the nodes show; none: the viewer's own
  WalkPictures pictures;
  WalkReliefs reliefs;
};

// How exact a walk is, and what is in it.
struct WalkOptions {
  double least_psnr_db = 54;  // of colours
  double rounding_px = 0.05;  // the most that rounding of disparities moves a texel
  int coarse_face = 128;      // texels a side of a face that is loaded first
  bool objects = false;       // identifiers, to measure what is drawn
  std::function<void(int done, int total)> progress = {};
};

}  // namespace rilievo
