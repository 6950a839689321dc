// How does a picture become bytes, and the same picture again, to the bit?
//
// Little-endian, no gaps: "RLVP", version, width, height, projection, kind of depth, has objects,
// size of the name; the camera in doubles; the name; colours, depths, objects as floats and
// integers. Internal to capture. Pure; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/core/depth_image.h"

namespace rilievo {

// The bytes of a picture.
[[nodiscard]] std::vector<std::byte> picture_bytes(const DepthImage& picture);
// Nothing if these are not the bytes of a valid picture.
[[nodiscard]] std::optional<DepthImage> picture_from_bytes(std::span<const std::byte> bytes);

}  // namespace rilievo
