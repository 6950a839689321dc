// How are layered pictures with depth kept in files that any OpenEXR tool opens? (S4.1)
//
// One deep part of scan lines, ZIPS:
//   channels    R G B A half, linear and premultiplied; Z, ZBack float: where a sample begins and
//               ends (a surface ends where it begins); id uint
//   attributes  those of exr.h: the camera exactly, and as worldToCamera and worldToNDC
//
// What is read back equals what was written, bit for bit, once colours are halfs.
//
// A foreign file loads if it has one part, deep and of scan lines, with R G B and Z (A, ZBack, id
// optional) and a camera: worldToCamera and worldToNDC, or one that the caller gives for its
// display window. Without either it is refused: a guessed camera would put everything in the wrong
// place in silence. Its Z is taken as `depth_kind` says; samples whose Z is at least 1e30, or not
// positive, show nothing; samples are sorted. Reading and writing run in the caller's thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "rilievo/core/depth_image.h"

namespace rilievo {

struct DeepLoadOptions {
  // Of the display window; its size does not matter. Used only if the file has no camera.
  std::optional<Camera> camera;
  // What a foreign file's Z means: eye_z or ray.
  DepthKind depth_kind = DepthKind::eye_z;
};

// Requires a valid picture (an invalid one is an error, not a crash). Replaces the file at once or
// not at all.
[[nodiscard]] Result<> save_layers(const std::filesystem::path& path,
                                   const LayeredDepthImage& layers);

// What is returned is valid. The error names the file and the reason.
[[nodiscard]] Result<LayeredDepthImage> load_layers(const std::filesystem::path& path,
                                                    const DeepLoadOptions& options = {});
// The same of a file in memory; `where` names it in errors.
[[nodiscard]] Result<LayeredDepthImage> load_layers(std::string_view bytes,
                                                    const std::string& where,
                                                    const DeepLoadOptions& options = {});

// The symmetric perspective camera at the origin, looking down -z, up +y, for a file that brings
// none. `horizontal_fov` in radians.
[[nodiscard]] Camera deep_camera(double horizontal_fov, int width, int height);

}  // namespace rilievo
