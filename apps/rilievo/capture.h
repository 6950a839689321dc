// How are captures of photographs with depth (io/rgbd.h) used on the command line?
#pragma once

#include <string>

#include "apps/rilievo/scene_file.h"
#include "rilievo/capture/photograph_source.h"
#include "rilievo/core/result.h"

namespace rilievo::app {

// A capture of photographs, or one for Google's Seurat: its manifest, or the folder that holds it.
[[nodiscard]] bool is_capture(const std::string& path);

// All photographs of a capture, or views, decoded. Needs no OpenGL.
[[nodiscard]] Result<PhotographSource> open_photographs(const std::string& path,
                                                        const FileLimits& limits);

// Frames, size and bounds.
[[nodiscard]] Result<> describe_capture(const std::string& path, const std::string& json,
                                        const FileLimits& limits);

}  // namespace rilievo::app
