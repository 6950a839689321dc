// OBJ, PLY and STL -> Scene. Internal to loading; throws LoadFault.
//
// Read here and not by a library: Debian 12's assimp (5.2.5), the one that reads all three, crashes
// on damaged files and has no limit on the memory that a small file may ask for.
#pragma once

#include <string>
#include <vector>

#include "rilievo/scene/polygons/polygon_mesh.h"

namespace rilievo {

// Not yet finished, nor validated.
[[nodiscard]] Scene read_obj(Bytes file, LoadContext& context);
[[nodiscard]] Scene read_ply(Bytes file, LoadContext& context);
[[nodiscard]] Scene read_stl(Bytes file, LoadContext& context);

// Has it the length that a binary STL with its count of triangles has?
[[nodiscard]] bool is_binary_stl(Bytes file);

// A part of a soup: which object it belongs to, and its material.
struct SoupPart {
  std::string object;
  int material = -1;  // of the scene, or none
};

// Every name of an object becomes an Object with all its parts, in the order in which they first
// appear. Objects stand where their vertices are. `scene` brings the materials and textures; parts
// without a material get a plain one.
[[nodiscard]] Scene scene_of(PolygonSoup soup, const std::vector<SoupPart>& parts, Scene scene,
                             LoadContext& context);

}  // namespace rilievo
