// Files of pictures with depth: those that a frame was drawn from, with what it takes to draw that
// frame again, and layered impostors.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo::app {

struct FramePictures {
  std::vector<DepthImage> pictures;
  std::optional<Camera> camera;  // of the frame
  int delta_bits = 16;
};

[[nodiscard]] Result<> save_frame_pictures(const std::string& file, const FramePictures& frame);

// Any OpenEXR file of pictures: a layered impostor if it says so; `camera` only if the pictures are
// a frame's of ours.
using PictureFileContent = std::variant<FramePictures, LayeredImpostor>;
[[nodiscard]] Result<PictureFileContent> open_pictures(const std::string& file);

}  // namespace rilievo::app
