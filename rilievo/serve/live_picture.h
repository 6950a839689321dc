// Pictures of a live walk: made by a source, as bytes for clients, and back as keyframes.
//
// A picture is captured by exactly the camera that its message holds, whose numbers are rounded to
// what the message has room for. The source is used by one thread at a time; it and the encoders
// use all cores.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/keyframes/keyframe.h"
#include "rilievo/serve/depth_codes.h"
#include "rilievo/serve/message.h"

namespace rilievo {

struct Sky;

// What to make.
struct LivePictureOrder {
  Camera camera;           // perspective
  FrameScale frame;        // of the frames that are warped from it
  bool fine = false;       // with 4 samples a texel, else 1
  int surround_face = -1;  // as LivePictureHead's
  double cell = 1;         // the eye's distance for which depths are exact to `error_px`
  double error_px = 0.25;
  int quality = 85;          // of JPEG, 1 to 100
  const Sky* sky = nullptr;  // as KeyframeRequest's
  double time = 0;           // of the scene, seconds
  const CaptureControl* control = nullptr;
};

// A picture as bytes, and what a server wants to know of it.
struct MadePicture {
  LivePictureHead head;  // without identifiers, times and numbers of poses
  std::vector<std::uint8_t> depths, colors;
  Camera camera;
  // 1 / eye_z that is exceeded by a fifth of what it shows but the sky; 0: only sky.
  double typical_inverse_z = 0;
  Image<std::uint32_t> objects;  // of its texels

  [[nodiscard]] std::size_t bytes() const { return depths.size() + colors.size(); }
};

// Makes a picture. Fails where the source does.
[[nodiscard]] Result<MadePicture> make_live_picture(CaptureSource& source,
                                                    const LivePictureOrder& order);

// The message of a picture.
[[nodiscard]] std::vector<std::byte> encode_picture(const MadePicture& picture,
                                                    const LivePictureHead& head);

// The keyframe that a message holds, with no objects. Fails for damaged bytes.
[[nodiscard]] Result<Keyframe> decode_live_picture(const LivePicture& picture, double z_far);

}  // namespace rilievo
