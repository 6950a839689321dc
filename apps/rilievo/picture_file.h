// Files of the pictures that a frame was drawn from, with what it takes to draw that frame again.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"

namespace rilievo::app {

struct FramePictures {
  std::vector<DepthImage> pictures;
  std::optional<Camera> camera;  // of the frame
  int delta_bits = 16;
};

[[nodiscard]] Result<> save_frame_pictures(const std::string& file, const FramePictures& frame);

// Any OpenEXR file of pictures; `camera` only if it is one of ours.
[[nodiscard]] Result<FramePictures> load_frame_pictures(const std::string& file);

}  // namespace rilievo::app
