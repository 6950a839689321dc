// Scenes that need no file: generated, seeded, and of the size that is asked for.
//
// A scene is named by a specification:
//   builtin:NAME[?triangles=N&seed=S]
//     bridge   a stone bridge over a river, trees, houses, cars in motion: figure 12 of
//              [Schaufler 1997]; triangles within 5 % of N
//     forest   instanced trees on a slope; a larger N reaches farther and has finer trees, in the
//              same places; triangles within one tree of N
//     teapots  touching and interpenetrating things: figure 1 of the same; within 5 % of N
//     stonehenge  trilithons, spheres and a torus in rainbow colours on a plain: the test scene of
//              [Darsa, Costa, Varshney 1997]; within 5 % of N
//     teapot   a single teapot: one object; within 5 % of N
//     fern, fish, cube
//              a single object each, as [Parilov, Stuerzlinger 2002] measured layered relief
//              textures with; within 10 % of N
#pragma once

#include <cstdint>
#include <string_view>

#include "rilievo/core/camera_path.h"
#include "rilievo/core/result.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

struct BuiltinScene {
  Scene scene;      // finished and valid
  CameraPath path;  // 16 s or more; its first frames are the scene's default walk
};

// Does `spec` name a built-in scene, rather than a file?
[[nodiscard]] bool is_builtin(std::string_view spec);

// The error names the allowed scenes, options or range.
[[nodiscard]] Result<BuiltinScene> make_builtin(std::string_view spec);

}  // namespace rilievo
