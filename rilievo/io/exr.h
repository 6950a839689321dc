// Pictures with depth in files that any OpenEXR tool opens.
//
// A picture is one part of an OpenEXR file (several pictures: a multi-part file, ZIP, scan lines):
//   channels    R G B A half, linear and premultiplied; Z float; id uint if the picture has objects
//   Z           the picture's own kind of depth (eye_z unless `rilievo.depthKind` says otherwise);
//               +infinity where the texel shows nothing
//   windows     the data window is the picture; the display window, which OpenEXR requires to be
//               the same in all parts, begins there and is as large as the largest picture
//   standard    worldToCamera, worldToNDC (exr_camera.h), screenWindowCenter, screenWindowWidth;
//               pixelAspectRatio if it is the same for all pictures, else 1
//   our own     rilievo.version (int 1), .name .projection .depthKind (string), .worldFromEye
//               (m44d, rows are the camera's axes and position), .windowMin .windowMax (v2d: left
//               bottom, right top), .size (v2i), .depthRange (v2d: z_near z_far): the camera,
//               exactly;
//               rilievo.file.KEY (first part), rilievo.picture.KEY (string): attributes of callers
//
// Loading returns exactly what was saved, once colours are rounded to the nearest half within
// +-65504.
//
// A foreign file loads if every part has R G B (A, id are optional), Z and both standard matrices;
// the channels may lie in layers (exr_layers.h). Z is taken as eye_z; a texel whose Z is 0 or at
// least 1e10, or whose colour and alpha are 0, shows nothing. z_near and z_far come
// from the depths. In colours, NaN becomes 0 and infinities become +-65504. A data window that
// differs from the display window is a crop of the matrices' camera. Of tiled and mipmapped parts,
// the base level is read. Deep parts, sub-sampled channels, depths that are NaN, and files that
// claim more texels than their bytes can hold are refused. Reading and writing run in the caller's
// thread.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "rilievo/core/depth_image.h"

namespace rilievo {

// Texts by name, stored in the file's header.
using Attributes = std::map<std::string, std::string>;

// Attributes of a file and of its pictures.
struct FileAttributes {
  Attributes file;
  std::vector<Attributes> pictures;  // one for each picture, or empty
};

// The contents of a file.
struct PictureFile {
  std::vector<DepthImage> pictures;
  std::vector<LayeredDepthImage> layers;  // instead, of a deep file that Rilievo wrote (deep_exr.h)
  FileAttributes attributes;              // with one entry for each picture
};

// Saves at least one picture; all must be valid (an invalid picture is an error). Keys are 1 to 200
// printable characters without spaces. The file is replaced at once or not at all.
[[nodiscard]] Result<> save_pictures(const std::filesystem::path& path,
                                     std::span<const DepthImage> pictures,
                                     const FileAttributes& attributes = {});

// The pictures of a file whose planes are read. The others have only name, camera and attributes.
struct PictureRange {
  std::size_t first = 0, count = std::size_t(-1);

  [[nodiscard]] bool has(std::size_t picture) const {
    return picture >= first && picture - first < count;
  }
};

// Loads the pictures of the range; each is valid. The error names the file, the part (of several),
// and the reason.
[[nodiscard]] Result<PictureFile> load_picture_file(const std::filesystem::path& path,
                                                    const PictureRange& range = {});
// Loads all pictures of a file.
[[nodiscard]] Result<std::vector<DepthImage>> load_pictures(const std::filesystem::path& path);

}  // namespace rilievo
