#include "rilievo/relief_impostor/valid_eyes.h"

#include <algorithm>

namespace rilievo {
namespace {

class EyeMap {
 public:
  EyeMap(const ImpostorPicture& picture, const ValidEyesOptions& options)
      : picture_(picture), options_(options), known_(options.size, options.size) {
    map.valid = Image<std::uint8_t>(options.size, options.size);
  }

  bool valid(int x, int y) {
    if (known_(x, y) == 0) {
      known_(x, y) = 1;
      ++map.tried;
      const auto counted =
          warp_impostor(picture_, eye_of(picture_, options_, x, y), {}, scratch_, result_);
      map.valid(x, y) = counted && counted->share() <= options_.max_share ? 1 : 0;
    }
    return map.valid(x, y) != 0;
  }

  // A square whose corners are known: filled if they agree, else cut into four.
  void fill(int x0, int y0, int x1, int y1) {
    const bool first = valid(x0, y0);
    const bool same = valid(x1, y0) == first && valid(x0, y1) == first && valid(x1, y1) == first;
    if (same) {
      for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x)
          if (known_(x, y) == 0) map.valid(x, y) = first ? 1 : 0;
      return;
    }
    if (x1 - x0 <= 1 && y1 - y0 <= 1) return;
    const int x = (x0 + x1) / 2, y = (y0 + y1) / 2;
    fill(x0, y0, x, y);
    if (x < x1 && x > x0) fill(x, y0, x1, y);
    if (y < y1 && y > y0) fill(x0, y, x, y1);
    if (x < x1 && x > x0 && y < y1 && y > y0) fill(x, y, x1, y1);
  }

  ValidEyes map;

 private:
  const ImpostorPicture& picture_;
  const ValidEyesOptions& options_;
  Image<std::uint8_t> known_;
  ImpostorWarpScratch scratch_;
  Prewarped result_;
};

}  // namespace

glm::dvec3 eye_of(const ImpostorPicture& picture, const ValidEyesOptions& options, int x, int y) {
  const Camera& camera = picture.geometry.capture;
  const double middle = 0.5 * (options.size - 1), unit = options.extent / middle;
  return camera.position() + glm::dvec3(camera.world_from_eye[0]) * ((x - middle) * unit) +
         glm::dvec3(camera.world_from_eye[2]) * ((y - middle) * unit);
}

ValidEyes valid_eyes(const ImpostorPicture& picture, const ValidEyesOptions& options) {
  RILIEVO_EXPECTS(options.size >= 2 && options.step >= 1 && options.extent > 0);
  EyeMap map(picture, options);
  const int last = options.size - 1;
  if (options.step == 1) {
    for (int y = 0; y <= last; ++y)
      for (int x = 0; x <= last; ++x) (void)map.valid(x, y);
    return std::move(map.map);
  }
  for (int y = 0; y < last; y += options.step)
    for (int x = 0; x < last; x += options.step)
      map.fill(x, y, std::min(x + options.step, last), std::min(y + options.step, last));
  return std::move(map.map);
}

Rgba8Image picture_of(const ValidEyes& eyes) {
  const int w = eyes.valid.width(), h = eyes.valid.height();
  Rgba8Image picture(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      picture(x, y) =
          eyes.valid(x, y) ? glm::u8vec4(60, 160, 80, 255) : glm::u8vec4(90, 90, 90, 255);
  picture(w / 2, h / 2) = glm::u8vec4(255);
  return picture;
}

}  // namespace rilievo
