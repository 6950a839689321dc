// Which share of an object's pixels is drawn, while something else stands for the others?
#pragma once

#include <cstdint>

namespace rilievo {

// An object drawn only where the pixel's hash (shader::kPixelHash) lies in [from, to): it fades in
// or out.
struct CrossFade {
  std::uint32_t object = 0;  // index into Scene::objects
  float from = 0, to = 1;
};

}  // namespace rilievo
