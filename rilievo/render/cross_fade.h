// The pixels of an object that are drawn while it fades in or out.
#pragma once

#include <cstdint>

namespace rilievo {

// A cross-fade range: the object is drawn only at pixels whose hash (shader::kPixelHash) lies in
// [from, to). Something else is drawn at the other pixels.
struct CrossFade {
  std::uint32_t object = 0;  // index into Scene::objects
  float from = 0, to = 1;
};

}  // namespace rilievo
