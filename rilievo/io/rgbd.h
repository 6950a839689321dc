// Reads photographs with depth, taken by a moving camera, as pictures with depth (S2.7).
//
// Three formats are recognised by the files in the folder:
//   transforms.json   nerfstudio, instant-ngp: intrinsics for all frames or each (fl_x fl_y cx cy,
//   or
//                     camera_angle_x and camera_angle_y), `transform_matrix` camera to world with
//                     the camera looking down -z, y up; depth in `depth_file_path`, times
//                     `integer_depth_scale` or `depth_unit_scale_factor` metres (0.001). Raster
//                     positions count from the top left corner of the image
//   trajectory.log    Open3D, Redwood: entry i is the i-th file, by the numbers in its name, of
//                     color/ (or rgb/, image/) and of depth/; camera to world, the camera looking
//                     down +z, y down; camera_intrinsic.json or intrinsic.json, else PrimeSense
//                     (525 525 319.5 239.5, which needs 640 x 480). Positions count from the top
//                     left texel's centre; millimetres
//   NAME.pose.txt     one a frame (tsdf-fusion, 7-Scenes), with NAME.color.png or .jpg,
//                     NAME.depth.png, and one camera-intrinsics.txt; otherwise as Open3D
//
// Depth is a 16-bit grey PNG: distance along the optical axis (eye_z), registered with the colours
// and of their size; 0 and 65535 mean "not measured". Poses written with few digits are rounded to
// the nearest rigid motion; poses farther than 1 % from it are refused. A frame whose pose is not
// finite, or singular, is left out with a warning: its camera was not found. Paths may be written
// as Windows does.
//
// Lenses with distortion (lens_distortion.h) are undistorted as a frame is loaded: the picture of
// the pinhole with the same intrinsics, colours interpolated, depth that of the nearest texel.
//
// A frame loads as a DepthImage of eye_z with linear colours. A texel that was not measured has no
// depth but keeps its colour with alpha 1: the photograph shows something there. A texel that is
// masked out shows nothing: colour 0 0 0 0. Alpha below one half masks out, and so does what is
// dark in a mask: `mask_path`; else the file of the image's name in masks/ or mask/ beside the
// images' folder, or NAME.mask.png; else, white instead of dark, dynamic_mask_NAME.png beside the
// image.
//
// World space of the capture, metres. Opening reads the poses and checks that all files exist.
// Pictures are decoded one at a time, so that a capture can be larger than the memory.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"
#include "rilievo/io/lens_distortion.h"
#include "rilievo/io/warnings.h"

namespace rilievo {

// The format of a capture, in the order of the table above.
enum class RgbdFormat { nerfstudio, redwood, pose_files };

// A lens in texels, raster space (origin at the top left corner of the image). NaN means that the
// image's size decides.
struct RgbdIntrinsics {
  double fl_x = 0, fl_y = 0;        // focal lengths
  double cx = 0, cy = 0;            // principal point; NaN: the centre
  double angle_x = 0, angle_y = 0;  // fields of view, radians; used where fl_x or fl_y is NaN; 0:
                                    // the other axis decides
  int width = 0, height = 0;        // 0: the size of the image
  LensDistortion distortion = {};
};

// One photograph with depth, not yet decoded.
struct RgbdFrame {
  std::string name;  // of its colour file, without folder and extension
  std::filesystem::path color, depth;
  std::filesystem::path mask = {};  // empty: none
  bool mask_is_dark = true;         // what is dark is masked out, else what is light
  glm::dmat4 world_from_eye{1.0};   // rigid
  RgbdIntrinsics intrinsics;
  double metres_per_unit = 0.001;
};

// An opened capture.
struct RgbdCapture {
  RgbdFormat format = RgbdFormat::pose_files;
  std::vector<RgbdFrame> frames;  // at least one, in the capture's order
  Warnings warnings = {};
};

// Is `path` a capture: one of the files above, or a folder that contains one?
[[nodiscard]] bool is_rgbd_capture(const std::filesystem::path& path);

// Opens a capture; `path` is its folder, transforms.json or trajectory.log. The error names the
// file and the reason. `allow_outside` permits images of transforms.json outside its folder.
[[nodiscard]] Result<RgbdCapture> open_rgbd_capture(const std::filesystem::path& path,
                                                    bool allow_outside = false);

// Decodes a frame. The camera's z_near and z_far enclose the depths with a margin. Fails on a frame
// without any depth, and on one that needs more than `max_bytes` for files and pictures together.
[[nodiscard]] Result<DepthImage> load_rgbd_frame(const RgbdFrame& frame,
                                                 std::uint64_t max_bytes = std::uint64_t(4) << 30);

}  // namespace rilievo
