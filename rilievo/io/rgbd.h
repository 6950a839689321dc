// How are photographs with depth, taken by a moving camera, read as pictures with depth? (S2.7)
//
// Three ways in which such captures are kept, told apart by what the folder holds:
//   transforms.json   nerfstudio: intrinsics for all frames or each, `transform_matrix` camera to
//                     world with the camera looking down -z, y up; depth in `depth_file_path`,
//                     times `integer_depth_scale` or `depth_unit_scale_factor` metres (0.001).
//                     Raster positions count from the top left corner of the image
//   trajectory.log    Open3D, Redwood: entry i is the i-th file, by name, of color/ (or rgb/,
//                     image/) and of depth/; camera to world, the camera looking down +z, y down;
//                     camera_intrinsic.json or intrinsic.json, else PrimeSense (525 525 319.5
//                     239.5, which needs 640 x 480). Positions count from the top left texel's
//                     centre; millimetres
//   NAME.pose.txt     one a frame (tsdf-fusion, 7-Scenes), with NAME.color.png or .jpg,
//                     NAME.depth.png, and one camera-intrinsics.txt; otherwise as Open3D
//
// Depth is 16-bit grey PNG, distance along the optical axis (eye_z), registered with the colours
// and of their size; 0 and 65535 are "not measured". Poses written with few digits are rounded to
// the nearest rigid motion; one that is farther from it than 1 % is refused, as are lenses with
// distortion: undistort the images first.
//
// A frame loads as a DepthImage of eye_z, colours linear. A texel that was not measured has no
// depth but keeps its colour, alpha 1: the photograph knows something there. A texel that the
// photograph masks out (alpha below one half) shows nothing: colour 0 0 0 0.
//
// World space of the capture, metres. Opening reads poses and looks whether the files are there;
// pictures are decoded one at a time, so that a capture may be larger than the memory.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"

namespace rilievo {

enum class RgbdFormat { nerfstudio, redwood, pose_files };

// Texels, raster space (origin at the top left corner of the image). NaN where the image's own
// size decides.
struct RgbdIntrinsics {
  double fl_x = 0, fl_y = 0;  // focal lengths
  double cx = 0, cy = 0;      // principal point; NaN: the centre
  double angle_x = 0;         // whole horizontal angle, radians, where fl_x is NaN
  int width = 0, height = 0;  // 0: whatever the image has
};

struct RgbdFrame {
  std::string name;  // of its colour file, without folder and ending
  std::filesystem::path color, depth;
  glm::dmat4 world_from_eye{1.0};  // rigid
  RgbdIntrinsics intrinsics;
  double metres_per_unit = 0.001;
};

struct RgbdCapture {
  RgbdFormat format = RgbdFormat::pose_files;
  std::vector<RgbdFrame> frames;  // at least one, in the capture's order
};

// Does the path look like a capture: one of the files above, or a folder that holds one?
[[nodiscard]] bool is_rgbd_capture(const std::filesystem::path& path);

// `path` is the folder, or its transforms.json or trajectory.log. The error names the file and what
// is wrong with it. `allow_outside`: may transforms.json name images that do not lie in its folder
// or below it?
[[nodiscard]] Result<RgbdCapture> open_rgbd_capture(const std::filesystem::path& path,
                                                    bool allow_outside = false);

// The camera's z_near and z_far leave room around the depths. Fails on a frame without any depth,
// and on one that would take more than `max_bytes`, files and pictures together.
[[nodiscard]] Result<DepthImage> load_rgbd_frame(const RgbdFrame& frame,
                                                 std::uint64_t max_bytes = std::uint64_t(4) << 30);

}  // namespace rilievo
