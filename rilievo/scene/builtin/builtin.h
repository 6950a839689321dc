// Scenes that need no file: generated from a seed and a number of triangles.
//
// A scene is named by a specification:
//   builtin:NAME[?triangles=N&seed=S]
//     bridge   a stone bridge over a river, trees, houses, moving cars: figure 12 of
//              [Schaufler 1997]; triangles within 5 % of N
//     forest   instanced trees on a slope; a larger N extends it and refines the trees, which keep
//              their places; triangles within one tree of N
//     teapots  touching and interpenetrating objects: figure 1 of the same; within 5 % of N
//     stonehenge  trilithons, spheres and a torus in rainbow colours on a plain: the test scene of
//              [Darsa, Costa, Varshney 1997]; within 5 % of N
//     teapot   a single teapot: one object; within 5 % of N
//     fern, fish, cube
//              a single object each, as in the measurements of [Parilov, Stuerzlinger 2002];
//              within 10 % of N
#pragma once

#include <cstdint>
#include <string_view>

#include "rilievo/core/camera_path.h"
#include "rilievo/core/result.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// A generated scene and a walk through it.
struct BuiltinScene {
  Scene scene;      // finished and valid
  CameraPath path;  // 16 s or more; its first frames are the scene's default walk
};

// Does `spec` name a built-in scene (and not a file)?
[[nodiscard]] bool is_builtin(std::string_view spec);

// Generates a scene. The error lists the allowed names, options or range.
[[nodiscard]] Result<BuiltinScene> make_builtin(std::string_view spec);

}  // namespace rilievo
