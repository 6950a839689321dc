#include "rilievo/serve/message.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Kinds of the client have numbers below 64.
enum MessageKind : std::uint8_t {
  kHello = 1,
  kPose,
  kHave,
  kDropped,
  kPing,
  kWelcome = 65,
  kPicture,
  kPong,
  kBye
};

// Bytes of a message without what follows its fields.
constexpr std::size_t kHeadBytes = 4, kHelloBytes = 24, kPoseBytes = 104, kIdsBytes = 8,
                      kPingBytes = 16, kWelcomeBytes = 152, kPictureBytes = 160, kPongBytes = 24,
                      kByeBytes = 8;
constexpr std::size_t kMostName = 255;

// Limits of lengths, coordinates and times.
constexpr double kFarthest = 1e12, kLongestMs = 1e15;
// Quaternions are unit, within what single precision and a client's own arithmetic leave.
constexpr double kQuaternionSlack = 0.01;

// Unsigned integers as bytes, the lowest first, whatever the machine's order is.
template <class U>
void put(std::byte* to, U value) {
  for (std::size_t i = 0; i < sizeof(U); ++i) to[i] = std::byte(std::uint8_t(value >> (8 * i)));
}
template <class U>
U get(const std::byte* from) {
  U value = 0;
  for (std::size_t i = 0; i < sizeof(U); ++i)
    value = U(value | U(U(std::to_integer<std::uint8_t>(from[i])) << (8 * i)));
  return value;
}

// Writes the fields at their offsets. Limits are the reader's business.
class Writer {
 public:
  Writer(MessageKind kind, std::size_t size) : bytes_(size) {
    bytes_[0] = std::byte(kind), bytes_[1] = std::byte(kLiveProtocol);
  }
  template <class U, class T>
  void whole(std::size_t at, T& value, double, double, const char*) {
    put(&bytes_[at], U(value));
  }
  template <class T>
  void real32(std::size_t at, T& value, double, double, const char*) {
    put(&bytes_[at], std::bit_cast<std::uint32_t>(float(value)));
  }
  void real64(std::size_t at, double& value, double, double, const char*) {
    put(&bytes_[at], std::bit_cast<std::uint64_t>(value));
  }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }
  void append(std::span<const std::byte> more) {
    bytes_.insert(bytes_.end(), more.begin(), more.end());
  }

 private:
  std::vector<std::byte> bytes_;
};

// Reads them, and keeps the name of the first that is out of its limits.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class U, class T>
  void whole(std::size_t at, T& value, double least, double most, const char* name) {
    const U read = get<U>(&bytes_[at]);
    check(double(read), least, most, name);
    if (!wrong_) value = T(read);
  }
  template <class T>
  void real32(std::size_t at, T& value, double least, double most, const char* name) {
    const float read = std::bit_cast<float>(get<std::uint32_t>(&bytes_[at]));
    check(double(read), least, most, name);
    if (!wrong_) value = T(read);
  }
  void real64(std::size_t at, double& value, double least, double most, const char* name) {
    const double read = std::bit_cast<double>(get<std::uint64_t>(&bytes_[at]));
    check(read, least, most, name);
    if (!wrong_) value = read;
  }
  void refuse(const char* name) {
    if (!wrong_) wrong_ = name;
  }
  [[nodiscard]] const char* wrong() const { return wrong_; }

 private:
  // Written so that a NaN is out of any limits.
  void check(double value, double least, double most, const char* name) {
    if (!(value >= least && value <= most)) refuse(name);
  }

  std::span<const std::byte> bytes_;
  const char* wrong_ = nullptr;
};

template <class IO>
void vector64(IO& io, std::size_t at, glm::dvec3& v, const char* name) {
  for (int c = 0; c < 3; ++c) io.real64(at + 8 * std::size_t(c), v[c], -kFarthest, kFarthest, name);
}
template <class IO>
void vector32(IO& io, std::size_t at, glm::dvec3& v, double most, const char* name) {
  for (int c = 0; c < 3; ++c) io.real32(at + 4 * std::size_t(c), v[c], -most, most, name);
}
template <class IO>
void turn(IO& io, std::size_t at, glm::dquat& q) {
  double* const parts[] = {&q.x, &q.y, &q.z, &q.w};
  for (std::size_t i = 0; i < 4; ++i) io.real32(at + 4 * i, *parts[i], -1.01, 1.01, "orientation");
  if constexpr (std::is_same_v<IO, Reader>) {
    const double length = glm::length(q);
    if (!(std::abs(length - 1) <= kQuaternionSlack)) return io.refuse("orientation");
    q = q / length;
  }
}

// The fields of each message, for writing and for reading.

template <class IO>
void fields(IO& io, LiveHello& hello) {
  io.template whole<std::uint32_t>(4, hello.width, 1, 16384, "viewport's width");
  io.template whole<std::uint32_t>(8, hello.height, 1, 16384, "viewport's height");
  io.template whole<std::uint32_t>(12, hello.largest_texture, 64, 1 << 20, "largest texture");
  io.template whole<std::uint64_t>(16, hello.memory, 0, 1e18, "memory");
}

template <class IO>
void fields(IO& io, LivePose& pose) {
  io.template whole<std::uint32_t>(4, pose.sequence, 0, 4294967295.0, "sequence number");
  io.real64(8, pose.client_ms, -kLongestMs, kLongestMs, "client's time");
  vector64(io, 16, pose.eye, "eye");
  turn(io, 40, pose.orientation);
  io.real32(56, pose.vertical_fov, 0.01, 3.0, "vertical field of view");
  io.real32(60, pose.aspect, 0.05, 20, "aspect ratio");
  vector32(io, 64, pose.velocity, 1e9, "velocity");
  vector32(io, 76, pose.turn_rate, 1000, "turn rate");
  io.real32(88, pose.latency_ms, 0, 60000, "latency");
  io.real32(92, pose.cell, 0, 1e9, "cell radius");
}

template <class IO>
void fields(IO& io, LivePing& ping) {
  io.real64(8, ping.client_ms, -kLongestMs, kLongestMs, "client's time");
}

template <class IO>
void fields(IO& io, LivePong& pong) {
  io.real64(8, pong.client_ms, -kLongestMs, kLongestMs, "client's time");
  io.real64(16, pong.server_ms, -kLongestMs, kLongestMs, "server's time");
}

template <class IO>
void fields(IO& io, LiveBye& bye) {
  // Numbered from 1.
  int number = int(bye.reason) + 1;
  io.template whole<std::uint16_t>(4, number, 1, 4, "reason");
  bye.reason = LiveEnd(number - 1);
}

template <class IO>
void fields(IO& io, LiveWelcome& welcome, std::uint16_t& name_bytes) {
  io.template whole<std::uint16_t>(4, name_bytes, 0, double(kMostName), "name's length");
  glm::dvec3 low = welcome.bounds.min, high = welcome.bounds.max;
  vector64(io, 8, low, "bounds");
  vector64(io, 32, high, "bounds");
  welcome.bounds.min = glm::vec3(low), welcome.bounds.max = glm::vec3(high);
  vector64(io, 56, welcome.up, "up");
  vector64(io, 80, welcome.eye, "eye");
  vector64(io, 104, welcome.target, "target");
  io.real32(128, welcome.vertical_fov, 0.01, 3.0, "vertical field of view");
  io.real32(132, welcome.z_near, 1e-9, 1e9, "near");
  io.real32(136, welcome.z_far, 1e-9, kFarthest, "far");
  io.real32(140, welcome.unit, 1e-9, 1e9, "unit");
  io.template whole<std::uint32_t>(144, welcome.without_sky, 0, 1, "sky");
}

template <class IO>
void fields(IO& io, LivePictureHead& head, std::uint32_t& depth_bytes, std::uint32_t& color_bytes) {
  std::uint8_t around = head.surround_face >= 0;
  std::uint8_t face = std::uint8_t(std::max(head.surround_face, 0));
  io.template whole<std::uint8_t>(4, head.fine, 0, 1, "level");
  io.template whole<std::uint8_t>(5, head.layer, 0, 1, "layer");
  io.template whole<std::uint8_t>(6, head.color, 1, 2, "kind of colours");
  io.template whole<std::uint8_t>(7, around, 0, 1, "role");
  io.template whole<std::uint64_t>(8, head.keyframe, 0, 1.9e19, "keyframe");
  io.template whole<std::uint64_t>(16, head.id, 0, 1.9e19, "identifier");
  for (std::size_t i = 0; i < 16; ++i)
    io.template whole<std::uint8_t>(24 + i, head.content[i], 0, 255, "content hash");
  vector64(io, 40, head.eye, "eye");
  turn(io, 64, head.orientation);
  io.real32(80, head.window.left, -1e6, 1e6, "window");
  io.real32(84, head.window.right, -1e6, 1e6, "window");
  io.real32(88, head.window.bottom, -1e6, 1e6, "window");
  io.real32(92, head.window.top, -1e6, 1e6, "window");
  io.template whole<std::uint16_t>(96, head.width, 1, kMostLiveSide, "width");
  io.template whole<std::uint16_t>(98, head.height, 1, kMostLiveSide, "height");
  io.real32(100, head.step, 1e-30, 1e9, "step");
  io.real32(104, head.offset, -0.999, 1e9, "offset");
  io.real32(108, head.cell, 0, 1e9, "cell radius");
  io.real32(112, head.error_px, 0, 1e6, "error");
  io.real32(116, head.z_near, 1e-9, 1e9, "near");
  io.real64(120, head.server_ms, -kLongestMs, kLongestMs, "server's time");
  io.template whole<std::uint32_t>(128, head.sequence, 0, 4294967295.0, "sequence number");
  io.template whole<std::uint32_t>(132, depth_bytes, 0, 4294967295.0, "depth bytes");
  io.template whole<std::uint32_t>(136, color_bytes, 0, 4294967295.0, "colour bytes");
  io.template whole<std::uint8_t>(140, face, 0, 5, "face");
  if constexpr (std::is_same_v<IO, Reader>) {
    head.surround_face = around ? int(face) : -1;
    if (!(head.window.left < head.window.right && head.window.bottom < head.window.top))
      io.refuse("window");
  }
}

Error wrong_message(const char* what) { return Error{"message", std::string(what) + " is wrong"}; }

template <class Message, class M>
Result<M> read_fixed(std::span<const std::byte> bytes, std::size_t size) {
  if (bytes.size() != size) return wrong_message("size");
  Message message;
  Reader reader(bytes);
  fields(reader, message);
  if (reader.wrong()) return wrong_message(reader.wrong());
  return M{std::move(message)};
}

template <class Message>
Result<ClientMessage> read_ids(std::span<const std::byte> bytes) {
  if (bytes.size() < kIdsBytes) return wrong_message("size");
  const std::uint32_t count = get<std::uint32_t>(&bytes[4]);
  if (count > kMostLiveIds || bytes.size() != kIdsBytes + 8 * std::size_t(count))
    return wrong_message("count");
  Message message;
  for (std::size_t i = 0; i < count; ++i)
    message.ids.push_back(get<std::uint64_t>(&bytes[kIdsBytes + 8 * i]));
  return ClientMessage{std::move(message)};
}

std::vector<std::byte> write_ids(MessageKind kind, std::span<const std::uint64_t> ids) {
  RILIEVO_EXPECTS(ids.size() <= kMostLiveIds);
  std::vector<std::byte> bytes(kIdsBytes + 8 * ids.size());
  bytes[0] = std::byte(kind), bytes[1] = std::byte(kLiveProtocol);
  put(&bytes[4], std::uint32_t(ids.size()));
  for (std::size_t i = 0; i < ids.size(); ++i) put(&bytes[kIdsBytes + 8 * i], ids[i]);
  return bytes;
}

template <class Message>
std::vector<std::byte> write_fixed(MessageKind kind, std::size_t size, Message message) {
  Writer writer(kind, size);
  fields(writer, message);
  return writer.take();
}

Result<ServerMessage> read_welcome(std::span<const std::byte> bytes) {
  if (bytes.size() < kWelcomeBytes) return wrong_message("size");
  LiveWelcome welcome;
  std::uint16_t name_bytes = 0;
  Reader reader(bytes);
  fields(reader, welcome, name_bytes);
  if (reader.wrong()) return wrong_message(reader.wrong());
  if (bytes.size() != kWelcomeBytes + name_bytes) return wrong_message("name's length");
  for (const std::byte b : bytes.subspan(kWelcomeBytes))
    welcome.name.push_back(char(std::to_integer<unsigned char>(b)));
  return ServerMessage{std::move(welcome)};
}

std::vector<std::byte> write_welcome(LiveWelcome welcome) {
  RILIEVO_EXPECTS(welcome.name.size() <= kMostName);
  std::uint16_t name_bytes = std::uint16_t(welcome.name.size());
  Writer writer(kWelcome, kWelcomeBytes);
  fields(writer, welcome, name_bytes);
  writer.append(std::as_bytes(std::span(welcome.name)));
  return writer.take();
}

Result<ServerMessage> read_picture(std::span<const std::byte> bytes) {
  if (bytes.size() < kPictureBytes) return wrong_message("size");
  LivePicture picture;
  std::uint32_t depth_bytes = 0, color_bytes = 0;
  Reader reader(bytes);
  fields(reader, picture.head, depth_bytes, color_bytes);
  if (reader.wrong()) return wrong_message(reader.wrong());
  if (bytes.size() != kPictureBytes + std::uint64_t(depth_bytes) + color_bytes)
    return wrong_message("number of bytes");
  picture.depths = bytes.subspan(kPictureBytes, depth_bytes);
  picture.colors = bytes.subspan(kPictureBytes + depth_bytes, color_bytes);
  return ServerMessage{picture};
}

std::vector<std::byte> write_picture(LivePicture picture) {
  std::uint32_t depth_bytes = std::uint32_t(picture.depths.size()),
                color_bytes = std::uint32_t(picture.colors.size());
  Writer writer(kPicture, kPictureBytes);
  fields(writer, picture.head, depth_bytes, color_bytes);
  writer.append(picture.depths);
  writer.append(picture.colors);
  return writer.take();
}

// The kind of a message, or 0 and why there is none.
std::uint8_t kind_of(std::span<const std::byte> bytes, const char*& wrong) {
  wrong = bytes.size() < kHeadBytes                            ? "size"
          : bytes[1] != std::byte(kLiveProtocol)               ? "version"
          : bytes[2] != std::byte{} || bytes[3] != std::byte{} ? "reserved bytes"
                                                               : nullptr;
  return wrong ? std::uint8_t(0) : std::to_integer<std::uint8_t>(bytes[0]);
}

}  // namespace

std::vector<std::byte> encode_message(const ClientMessage& message) {
  if (const auto* hello = std::get_if<LiveHello>(&message))
    return write_fixed(kHello, kHelloBytes, *hello);
  if (const auto* pose = std::get_if<LivePose>(&message))
    return write_fixed(kPose, kPoseBytes, *pose);
  if (const auto* have = std::get_if<LiveHave>(&message)) return write_ids(kHave, have->ids);
  if (const auto* dropped = std::get_if<LiveDropped>(&message))
    return write_ids(kDropped, dropped->ids);
  return write_fixed(kPing, kPingBytes, std::get<LivePing>(message));
}

std::vector<std::byte> encode_message(const ServerMessage& message) {
  if (const auto* welcome = std::get_if<LiveWelcome>(&message)) return write_welcome(*welcome);
  if (const auto* picture = std::get_if<LivePicture>(&message)) return write_picture(*picture);
  if (const auto* pong = std::get_if<LivePong>(&message))
    return write_fixed(kPong, kPongBytes, *pong);
  return write_fixed(kBye, kByeBytes, std::get<LiveBye>(message));
}

Result<ClientMessage> parse_client_message(std::span<const std::byte> bytes) {
  if (bytes.size() > kMostClientMessage) return wrong_message("size");
  const char* wrong = nullptr;
  switch (kind_of(bytes, wrong)) {
    case kHello:
      return read_fixed<LiveHello, ClientMessage>(bytes, kHelloBytes);
    case kPose:
      return read_fixed<LivePose, ClientMessage>(bytes, kPoseBytes);
    case kHave:
      return read_ids<LiveHave>(bytes);
    case kDropped:
      return read_ids<LiveDropped>(bytes);
    case kPing:
      return read_fixed<LivePing, ClientMessage>(bytes, kPingBytes);
    default:
      return wrong_message(wrong ? wrong : "kind");
  }
}

Result<ServerMessage> parse_server_message(std::span<const std::byte> bytes) {
  const char* wrong = nullptr;
  switch (kind_of(bytes, wrong)) {
    case kWelcome:
      return read_welcome(bytes);
    case kPicture:
      return read_picture(bytes);
    case kPong:
      return read_fixed<LivePong, ServerMessage>(bytes, kPongBytes);
    case kBye:
      return read_fixed<LiveBye, ServerMessage>(bytes, kByeBytes);
    default:
      return wrong_message(wrong ? wrong : "kind");
  }
}

Camera camera_of(const LivePictureHead& head, double z_far) {
  Camera camera;
  camera.world_from_eye = glm::mat4_cast(head.orientation);
  camera.world_from_eye[3] = glm::dvec4(head.eye, 1);
  camera.window = head.window;
  camera.width = head.width, camera.height = head.height;
  camera.z_near = head.z_near, camera.z_far = std::max(z_far, 2 * head.z_near);
  return camera;
}

void set_camera(const Camera& camera, LivePictureHead& head) {
  head.eye = camera.position();
  head.orientation = glm::normalize(glm::quat_cast(glm::dmat3(camera.world_from_eye)));
  head.window = camera.window;
  head.width = camera.width, head.height = camera.height;
  head.z_near = camera.z_near;
}

Camera camera_of(const LivePose& pose, const LiveHello& hello, double z_near, double z_far) {
  Camera camera;
  camera.world_from_eye = glm::mat4_cast(pose.orientation);
  camera.world_from_eye[3] = glm::dvec4(pose.eye, 1);
  const double top = std::tan(0.5 * pose.vertical_fov), right = top * pose.aspect;
  camera.window = {-right, right, -top, top};
  camera.width = hello.width, camera.height = hello.height;
  camera.z_near = z_near, camera.z_far = z_far;
  return camera;
}

}  // namespace rilievo
