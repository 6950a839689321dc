#include "rilievo/capture/store/picture_bytes.h"

#include <array>
#include <bit>
#include <cstring>

namespace rilievo {
namespace {

static_assert(std::endian::native == std::endian::little);

using Head = std::array<std::uint32_t, 8>;
using CameraNumbers = std::array<double, 22>;

constexpr std::uint32_t kMagic = 0x50564C52, kBytesVersion = 1;
constexpr std::uint32_t kMaxSide = 1 << 16;

template <class T>
void append_raw(std::vector<std::byte>& out, const T* values, std::size_t count) {
  if (count == 0) return;
  const std::size_t at = out.size();
  out.resize(at + count * sizeof(T));
  std::memcpy(out.data() + at, values, count * sizeof(T));
}

// Takes values from the front; false where there are too few.
template <class T>
bool take_raw(std::span<const std::byte>& from, T* values, std::size_t count) {
  if (from.size() / sizeof(T) < count) return false;
  if (count) std::memcpy(values, from.data(), count * sizeof(T));
  from = from.subspan(count * sizeof(T));
  return true;
}

}  // namespace

std::vector<std::byte> picture_bytes(const DepthImage& picture) {
  const Camera& c = picture.camera;
  const Head head = {kMagic,
                     kBytesVersion,
                     std::uint32_t(c.width),
                     std::uint32_t(c.height),
                     std::uint32_t(c.projection),
                     std::uint32_t(picture.depth_kind),
                     picture.object.empty() ? 0u : 1u,
                     std::uint32_t(picture.name.size())};
  CameraNumbers numbers{};
  std::memcpy(numbers.data(), &c.world_from_eye[0][0], 16 * sizeof(double));
  const double rest[] = {c.window.left, c.window.right, c.window.bottom,
                         c.window.top,  c.z_near,       c.z_far};
  std::memcpy(numbers.data() + 16, rest, sizeof rest);
  std::vector<std::byte> out;
  append_raw(out, head.data(), head.size());
  append_raw(out, numbers.data(), numbers.size());
  append_raw(out, picture.name.data(), picture.name.size());
  append_raw(out, picture.color.texels().data(), picture.color.texels().size());
  append_raw(out, picture.depth.texels().data(), picture.depth.texels().size());
  append_raw(out, picture.object.texels().data(), picture.object.texels().size());
  return out;
}

std::optional<DepthImage> picture_from_bytes(std::span<const std::byte> bytes) {
  Head head;
  CameraNumbers numbers;
  if (!take_raw(bytes, head.data(), head.size()) || head[0] != kMagic || head[1] != kBytesVersion ||
      head[2] < 1 || head[2] > kMaxSide || head[3] < 1 || head[3] > kMaxSide || head[4] > 2 ||
      head[5] > 2 || head[6] > 1 || head[7] > bytes.size() ||
      !take_raw(bytes, numbers.data(), numbers.size()))
    return std::nullopt;
  const std::uint64_t texels = std::uint64_t(head[2]) * head[3];
  if (bytes.size() != head[7] + texels * (head[6] ? 24 : 20)) return std::nullopt;
  DepthImage picture;
  Camera& c = picture.camera;
  c.width = int(head[2]), c.height = int(head[3]);
  c.projection = Projection(head[4]);
  picture.depth_kind = DepthKind(head[5]);
  std::memcpy(&c.world_from_eye[0][0], numbers.data(), 16 * sizeof(double));
  c.window = {numbers[16], numbers[17], numbers[18], numbers[19]};
  c.z_near = numbers[20], c.z_far = numbers[21];
  picture.name.resize(head[7]);
  picture.color = ColorImage(c.width, c.height);
  picture.depth = Image<float>(c.width, c.height);
  if (head[6]) picture.object = Image<std::uint32_t>(c.width, c.height);
  if (!take_raw(bytes, picture.name.data(), picture.name.size()) ||
      !take_raw(bytes, picture.color.texels().data(), picture.color.texels().size()) ||
      !take_raw(bytes, picture.depth.texels().data(), picture.depth.texels().size()) ||
      !take_raw(bytes, picture.object.texels().data(), picture.object.texels().size()) ||
      !validate(picture))
    return std::nullopt;
  return picture;
}

}  // namespace rilievo
