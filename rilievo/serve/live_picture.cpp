#include "rilievo/serve/live_picture.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "rilievo/core/parallel_for.h"
#include "rilievo/io/jpeg.h"
#include "rilievo/io/picture_decode.h"
#include "rilievo/keyframes/make_keyframe.h"
#include "rilievo/web_walk/plane16.h"
#include "rilievo/web_walk/sha256.h"

namespace rilievo {
namespace {

// The share of texels that are nearer than what is typical.
constexpr double kNearer = 0.2;
// Of which one in so many is looked at.
constexpr std::size_t kEvery = 31;

double typical_of(const Image<float>& inverse_z) {
  std::vector<float> some;
  const std::span<const float> all = inverse_z.texels();
  for (std::size_t i = 0; i < all.size(); i += kEvery)
    if (all[i] > 0) some.push_back(all[i]);
  if (some.empty()) return 0;
  const auto at = some.begin() + std::ptrdiff_t(kNearer * double(some.size()));
  std::nth_element(some.begin(), at, some.end(), std::greater<>());
  return double(*at);
}

// A picture's head with a camera as a client will know it.
LivePictureHead rounded_head(const Camera& camera) {
  LivePictureHead head;
  set_camera(camera, head);
  const std::vector<std::byte> bytes = encode_message(ServerMessage(LivePicture{head, {}, {}}));
  const Result<ServerMessage> read = parse_server_message(bytes);
  return read ? std::get<LivePicture>(*read).head : head;
}

}  // namespace

Result<MadePicture> make_live_picture(CaptureSource& source, const LivePictureOrder& order) {
  MadePicture made;
  made.head = rounded_head(order.camera);
  made.camera = camera_of(made.head, order.camera.z_far);
  KeyframeRequest request;
  request.camera = made.camera;
  request.samples = order.fine ? 4 : 1;
  request.whole_texels = true;
  request.coarse = !order.fine;
  request.sky = order.sky;
  request.time = order.time;
  Result<Keyframe> keyframe = make_keyframe(source, request, order.control);
  if (!keyframe) return keyframe.error();
  made.head.fine = order.fine, made.head.surround_face = order.surround_face;
  const DepthStep step =
      choose_depth_step(nearest_of(keyframe->inverse_z), order.cell, order.error_px, order.frame);
  made.head.step = step.step, made.head.offset = kDepthOffset;
  made.head.cell = step.cell, made.head.error_px = step.error_px;
  made.typical_inverse_z = typical_of(keyframe->inverse_z);
  // Two files at a time.
  parallel_for(0, 2, [&](int file) {
    if (file == 0)
      made.colors = encode_jpeg(opaque_colors(keyframe->color), order.quality);
    else
      made.depths = encode_plane16_quickly(depth_codes(keyframe->inverse_z, step.step));
  });
  std::vector<std::uint8_t> both = made.depths;
  both.insert(both.end(), made.colors.begin(), made.colors.end());
  const auto digest = sha256(both);
  std::copy_n(digest.begin(), made.head.content.size(), made.head.content.begin());
  made.objects = std::move(keyframe->object);
  return {std::move(made)};
}

std::vector<std::byte> encode_picture(const MadePicture& picture, const LivePictureHead& head) {
  return encode_message(ServerMessage(LivePicture{head, std::as_bytes(std::span(picture.depths)),
                                                  std::as_bytes(std::span(picture.colors))}));
}

Result<Keyframe> decode_live_picture(const LivePicture& picture, double z_far) {
  const LivePictureHead& head = picture.head;
  const auto bytes_of_part = [](std::span<const std::byte> part) {
    return Bytes(reinterpret_cast<const std::uint8_t*>(part.data()), part.size());
  };
  const Result<Image<std::uint16_t>> codes =
      decode_plane16(bytes_of_part(picture.depths), head.width, head.height);
  if (!codes) return codes.error();
  Rgba8Image colors;
  try {
    MemoryBudget budget(std::uint64_t(1) << 30);
    budget.earn(picture.colors.size());
    colors = decode_picture(bytes_of_part(picture.colors), budget);
  } catch (const LoadError& fault) {
    return Error{"picture", fault.reason};
  }
  if (colors.width() != head.width || colors.height() != head.height)
    return Error{"picture", "colours and depths differ in size"};
  Keyframe keyframe;
  resize(keyframe, camera_of(head, z_far));
  keyframe.coarse = !head.fine;
  for (std::size_t i = 0; i < colors.texels().size(); ++i) {
    const glm::u8vec4& c = colors.texels()[i];
    keyframe.color.texels()[i] =
        std::uint32_t(c.r) | std::uint32_t(c.g) << 8 | std::uint32_t(c.b) << 16 | kWholeTexel;
    keyframe.inverse_z.texels()[i] = inverse_z_of(codes->texels()[i], head.step, head.offset);
    keyframe.object.texels()[i] = kNoObject;
  }
  find_ranges(keyframe, 0, head.width);
  return {std::move(keyframe)};
}

}  // namespace rilievo
