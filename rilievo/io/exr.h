// How are pictures with depth kept in files that any OpenEXR tool opens?
//
// A picture is one part of an OpenEXR file (several pictures: a multi-part file, ZIP, scan lines):
//   channels    R G B A half, linear and premultiplied; Z float; id uint if the picture has objects
//   Z           the picture's own kind of depth (eye_z unless `rilievo.depthKind` says otherwise);
//               +infinity where the texel shows nothing
//   windows     the data window is the picture; the display window, which OpenEXR wants to be the
//               same in all parts, begins there and is as large as the largest picture
//   standard    worldToCamera, worldToNDC (exr_camera.h), screenWindowCenter, screenWindowWidth;
//               pixelAspectRatio if it is the same for all pictures, else 1
//   our own     rilievo.version (int 1), .name .projection .depthKind (string), .worldFromEye
//               (m44d, rows are the camera's axes and position), .windowMin .windowMax (v2d: left
//               bottom, right top), .size (v2i), .depthRange (v2d: z_near z_far): the camera,
//               exactly;
//               rilievo.file.KEY (first part), rilievo.picture.KEY (string): attributes of callers
//
// What is read back equals what was written, bit for bit, once colours are halfs: saving rounds
// them to nearest and clamps them to +-65504.
//
// A foreign file loads if every part has R G B (A, id optional), Z and both standard matrices:
// Z is taken as eye_z, and where it is 0 or at least 1e30 the texel shows nothing; z_near and z_far
// come from the depths. A data window that differs from the display window is a crop of
// the matrices' camera. Tiled and mipmapped parts give their base level. Deep parts, sub-sampled
// channels, depths that are not numbers and files that claim more texels than their bytes can hold
// are refused. Reading and writing run in the caller's thread.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "rilievo/core/depth_image.h"

namespace rilievo {

using Attributes = std::map<std::string, std::string>;

struct FileAttributes {
  Attributes file;
  std::vector<Attributes> pictures;  // one for each picture, or none at all
};

struct PictureFile {
  std::vector<DepthImage> pictures;
  FileAttributes attributes;  // `pictures` as long as the pictures are many
};

// Requires at least one picture, and valid ones (an invalid picture is an error, not a crash).
// Keys are 1 to 200 printable characters without spaces. Replaces the file at once or not at all.
[[nodiscard]] Result<> save_pictures(const std::filesystem::path& path,
                                     std::span<const DepthImage> pictures,
                                     const FileAttributes& attributes = {});

// Of which of a file's pictures are the planes read? All others come without: name, camera and
// attributes only.
struct PictureRange {
  std::size_t first = 0, count = std::size_t(-1);

  [[nodiscard]] bool has(std::size_t picture) const {
    return picture >= first && picture - first < count;
  }
};

// Every picture of the range is valid. The error names the file, the part if there are several, and
// the reason.
[[nodiscard]] Result<PictureFile> load_picture_file(const std::filesystem::path& path,
                                                    const PictureRange& range = {});
[[nodiscard]] Result<std::vector<DepthImage>> load_pictures(const std::filesystem::path& path);

}  // namespace rilievo
