// How do OBJ, PLY and STL files become scenes? Internal to loading; throws LoadError.
//
// These readers are written by hand because the only library in Debian 12 that reads all three
// (assimp 5.2.5) crashes on damaged files and has no limit on the memory that a small file can use.
#pragma once

#include <string>
#include <vector>

#include "rilievo/scene/polygons/polygon_mesh.h"

namespace rilievo {

// Read a file of each format. The scene is neither finished nor validated.
[[nodiscard]] Scene read_obj(Bytes file, LoadContext& context);
[[nodiscard]] Scene read_ply(Bytes file, LoadContext& context);
[[nodiscard]] Scene read_stl(Bytes file, LoadContext& context);

// Does the file's length match the number of triangles in a binary STL header?
[[nodiscard]] bool is_binary_stl(Bytes file);

// A part of a soup: the object that it belongs to, and its material.
struct SoupPart {
  std::string object;
  int material = -1;    // index into the scene's materials, or -1
  bool colored = true;  // shows the soup's colours, if it has any
};

// Makes one Object for each object name, of all its parts, in the order in which the names appear.
// Vertices are relative to the origin of the scene. `scene` provides the materials and textures;
// parts without a material get a plain one.
[[nodiscard]] Scene scene_of(PolygonSoup soup, const std::vector<SoupPart>& parts, Scene scene,
                             LoadContext& context);

}  // namespace rilievo
