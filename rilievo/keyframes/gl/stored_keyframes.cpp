#include "rilievo/keyframes/gl/stored_keyframes.h"

#include <algorithm>
#include <string>

#include "rilievo/keyframes/gl/unfiltered_texture.h"

namespace rilievo {
namespace {

// So many are kept before the memory of one that is not used any more is made larger: keyframes
// grow and shrink as the eye begins to turn and ends it.
constexpr std::size_t kKeptAtFirst = 4;

int finer_of(const Keyframe& keyframe) { return keyframe.quarters() ? 2 : 1; }

}  // namespace

bool StoredKeyframes::Stored::holds(const Keyframe& keyframe) const {
  return width >= keyframe.camera.width && height >= keyframe.camera.height &&
         finer == finer_of(keyframe);
}

Result<> StoredKeyframes::store(std::span<const WarpSource> sources) {
  uploaded_ = 0;
  textures_.clear();
  for (Stored& one : stored_) one.used = false;
  const auto find = [&](const Keyframe& keyframe) {
    return std::ranges::find_if(stored_, [&](const Stored& one) {
      return keyframe.number != 0 && one.number == keyframe.number;
    });
  };
  // First those that are there, so that none of them makes room for another one.
  for (const WarpSource& source : sources)
    if (const auto at = find(*source.keyframe); at != stored_.end()) {
      at->used = true;
      if (at->hidden != source.keyframe->hidden) upload_depths(*source.keyframe, *at);
    }
  for (const WarpSource& source : sources) {
    const auto at = find(*source.keyframe);
    const bool there = at != stored_.end();
    Stored& stored = there ? *at : room_for(*source.keyframe);
    if (!there)
      if (Result<> done = upload(*source.keyframe, stored); !done) return done;
    stored.used = true;
    textures_.push_back({stored.color, stored.inverse_z});
  }
  return Done{};
}

// Memory that suffices, if there is some.
StoredKeyframes::Stored& StoredKeyframes::room_for(const Keyframe& keyframe) {
  const auto suffices = std::ranges::find_if(
      stored_, [&](const Stored& one) { return !one.used && one.holds(keyframe); });
  if (suffices != stored_.end()) return *suffices;
  const auto unused = std::ranges::find_if_not(stored_, &Stored::used);
  if (unused != stored_.end() && stored_.size() >= kKeptAtFirst) return *unused;
  return stored_.emplace_back();
}

Result<> StoredKeyframes::upload(const Keyframe& keyframe, Stored& stored) {
  stored.number = 0;
  const int finer = finer_of(keyframe);
  if (!stored.holds(keyframe)) {
    const int width = std::max(stored.width, keyframe.camera.width),
              height = std::max(stored.height, keyframe.camera.height);
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    if (finer * std::max(width, height) > most)
      return Error{"keyframe", std::to_string(width) + " x " + std::to_string(height) +
                                   " texels are more than OpenGL takes (" +
                                   std::to_string(most / finer) + " a side)"};
    stored.color = gl::Texture(), stored.inverse_z = gl::Texture();
    stored.color = make_unfiltered(GL_R32UI, finer * width, finer * height);
    stored.inverse_z = make_unfiltered(GL_R32F, width, height);
    stored.width = width, stored.height = height, stored.finer = finer;
  }
  const Image<std::uint32_t>& color = keyframe.color;
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTextureSubImage2D(stored.color, 0, 0, 0, color.width(), color.height(), GL_RED_INTEGER,
                      GL_UNSIGNED_INT, color.texels().data());
  uploaded_ += color.texels().size_bytes();
  upload_depths(keyframe, stored);
  stored.number = keyframe.number;
  return Done{};
}

void StoredKeyframes::upload_depths(const Keyframe& keyframe, Stored& stored) {
  const Image<float>& depths = keyframe.inverse_z;
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTextureSubImage2D(stored.inverse_z, 0, 0, 0, depths.width(), depths.height(), GL_RED, GL_FLOAT,
                      depths.texels().data());
  uploaded_ += depths.texels().size_bytes();
  stored.hidden = keyframe.hidden;
}

}  // namespace rilievo
