// The messages of a live walk: what a client and a server tell each other.
//
// docs/protocol.md has every field with its offset, unit and limits; message.cpp lists them once,
// for writing and for reading. Numbers are little endian. Whatever arrives is checked: a message
// that breaks a rule becomes an error that names the field, and nothing of what it said. World
// space, metres, radians. No state, no sockets: any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"
#include "rilievo/serve/session.h"

namespace rilievo {

inline constexpr std::uint8_t kLiveProtocol = 1;
// The largest message of a client, bytes, and the most identifiers in one.
inline constexpr std::size_t kMostClientMessage = 4096, kMostLiveIds = 500;
// The most texels of a picture's side.
inline constexpr int kMostLiveSide = 8192;

// What a client can draw.
struct LiveHello {
  int width = 1, height = 1;       // of its frames, pixels
  int largest_texture = 4096;      // texels a side
  std::uint64_t memory = 1 << 28;  // for pictures, bytes
};

// Where a client's eye is, and how it moves.
struct LivePose {
  std::uint32_t sequence = 0;
  double client_ms = 0;  // the client's clock
  glm::dvec3 eye{0.0};
  glm::dquat orientation{1, 0, 0, 0};  // from the eye, which looks along -z, into the world
  double vertical_fov = 0.9, aspect = 1;
  glm::dvec3 velocity{0.0};   // a second
  glm::dvec3 turn_rate{0.0};  // a second, about this axis
  double latency_ms = 0;      // half of the round trip
  double cell = 0;            // the eye's distance from a keyframe's that it asks for; 0: any
};

// Pictures that a client holds from before it connected, and those that it has dropped.
struct LiveHave {
  std::vector<std::uint64_t> ids;
};
struct LiveDropped {
  std::vector<std::uint64_t> ids;
};

// Asks for a LivePong.
struct LivePing {
  double client_ms = 0;
};

using ClientMessage = std::variant<LiveHello, LivePose, LiveHave, LiveDropped, LivePing>;

// What is walked through, and where a walk begins.
struct LiveWelcome {
  std::string name;  // UTF-8, at most 255 bytes
  Box bounds;
  glm::dvec3 up{0, 1, 0}, eye{0.0}, target{0, 0, -1};
  double vertical_fov = 0.9, z_near = 0.1, z_far = 1000;
  double unit = 1;           // of lengths, metres
  bool without_sky = false;  // what no picture shows is black, not the library's sky
};

// The way in which a picture's colours are encoded.
enum class LiveColor : std::uint8_t { jpeg = 1, webp = 2 };

// What a picture is, without its bytes.
struct LivePictureHead {
  bool fine = false;  // else a fraction of the size
  int layer = 0;      // 1: what the first layer hides
  LiveColor color = LiveColor::jpeg;
  int surround_face = -1;                  // 0 to 5: of a cube around the eye; -1: a view
  std::uint64_t keyframe = 0, id = 0;      // all parts of a keyframe share the first
  std::array<std::uint8_t, 16> content{};  // a hash of the bytes
  glm::dvec3 eye{0.0};
  glm::dquat orientation{1, 0, 0, 0};
  ImageWindow window;
  int width = 1, height = 1;
  // Depths (rilievo/serve/depth_codes.h), and how far from its place an eye within the cell can see
  // a texel because they are rounded.
  float step = 1, offset = 0;
  double cell = 0, error_px = 0, z_near = 0.1;
  double server_ms = 0;        // the server's clock, when it was begun
  std::uint32_t sequence = 0;  // of the pose it answers
};

// A picture, whose bytes lie in the message.
struct LivePicture {
  LivePictureHead head;
  std::span<const std::byte> depths, colors;
};

// The answer to a LivePing.
struct LivePong {
  double client_ms = 0, server_ms = 0;
};

// The last message of a server.
struct LiveBye {
  LiveEnd reason = LiveEnd::server_ends;
};

using ServerMessage = std::variant<LiveWelcome, LivePicture, LivePong, LiveBye>;

// A message's bytes. Requires what docs/protocol.md demands of its fields.
[[nodiscard]] std::vector<std::byte> encode_message(const ClientMessage& message);
[[nodiscard]] std::vector<std::byte> encode_message(const ServerMessage& message);

// Reads a message. The error names the field that is wrong.
[[nodiscard]] Result<ClientMessage> parse_client_message(std::span<const std::byte> bytes);
// The same; a picture's bytes point into `bytes`.
[[nodiscard]] Result<ServerMessage> parse_server_message(std::span<const std::byte> bytes);

// The camera of a picture. Its far plane is that of the scene.
[[nodiscard]] Camera camera_of(const LivePictureHead& head, double z_far);
// The picture's fields that a camera determines.
void set_camera(const Camera& camera, LivePictureHead& head);
// The camera of a client's frames.
[[nodiscard]] Camera camera_of(const LivePose& pose, const LiveHello& hello, double z_near,
                               double z_far);

}  // namespace rilievo
