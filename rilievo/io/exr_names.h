// What our own attributes are called in an OpenEXR file; see exr.h. Shared by writer and reader.
#pragma once

#include <array>
#include <string_view>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth.h"

namespace rilievo::exr {

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

// In the order of their enumerators.
inline constexpr std::array<const char*, 3> kProjections = {"perspective", "back_perspective",
                                                            "parallel"};
inline constexpr std::array<const char*, 3> kDepthKinds = {"window_z", "eye_z", "ray"};

}  // namespace rilievo::exr
