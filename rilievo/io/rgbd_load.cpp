#include <algorithm>
#include <cmath>
#include <cstdint>

#include "rilievo/core/file.h"
#include "rilievo/io/picture_decode.h"
#include "rilievo/io/rgbd.h"

namespace rilievo {
namespace {

// Decodes one file; a fault becomes an error that names it.
template <class Decode>
auto decoded(const std::filesystem::path& path, MemoryBudget& budget, Decode decode)
    -> Result<decltype(decode(Bytes{}, std::declval<MemoryBudget&>()))> {
  const Result<std::string> bytes = read_file(path, budget.left());
  if (!bytes) return bytes.error();
  try {
    budget.earn(bytes->size());
    return decode(bytes_of(*bytes), budget);
  } catch (const LoadError& fault) {
    return Error{path.string(), fault.reason};
  }
}

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

Camera camera_of(const RgbdFrame& frame, int width, int height) {
  const RgbdIntrinsics& lens = frame.intrinsics;
  const double fl_x =
      std::isnan(lens.fl_x) ? 0.5 * width / std::tan(0.5 * lens.angle_x) : lens.fl_x;
  const double fl_y = std::isnan(lens.fl_y) ? fl_x : lens.fl_y;
  const double cx = std::isnan(lens.cx) ? 0.5 * width : lens.cx;
  const double cy = std::isnan(lens.cy) ? 0.5 * height : lens.cy;
  Camera camera;
  camera.world_from_eye = frame.world_from_eye;
  camera.window = {-cx / fl_x, (width - cx) / fl_x, -(height - cy) / fl_y, cy / fl_y};
  camera.width = width;
  camera.height = height;
  return camera;
}

}  // namespace

Result<DepthImage> load_rgbd_frame(const RgbdFrame& frame, std::uint64_t max_bytes) {
  MemoryBudget budget(max_bytes);
  // What is decoded becomes floats: four of colour and one of depth.
  const Result<Rgba8Image> color =
      decoded(frame.color, budget, [](Bytes encoded, MemoryBudget& left) {
        Rgba8Image picture = decode_picture(encoded, left);
        left.take_pixels(picture.texels().size(), sizeof(glm::vec4) + sizeof(float));
        return picture;
      });
  if (!color) return color.error();
  const Result<Image<std::uint16_t>> units = decoded(frame.depth, budget, decode_grey16);
  if (!units) return units.error();
  const int width = color->width(), height = color->height();
  const RgbdIntrinsics& lens = frame.intrinsics;
  if ((lens.width && lens.width != width) || (lens.height && lens.height != height))
    return Error{frame.color.string(), "is " + size_text(width, height) +
                                           " texels, but the lens is given for " +
                                           size_text(lens.width, lens.height)};
  if (units->width() != width || units->height() != height)
    return Error{frame.depth.string(), "is " + size_text(units->width(), units->height()) +
                                           " texels, but its colours are " +
                                           size_text(width, height)};

  DepthImage picture;
  picture.name = frame.name;
  picture.camera = camera_of(frame, width, height);
  picture.color = linear_from_srgb8(*color);
  picture.depth = Image<float>(width, height, kNoDepth);
  float nearest = kNoDepth, farthest = 0;
  for (std::size_t i = 0; i < picture.depth.texels().size(); ++i) {
    const std::uint16_t unit = units->texels()[i];
    glm::vec4& texel = picture.color.texels()[i];
    texel = texel.a < 0.5f ? glm::vec4(0.0f) : glm::vec4(glm::vec3(texel), 1.0f);
    if (unit == 0 || unit == 65535 || texel.a == 0) continue;
    const float eye_z = float(unit * frame.metres_per_unit);
    picture.depth.texels()[i] = eye_z;
    nearest = std::min(nearest, eye_z);
    farthest = std::max(farthest, eye_z);
  }
  if (farthest == 0) return Error{frame.depth.string(), "holds no depth"};
  // Surfaces between samples may reach a little beyond them.
  picture.camera.z_near = 0.5 * nearest;
  picture.camera.z_far = 2.0 * farthest;
  if (Result<> valid = validate(picture); !valid)
    return Error{frame.color.string(), valid.error().message()};
  return picture;
}

}  // namespace rilievo
