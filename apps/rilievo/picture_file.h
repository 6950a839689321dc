// What does a file of pictures with depth contain? Either the pictures of a frame, with the data to
// draw the frame again, or a baked representation.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"
#include "rilievo/kind/kind.h"

namespace rilievo::app {

struct FramePictures {
  std::vector<DepthImage> pictures;
  std::optional<Camera> camera;  // of the frame
  int delta_bits = 16;
  WorldSpace world;
};

[[nodiscard]] Result<> save_frame_pictures(const std::string& file, const FramePictures& frame);

// Any OpenEXR file of pictures: of a kind if it says so, else plain pictures; `camera` only if the
// pictures are a frame's of ours.
struct PictureFileContent {
  const Kind* kind = nullptr;
  std::unique_ptr<Representation> representation;  // of the kind
  FramePictures frame;                             // if there is no kind
};
[[nodiscard]] Result<PictureFileContent> open_pictures(const std::string& file);

// The same of a file that must hold one of the kinds.
[[nodiscard]] Result<PictureFileContent> open_representation(const std::string& file);

}  // namespace rilievo::app
