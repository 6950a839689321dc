#include "rilievo/keyframes/gl/stored_keyframes.h"

#include <algorithm>
#include <string>

namespace rilievo {
namespace {

std::size_t bytes_of(const Keyframe& keyframe) {
  return keyframe.color.texels().size_bytes() + keyframe.inverse_z.texels().size_bytes();
}

}  // namespace

Result<> StoredKeyframes::store(std::span<const WarpSource> sources) {
  uploaded_ = 0;
  bound_.clear();
  for (Stored& one : stored_) one.used = false;
  // First those that are there, so that none of them makes room for another one.
  const auto find = [&](const Keyframe& keyframe) {
    return std::ranges::find_if(stored_, [&](const Stored& one) {
      return keyframe.number != 0 && one.number == keyframe.number;
    });
  };
  for (const WarpSource& source : sources)
    if (const auto at = find(*source.keyframe); at != stored_.end()) {
      at->used = true;
      if (at->hidden != source.keyframe->hidden) upload_depths(*source.keyframe, *at);
    }
  for (const WarpSource& source : sources) {
    auto at = find(*source.keyframe);
    if (at == stored_.end()) {
      // As large a one as it needs, if there is one.
      const std::size_t bytes = bytes_of(*source.keyframe);
      at = std::ranges::find_if(stored_,
                                [&](const Stored& one) { return !one.used && one.bytes == bytes; });
      if (at == stored_.end()) at = std::ranges::find_if_not(stored_, &Stored::used);
      if (at == stored_.end()) at = stored_.insert(at, Stored{});
      at->used = true;
      if (Result<> done = upload(*source.keyframe, *at); !done) return done;
    }
    bound_.push_back(at->words);
  }
  return Done{};
}

Result<> StoredKeyframes::upload(const Keyframe& keyframe, Stored& stored) {
  const std::size_t bytes = bytes_of(keyframe);
  stored.number = 0;
  if (stored.bytes != bytes) {
    GLint64 most = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    if (bytes > std::size_t(most))
      return Error{"keyframe", std::to_string(bytes >> 20) + " MB are more than OpenGL takes (" +
                                   std::to_string(most >> 20) + " MB)"};
    stored.words = gl::Buffer();
    stored.words = gl::make_buffer(bytes, nullptr, GL_DYNAMIC_STORAGE_BIT);
    stored.bytes = bytes;
  }
  const std::span<const std::uint32_t> colors = keyframe.color.texels();
  glNamedBufferSubData(stored.words, 0, GLsizeiptr(colors.size_bytes()), colors.data());
  uploaded_ += colors.size_bytes();
  upload_depths(keyframe, stored);
  stored.number = keyframe.number;
  return Done{};
}

void StoredKeyframes::upload_depths(const Keyframe& keyframe, Stored& stored) {
  const std::span<const float> depths = keyframe.inverse_z.texels();
  glNamedBufferSubData(stored.words, GLintptr(keyframe.color.texels().size_bytes()),
                       GLsizeiptr(depths.size_bytes()), depths.data());
  uploaded_ += depths.size_bytes();
  stored.hidden = keyframe.hidden;
}

}  // namespace rilievo
