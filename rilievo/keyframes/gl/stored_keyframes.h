// Copies of keyframes on the GPU.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/gl/object.h"
#include "rilievo/keyframes/warp_sources.h"

namespace rilievo {

// A keyframe's colours (R32UI) and 1 / eye_z (R32F), in the upper left of textures that may be
// larger: texel (0, 0) is the first of the first row.
struct KeyframeTextures {
  GLuint color = 0, inverse_z = 0;
};

// Keeps the keyframes that were warped last. Needs a current OpenGL context.
class StoredKeyframes {
 public:
  // Uploads those that are not there yet (Keyframe::number), and new depths of those of which other
  // objects are hidden by now. Fails for larger ones than the driver takes.
  Result<> store(std::span<const WarpSource> sources);
  // Those of the last store(), in the order of its sources.
  [[nodiscard]] std::span<const KeyframeTextures> textures() const { return textures_; }
  // How many bytes the last store() copied.
  [[nodiscard]] std::size_t uploaded() const { return uploaded_; }

 private:
  struct Stored {
    std::uint64_t number = 0;  // 0: none
    std::vector<std::uint32_t> hidden;
    gl::Texture color, inverse_z;
    int width = 0, height = 0, finer = 1;  // of texels, and colours for each of their sides
    bool used = false;                     // in this frame

    [[nodiscard]] bool holds(const Keyframe& keyframe) const;
  };
  [[nodiscard]] Stored& room_for(const Keyframe& keyframe);
  Result<> upload(const Keyframe& keyframe, Stored& stored);
  void upload_depths(const Keyframe& keyframe, Stored& stored);

  std::vector<Stored> stored_;
  std::vector<KeyframeTextures> textures_;
  std::size_t uploaded_ = 0;
};

}  // namespace rilievo
