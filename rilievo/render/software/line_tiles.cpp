#include "rilievo/render/software/line_tiles.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

constexpr std::uint32_t kOutlineColor = 0xff1ad9ffu;  // as outline_shader.cpp has it
constexpr double kHalfWidth = 0.5;                    // pixels

}  // namespace

void LineTiles::begin(const Camera& camera) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  camera_ = camera;
  eye_from_world_ = eye_from_world(camera);
  lines_.clear();
}

void LineTiles::add(const glm::dvec3& from, const glm::dvec3& to) {
  glm::dvec3 ends[] = {glm::dvec3(eye_from_world_ * glm::dvec4(from, 1)),
                       glm::dvec3(eye_from_world_ * glm::dvec4(to, 1))};
  const double z_near = camera_.z_near;
  if (-ends[0].z < z_near && -ends[1].z < z_near) return;
  for (int k = 0; k < 2; ++k)
    if (-ends[k].z < z_near) {
      const double share = (z_near + ends[k].z) / (ends[k].z - ends[1 - k].z);
      ends[k] += share * (ends[1 - k] - ends[k]);
    }
  const ImageWindow& w = camera_.window;
  const auto raster = [&](const glm::dvec3& p) {
    return glm::dvec2((p.x / -p.z - w.left) / (w.right - w.left) * camera_.width,
                      (w.top - p.y / -p.z) / (w.top - w.bottom) * camera_.height);
  };
  const glm::dvec2 a = raster(ends[0]), b = raster(ends[1]);
  Line line;
  line.length = glm::length(b - a);
  if (!(line.length > 0)) return;
  line.from = a, line.along = (b - a) / line.length;
  line.inverse_z = -1 / ends[0].z;
  line.per_px = (-1 / ends[1].z - line.inverse_z) / line.length;
  line.low = glm::min(a, b) - 1.0, line.high = glm::max(a, b) + 1.0;
  const glm::dvec2 size(camera_.width, camera_.height);
  if (line.low.x >= size.x || line.low.y >= size.y || line.high.x <= 0 || line.high.y <= 0) return;
  lines_.push_back(line);
}

void LineTiles::add_loop(std::span<const glm::dvec3> corners) {
  for (std::size_t i = 0; i < corners.size(); ++i)
    add(corners[i], corners[(i + 1) % corners.size()]);
}

void LineTiles::add_box(const glm::dvec3& low, const glm::dvec3& high,
                        const glm::dmat4& world_from_box) {
  const auto corner = [&](int c) {
    const glm::dvec3 at(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z);
    return glm::dvec3(world_from_box * glm::dvec4(at, 1));
  };
  for (int c = 0; c < 8; ++c)
    for (int axis = 1; axis < 8; axis *= 2)
      if (!(c & axis)) add(corner(c), corner(c | axis));
}

// Which samples of the pixel whose upper left corner is (x, y) does the line cover? Bit s: sample
// s.
unsigned LineTiles::covered(const Line& line, double x, double y, int samples) const {
  unsigned mask = 0;
  if (samples == 1) {
    const glm::dvec2 to = glm::dvec2(x + 0.5, y + 0.5) - line.from;
    const int major = std::abs(line.along.x) >= std::abs(line.along.y) ? 0 : 1;
    const double share = to[major] / line.along[major];
    const double off = to[1 - major] - share * line.along[1 - major];
    return share >= 0 && share < line.length && off >= -kHalfWidth && off < kHalfWidth;
  }
  for (int s = 0; s < samples; ++s) {
    const glm::dvec2 to =
        glm::dvec2(x + double(FrameTile::kSampleX[s]), y + double(FrameTile::kSampleY[s])) -
        line.from;
    const double along = glm::dot(to, line.along);
    const double off = to.y * line.along.x - to.x * line.along.y;
    if (along >= 0 && along < line.length && std::abs(off) < kHalfWidth) mask |= 1u << s;
  }
  return mask;
}

void LineTiles::draw_tile(FrameTile& tile) const {
  if (tile.of != TileContent::color) return;
  constexpr int kBlock = FrameTile::kBlock;
  for (const Line& line : lines_) {
    if (line.low.x >= tile.x + FrameTile::kSize || line.high.x <= tile.x ||
        line.low.y >= tile.y + FrameTile::kSize || line.high.y <= tile.y)
      continue;
    for (int block = 0; block < FrameTile::kBlockCount; ++block) {
      const int x0 = tile.x + block % FrameTile::kBlocks * kBlock,
                y0 = tile.y + block / FrameTile::kBlocks * kBlock;
      const glm::dvec2 middle = glm::dvec2(x0 + kBlock / 2, y0 + kBlock / 2) - line.from;
      const double off = std::abs(middle.y * line.along.x - middle.x * line.along.y);
      if (off > kBlock || glm::dot(middle, line.along) < -kBlock ||
          glm::dot(middle, line.along) > line.length + kBlock)
        continue;
      for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
        const double x = x0 + i % kBlock, y = y0 + i / kBlock;
        const unsigned mask = covered(line, x, y, tile.samples);
        if (mask == 0) continue;
        if (tile.samples == 4 && mask != 15) tile.expand(block);
        for (int s = 0; s < tile.planes(block); ++s) {
          if (!(mask >> s & 1)) continue;
          const glm::dvec2 at = tile.samples == 1
                                    ? glm::dvec2(0.5)
                                    : glm::dvec2(FrameTile::kSampleX[s], FrameTile::kSampleY[s]);
          const double along = glm::dot(glm::dvec2(x, y) + at - line.from, line.along);
          FrameTile::Plane& plane = tile.plane(block, s);
          if (float(line.inverse_z + along * line.per_px) >= plane.inverse_z[i])
            plane.content[i] = kOutlineColor;
        }
      }
    }
  }
}

}  // namespace rilievo
