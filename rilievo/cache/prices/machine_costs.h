// The costs of pictures, polygons and captures on one machine.
//
// The planner compares costs; policy.h has those of the machine that it was written on. These are
// of any other: measured in a second or two (cache/software/measure_software.h, cache/gl/
// measure_opengl.h), kept in a file (docs/formats.md), and handed to the cache in
// ImageCacheOptions. With the same file the cache decides the same on all machines. All times are
// nanoseconds of a frame with 4 samples a pixel, on all cores. Plain data; pure functions.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "rilievo/core/result.h"

namespace rilievo {

// The time of drawing a frame, by one backend.
struct DrawTimes {
  double picture_ns = 0;        // one picture, and ...
  double picture_pixel_ns = 0;  // ... each pixel of its rectangle
  double object_ns = 0;         // one object drawn as polygons, ...
  double triangle_ns = 0;       // ... each of its triangles, small ones, ...
  double polygon_pixel_ns = 0;  // ... and each pixel of the rectangle around it

  friend bool operator==(const DrawTimes&, const DrawTimes&) = default;
};

// The time of frames of polygons, by one backend: enough to tell which of two is faster. The time
// of objects is in that of their triangles.
struct PolygonTimes {
  double triangle_ns = 0, pixel_ns = 0;
  [[nodiscard]] double frame_ms(double triangles, double pixels) const {
    return 1e-6 * (triangle_ns * triangles + pixel_ns * pixels);
  }
};

// The time of captures and of their gaps, by one backend.
struct CaptureTimes {
  double picture_ns = 0;   // one capture, and ...
  double triangle_ns = 0;  // ... each of its triangles ...
  double texel_ns = 0;     // ... and texels

  friend bool operator==(const CaptureTimes&, const CaptureTimes&) = default;
};

// One machine.
struct MachineCosts {
  std::string cpu, gl_renderer;  // for readers; nothing depends on them
  int threads = 0;
  DrawTimes draw_software;
  CaptureTimes capture_rasterizer;
  double ray_texel_ns = 0;               // a texel of a coarse picture (policy.h, Fallback)
  std::optional<DrawTimes> draw_opengl;  // none: there is no OpenGL
  std::optional<CaptureTimes> capture_opengl;

  friend bool operator==(const MachineCosts&, const MachineCosts&) = default;
};

// The costs of frames drawn by software if no machine is given: two cores on which OpenGL takes the
// 280 ns a triangle of policy.h. Triangles are dear only there. Fitted to frames of real models,
// where prices that measure_software() finds are off by up to 2.5 times: drawn triangles hide each
// other, and captures look through several surfaces.
[[nodiscard]] MachineCosts builtin_software_costs();

// Every time lies between these: nothing real is faster or slower.
inline constexpr double kLeastNs = 1e-4, kMostNs = 1e9;

// As a file has it, and back. Fails for what is no such file, and where a time is missing, no
// number, or out of the range above; `where` is named in errors.
[[nodiscard]] std::string machine_json(const MachineCosts& costs);
[[nodiscard]] Result<MachineCosts> parse_machine(std::string_view text, const std::string& where);
[[nodiscard]] Result<MachineCosts> load_machine(const std::filesystem::path& file);
// Writes the file, or leaves the old one.
[[nodiscard]] Result<> save_machine(const MachineCosts& costs, const std::filesystem::path& file);

}  // namespace rilievo
