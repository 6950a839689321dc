// Writes pictures with depth as captures of all three kinds, for tests to read back.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "rilievo/core/file.h"
#include "rilievo/io/png.h"
#include "rilievo/io/png_test_helpers.h"
#include "rilievo/io/rgbd.h"

namespace rilievo::test_rgbd {

inline void write_images(const DepthImage& picture, const std::filesystem::path& color,
                         const std::filesystem::path& depth) {
  Image<std::uint16_t> units(picture.depth.width(), picture.depth.height());
  for (int y = 0; y < units.height(); ++y)
    for (int x = 0; x < units.width(); ++x)
      if (picture.covered(x, y))
        units(x, y) = std::uint16_t(std::lround(picture.depth(x, y) * 1000));
  (void)save_png(color, srgb8_from_linear(picture.color));
  (void)write_file(depth, test_png::grey16_png(units));
}

// 16 numbers, row by row.
inline std::string rows_text(const glm::dmat4& m, const char* between, const char* row_end) {
  std::string text;
  for (int r = 0; r < 4; ++r)
    text += fmt::format("{:.9g}{}{:.9g}{}{:.9g}{}{:.9g}{}", m[0][r], between, m[1][r], between,
                        m[2][r], between, m[3][r], r < 3 ? row_end : "");
  return text;
}

struct Lens {
  double fl_x, fl_y, cx, cy;
};
inline Lens lens_of(const Camera& c) {
  const double fl_x = c.width / (c.window.right - c.window.left);
  const double fl_y = c.height / (c.window.top - c.window.bottom);
  return {fl_x, fl_y, -c.window.left * fl_x, c.window.top * fl_y};
}

// Pictures of eye_z, all with the first one's lens. Only nerfstudio's kind can do with others.
inline void write_capture(const std::filesystem::path& folder, RgbdFormat format,
                          const std::vector<DepthImage>& pictures) {
  namespace fs = std::filesystem;
  const Camera& first = pictures.front().camera;
  const Lens lens = lens_of(first);
  const glm::dmat4 flip = {{1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, 1}};
  std::string text;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const DepthImage& picture = pictures[i];
    const std::string name = fmt::format("frame-{:06}", i);
    if (format == RgbdFormat::pose_files) {
      write_images(picture, folder / (name + ".color.png"), folder / (name + ".depth.png"));
      (void)write_file(folder / (name + ".pose.txt"),
                       rows_text(picture.camera.world_from_eye * flip, "\t ", "\t\n") + "\n");
      continue;
    }
    fs::create_directories(folder / "color");
    fs::create_directories(folder / "depth");
    write_images(picture, folder / "color" / (name + ".png"), folder / "depth" / (name + ".png"));
    if (format == RgbdFormat::redwood) {
      text += fmt::format("{0} {0} {1}\n{2}\n", i, i + 1,
                          rows_text(picture.camera.world_from_eye * flip, " ", "\n"));
    } else {
      const Lens own = lens_of(picture.camera);
      text += fmt::format(
          "{}{{\"file_path\": \"color/{}\", \"depth_file_path\": \"depth/{}.png\", \"fl_x\": "
          "{:.12g}, \"fl_y\": {:.12g}, \"cx\": {:.12g}, \"cy\": {:.12g}, \"transform_matrix\": "
          "[[{}]]}}",
          i ? ",\n" : "", name, name, own.fl_x, own.fl_y, own.cx, own.cy,
          rows_text(picture.camera.world_from_eye, ", ", "], ["));
    }
  }
  if (format == RgbdFormat::pose_files) {
    (void)write_file(folder / "camera-intrinsics.txt",
                     fmt::format("{:.12g} 0 {:.12g}\n0 {:.12g} {:.12g}\n0 0 1\n", lens.fl_x,
                                 lens.cx - 0.5, lens.fl_y, lens.cy - 0.5));
  } else if (format == RgbdFormat::redwood) {
    (void)write_file(folder / "trajectory.log", text);
    (void)write_file(
        folder / "camera_intrinsic.json",
        fmt::format("{{\"width\": {}, \"height\": {}, \"intrinsic_matrix\": [{:.12g}, "
                    "0, 0, 0, {:.12g}, 0, {:.12g}, {:.12g}, 1]}}",
                    first.width, first.height, lens.fl_x, lens.fl_y, lens.cx - 0.5, lens.cy - 0.5));
  } else {
    (void)write_file(folder / "transforms.json",
                     fmt::format("{{\"w\": {}, \"h\": {}, \"k1\": 0.0, \"frames\": [{}]}}",
                                 first.width, first.height, text));
  }
}

}  // namespace rilievo::test_rgbd
