// Captures of photographs with depth (io/rgbd.h) on the command line.
#pragma once

#include <string>
#include <vector>

#include "apps/rilievo/layered_options.h"
#include "apps/rilievo/scene_file.h"
#include "rilievo/core/result.h"

namespace rilievo::app {

struct CaptureBakeOptions {
  std::string capture, output, json;
  LayeredBakeOptions bake;
  FileLimits limits;
  std::vector<double> box;  // x0 y0 z0 x1 y1 z1, or none: all that was measured
  bool around = false;      // views around the box, as of a scene; else at the capture's cameras
};

// Bakes a layered impostor and says how much of it no photograph filled. Needs no OpenGL.
[[nodiscard]] Result<> bake_capture(const CaptureBakeOptions& options);

// Frames, size and bounds.
[[nodiscard]] Result<> describe_capture(const std::string& path, const std::string& json,
                                        const FileLimits& limits);

}  // namespace rilievo::app
