// What readers and writers of OpenEXR files share: files in memory, attributes, cameras, claims.
//
// Internal to `io`. Errors carry no path: whoever opened the file adds it.
#pragma once

#include <ImfHeader.h>
#include <ImfIO.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth.h"

namespace rilievo::exr {

// From here on a foreign depth is "nothing there": renderers write 1e10, 1e30, 1e32, 1e38.
inline constexpr float kForeignFar = 1e10f;
// The largest finite half.
inline constexpr float kHalfMax = 65504.0f;
// Of a file that is read.
inline constexpr std::uint64_t kMaxBytes = std::uint64_t(1) << 34;

// For OpenEXR to read from. Throws where the file ends too early.
class MemoryStream : public Imf::IStream {
 public:
  explicit MemoryStream(std::string_view bytes) : Imf::IStream("memory"), bytes_(bytes) {}
  bool read(char out[], int count) override;
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override;

 private:
  std::string_view bytes_;
  std::size_t position_ = 0;
};

// For OpenEXR to write to. (On a full disk its own streams stay silent: it writes its tables of
// offsets in destructors, which swallow exceptions.)
class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : Imf::OStream("memory") {}
  void write(const char bytes[], int count) override;
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t position_ = 0;
};

[[nodiscard]] inline Error because(const std::string& reason) { return Error{"", reason}; }

// OpenEXR's messages may have several lines, and name our stream, which has no name to speak of.
[[nodiscard]] std::string one_line(std::string text);

template <class Value>
std::optional<Value> attribute(const Imf::Header& header, const char* name) {
  const auto* found = header.findTypedAttribute<Imf::TypedAttribute<Value>>(name);
  if (!found) return std::nullopt;
  return found->value();
}

template <std::size_t n>
std::optional<std::size_t> index_of(const std::array<const char*, n>& names,
                                    const std::optional<std::string>& wanted) {
  for (std::size_t i = 0; wanted && i < n; ++i)
    if (*wanted == names[i]) return i;
  return std::nullopt;
}

struct Size {
  std::int64_t width, height;
};
[[nodiscard]] Size size_of(const Imath::Box2i& box);

// Can a file of `file_bytes` hold this part?
[[nodiscard]] Result<> check_claims(const Imf::Header& header, double file_bytes);

// A colour of a foreign file: renderers write what is not finite where a path went wrong. NaN
// becomes 0, and an infinity the largest half of its sign, as when a picture is saved.
[[nodiscard]] glm::vec4 finite_color(glm::vec4 color);

// All that a file says of a camera: our own attributes, and the standard matrices of `display`, the
// camera of the display window.
void insert_camera(Imf::Header& header, const Camera& camera, const Camera& display,
                   DepthKind depth_kind, const std::string& name);

// Our own camera, exactly as it was saved.
[[nodiscard]] Result<Camera> own_camera(const Imf::Header& header);

// `display`, the camera of the display window, cut to the part of it that has texels.
[[nodiscard]] Result<Camera> cropped_camera(const Imf::Header& header, Camera display);

// The camera of the standard matrices, cropped.
[[nodiscard]] Result<Camera> standard_camera(const Imf::Header& header);

}  // namespace rilievo::exr
