#include "rilievo/compare/reference_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <glm/glm.hpp>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/io/png.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

constexpr int kMostParts = 4;

// FNV-1a: names files that one user keeps, nothing more.
class NameHash {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) state_ = (state_ ^ std::uint8_t(c)) * 0x100000001b3u;
  }
  void add(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int i = 0; i < 8; ++i) state_ = (state_ ^ (bits >> (8 * i) & 255)) * 0x100000001b3u;
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

// One of so many parts of a frame in each direction, as large as the frame.
Camera part_of(const Camera& frame, int across, int down, int parts) {
  const int columns = (frame.width + parts - 1) / parts, rows = (frame.height + parts - 1) / parts;
  return supersampled(camera_of_part(frame, across * columns, down * rows, columns, rows), parts);
}

}  // namespace

void average_into(const Rgba8Image& part, int parts, int x0, int y0, Rgba8Image& frame) {
  const int count = parts * parts;
  const int columns = std::min(part.width() / parts, frame.width() - x0),
            rows = std::min(part.height() / parts, frame.height() - y0);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      glm::ivec4 sum(0);
      for (int j = 0; j < parts; ++j)
        for (int i = 0; i < parts; ++i) sum += glm::ivec4(part(x * parts + i, y * parts + j));
      frame(x0 + x, y0 + y) = glm::u8vec4((sum + count / 2) / count);
    }
}

bool can_reference(int samples, int source_samples) {
  for (int parts = 1; parts <= kMostParts; ++parts)
    if (samples == source_samples * parts * parts) return true;
  return false;
}

ReferenceFrames::ReferenceFrames(FrameSource& source, int source_samples, ReferenceOptions options)
    : source_(source), options_(std::move(options)) {
  RILIEVO_EXPECTS(can_reference(options_.samples, source_samples));
  RILIEVO_EXPECTS(source.software_target() != nullptr);
  while (source_samples * parts_ * parts_ < options_.samples) ++parts_;
}

std::filesystem::path ReferenceFrames::file_of(const WalkFrame& walk) const {
  NameHash hash;
  hash.add(options_.scene);
  const Camera& c = walk.camera;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) hash.add(c.world_from_eye[column][row]);
  for (const double value :
       {c.window.left, c.window.right, c.window.bottom, c.window.top, c.z_near, c.z_far, walk.time})
    hash.add(value);
  return options_.folder /
         fmt::format("{}x{}-{}-{:016x}.png", c.width, c.height, options_.samples, hash.value());
}

Result<Rgba8Image> ReferenceFrames::draw(const WalkFrame& walk) {
  ++drawn_;
  Rgba8Image frame(walk.camera.width, walk.camera.height);
  for (int down = 0; down < parts_; ++down)
    for (int across = 0; across < parts_; ++across) {
      const Camera camera = part_of(walk.camera, across, down, parts_);
      if (Result<> drawn = source_.draw(camera, walk.time); !drawn) return drawn.error();
      average_into(source_.software_target()->color(), parts_, across * (camera.width / parts_),
                   down * (camera.height / parts_), frame);
    }
  return {std::move(frame)};
}

Result<Rgba8Image> ReferenceFrames::frame(const WalkFrame& walk) {
  RILIEVO_EXPECTS(walk.camera.projection == Projection::perspective);
  if (options_.folder.empty()) return draw(walk);
  const std::filesystem::path file = file_of(walk);
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored)) {
    Result<Rgba8Image> kept = load_png(file);
    // One that is damaged is made again.
    if (kept && kept->width() == walk.camera.width && kept->height() == walk.camera.height)
      return kept;
  }
  Result<Rgba8Image> made = draw(walk);
  if (!made) return made;
  std::filesystem::create_directories(options_.folder, ignored);
  if (Result<> saved = save_png(file, *made); !saved) return saved.error();
  return made;
}

}  // namespace rilievo
