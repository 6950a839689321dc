// A LayeredDepthImage in a deep file that any OpenEXR tool opens (S4.1).
//
// A picture is one deep part of scan lines, ZIPS compression:
//   channels    R G B A half, linear and premultiplied; Z, ZBack float: front and back of a sample
//               (equal for a surface); id uint
//   attributes  as in exr.h: the camera exactly, and as worldToCamera and worldToNDC
//
// Loading returns exactly what was saved, once colours are rounded to half precision.
//
// A foreign file loads if it has one part, deep and of scan lines, with R G B and Z (A, ZBack, id
// are optional) and a camera: either worldToCamera and worldToNDC, or one that the caller gives for
// the display window. A file without either is refused, because a guessed camera would silently put
// everything in the wrong place. `depth_kind` says what Z means. Samples whose Z is at least 1e10
// or not positive are dropped; the others are sorted. Colours that are not finite become finite as
// in exr.h. Reading and writing run in the caller's thread.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "rilievo/core/depth_image.h"
#include "rilievo/io/exr.h"

namespace rilievo {

// Answers to questions that a foreign file leaves open.
struct DeepLoadOptions {
  // The camera of the display window, of any resolution. Used only if the file has no camera.
  std::optional<Camera> camera;
  // Instead: the horizontal field of view of a camera at the origin (deep_camera), radians.
  std::optional<double> fov;
  // The meaning of a foreign file's Z: eye_z or ray.
  DepthKind depth_kind = DepthKind::eye_z;
};

// Saves a valid picture (an invalid one is an error). The file is replaced at once or not at all.
[[nodiscard]] Result<> save_layers(const std::filesystem::path& path,
                                   const LayeredDepthImage& layers);
// Several in one file, with attributes of the caller's (exr.h); read back by load_picture_file.
[[nodiscard]] Result<> save_layers(const std::filesystem::path& path,
                                   std::span<const LayeredDepthImage> pictures,
                                   const FileAttributes& attributes = {});

// Loads a valid picture. The error names the file and the reason.
[[nodiscard]] Result<LayeredDepthImage> load_layers(const std::filesystem::path& path,
                                                    const DeepLoadOptions& options = {});
// Loads a picture from memory; `where` names it in errors.
[[nodiscard]] Result<LayeredDepthImage> load_layers(std::string_view bytes,
                                                    const std::string& where,
                                                    const DeepLoadOptions& options = {});

// A symmetric perspective camera at the origin that looks down -z, for files without a camera.
// `horizontal_fov` in radians; sizes in texels.
[[nodiscard]] Camera deep_camera(double horizontal_fov, int width, int height);

}  // namespace rilievo
