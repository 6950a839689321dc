// Copies of keyframes on the GPU.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/gl/object.h"
#include "rilievo/keyframes/warp_sources.h"

namespace rilievo {

// Keeps the keyframes that were warped last. Needs a current OpenGL context.
class StoredKeyframes {
 public:
  // Uploads those that are not there yet (Keyframe::number), and new depths of those of which other
  // objects are hidden by now. Their words, the colours and behind them the depths, are in
  // buffers() in the order of `sources`. Fails for more than the driver takes.
  Result<> store(std::span<const WarpSource> sources);
  [[nodiscard]] std::span<const GLuint> buffers() const { return bound_; }
  // How many bytes the last store() copied.
  [[nodiscard]] std::size_t uploaded() const { return uploaded_; }

 private:
  struct Stored {
    std::uint64_t number = 0;  // 0: none
    std::vector<std::uint32_t> hidden;
    gl::Buffer words;
    std::size_t bytes = 0;
    bool used = false;  // in this frame
  };
  Result<> upload(const Keyframe& keyframe, Stored& stored);
  void upload_depths(const Keyframe& keyframe, Stored& stored);

  std::vector<Stored> stored_;
  std::vector<GLuint> bound_;
  std::size_t uploaded_ = 0;
};

}  // namespace rilievo
