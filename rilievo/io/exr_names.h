// What are our attributes called in an OpenEXR file? Internal; described in exr.h.
#pragma once

#include <array>
#include <string_view>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth.h"

namespace rilievo::exr {

// The version of the attributes, and their names:
inline constexpr int kVersion = 1;
inline constexpr char kVersionName[] = "rilievo.version";
inline constexpr char kName[] = "rilievo.name";
inline constexpr char kProjection[] = "rilievo.projection";
inline constexpr char kDepthKind[] = "rilievo.depthKind";
inline constexpr char kWorldFromEye[] = "rilievo.worldFromEye";
inline constexpr char kWindowMin[] = "rilievo.windowMin";
inline constexpr char kWindowMax[] = "rilievo.windowMax";
inline constexpr char kSize[] = "rilievo.size";
inline constexpr char kDepthRange[] = "rilievo.depthRange";
inline constexpr std::string_view kFilePrefix = "rilievo.file.";
inline constexpr std::string_view kPicturePrefix = "rilievo.picture.";

// The values of rilievo.projection and rilievo.depthKind, in the order of the enumerators:
inline constexpr std::array<const char*, 3> kProjections = {"perspective", "back_perspective",
                                                            "parallel"};
inline constexpr std::array<const char*, 3> kDepthKinds = {"window_z", "eye_z", "ray"};

}  // namespace rilievo::exr
